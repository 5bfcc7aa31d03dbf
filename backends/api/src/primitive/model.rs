//! What each primitive does, as plain loops over slices: the reference that every backend is compared with.
//!
//! Lengths are those of the slices; a longer target keeps its rest.

use alloc::vec::Vec;

/// [`super::Primitive::Fill`].
pub fn fill(buffer: &mut [u32], word: u32) {
    buffer.fill(word);
}

/// [`super::Primitive::Scan`]: `output` has room for one word more than `input` has.
///
/// # Panics
/// When it has not.
///
/// ```
/// let mut output = [9; 4];
/// backend_api::primitive::model::scan(&[5, u32::MAX], &mut output);
/// assert_eq!(output, [0, 5, 4, 9]);
/// ```
pub fn scan(input: &[u32], output: &mut [u32]) {
    let mut sum = 0_u32;
    for (place, &word) in output[..input.len()].iter_mut().zip(input) {
        *place = sum;
        sum = sum.wrapping_add(word);
    }
    output[input.len()] = sum;
}

/// [`super::Primitive::SortPairs`].
///
/// # Panics
/// When the slices differ in length.
///
/// ```
/// let (mut keys, mut values) = ([2, 1, 2, 1], [10, 11, 12, 13]);
/// backend_api::primitive::model::sort_pairs(&mut keys, &mut values);
/// assert_eq!((keys, values), ([1, 1, 2, 2], [11, 13, 10, 12]));
/// ```
pub fn sort_pairs(keys: &mut [u32], values: &mut [u32]) {
    assert_eq!(keys.len(), values.len(), "as many keys as values");
    let mut pairs: Vec<(u32, u32)> = keys.iter().copied().zip(values.iter().copied()).collect();
    pairs.sort_by_key(|&(key, _)| key);
    for ((key, value), pair) in keys.iter_mut().zip(values).zip(pairs) {
        (*key, *value) = pair;
    }
}

/// [`super::Primitive::ReduceByKey`]; returns the number of runs.
///
/// # Panics
/// When a slice is shorter than `keys`.
///
/// ```
/// let (mut unique, mut sums) = ([0; 4], [0; 4]);
/// let runs = backend_api::primitive::model::reduce_by_key(&[7, 7, 3, 7], &[1, 2, 4, 8], &mut unique, &mut sums);
/// assert_eq!((runs, unique, sums), (3, [7, 3, 7, 0], [3, 4, 8, 0]));
/// ```
pub fn reduce_by_key(keys: &[u32], values: &[u32], unique: &mut [u32], sums: &mut [u32]) -> u32 {
    let mut runs = 0;
    for (i, (&key, &value)) in keys.iter().zip(&values[..keys.len()]).enumerate() {
        if i == 0 || keys[i - 1] != key {
            unique[runs] = key;
            sums[runs] = value;
            runs += 1;
        } else {
            sums[runs - 1] = sums[runs - 1].wrapping_add(value);
        }
    }
    runs as u32
}

/// [`super::Primitive::Compact`]; returns how many indices were written.
///
/// # Panics
/// When `indices` is too short for them.
///
/// ```
/// let mut indices = [9; 4];
/// let kept = backend_api::primitive::model::compact(&[0, 1, 0, 5], &mut indices);
/// assert_eq!((kept, indices), (2, [1, 3, 9, 9]));
/// ```
pub fn compact(flags: &[u32], indices: &mut [u32]) -> u32 {
    let mut kept = 0;
    for (i, _) in flags.iter().enumerate().filter(|&(_, &flag)| flag != 0) {
        indices[kept] = i as u32;
        kept += 1;
    }
    kept as u32
}
