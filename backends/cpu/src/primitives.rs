//! The primitives on buffers: the serial model, or the same in chunks on the pool.

use backend_api::primitive::model;
use backend_api::{BufferTable, Error, Primitive};
use rayon::prelude::*;

use crate::launch::Cut;
use crate::storage::Storage;

/// Words of a chunk: enough to outweigh handing it to a thread, few enough to share.
const CHUNK: usize = 16_384;

/// Runs one checked primitive.
pub(crate) fn run(primitive: &Primitive, table: &mut BufferTable<Storage>, cut: Cut) -> Result<(), Error> {
    let dead = Error::UnknownBuffer { at: primitive.name() };
    let serial = cut.threads == 1;
    match *primitive {
        Primitive::Fill { buffer, word } => {
            let words = table.get_mut(buffer).ok_or(dead)?.words_mut();
            if serial {
                model::fill(words, word);
            } else {
                words.par_chunks_mut(CHUNK).for_each(|chunk| chunk.fill(word));
            }
        }
        Primitive::Scan { input, output, count } => {
            let [input, output] = table.get_disjoint_mut([input, output]).ok_or(dead)?;
            let n = count as usize;
            let (input, output) = (&input.words()[..n], &mut output.words_mut()[..=n]);
            if serial { model::scan(input, output) } else { scan(input, output) }
        }
        Primitive::SortPairs { keys, values, count } => {
            let [keys, values] = table.get_disjoint_mut([keys, values]).ok_or(dead)?;
            let n = count as usize;
            let (keys, values) = (&mut keys.words_mut()[..n], &mut values.words_mut()[..n]);
            if serial { model::sort_pairs(keys, values) } else { sort_pairs(keys, values)? }
        }
        Primitive::ReduceByKey { keys, values, unique, sums, runs, count } => {
            let [keys, values, unique, sums, runs] =
                table.get_disjoint_mut([keys, values, unique, sums, runs]).ok_or(dead)?;
            let n = count as usize;
            let (keys, values) = (&keys.words()[..n], &values.words()[..n]);
            let (unique, sums) = (&mut unique.words_mut()[..n], &mut sums.words_mut()[..n]);
            let reduce = if serial { model::reduce_by_key } else { reduce_by_key };
            runs.words_mut()[0] = reduce(keys, values, unique, sums);
        }
        Primitive::Compact { flags, indices, kept, count } => {
            let [flags, indices, kept] = table.get_disjoint_mut([flags, indices, kept]).ok_or(dead)?;
            let n = count as usize;
            let (flags, indices) = (&flags.words()[..n], &mut indices.words_mut()[..n]);
            let compact = if serial { model::compact } else { compact };
            kept.words_mut()[0] = compact(flags, indices);
        }
    }
    Ok(())
}

/// Two passes: sums of chunks, then each chunk from the sum before it.
fn scan(input: &[u32], output: &mut [u32]) {
    let sums: Vec<u32> =
        input.par_chunks(CHUNK).map(|chunk| chunk.iter().fold(0_u32, |a, &b| a.wrapping_add(b))).collect();
    let (starts, total) = starts(&sums);
    let (last, body) = output.split_last_mut().expect("one word more than the input");
    *last = total;
    body.par_chunks_mut(CHUNK).zip(input.par_chunks(CHUNK)).zip(starts).for_each(|((body, input), mut sum)| {
        for (place, &word) in body.iter_mut().zip(input) {
            *place = sum;
            sum = sum.wrapping_add(word);
        }
    });
}

/// Sorts words made of key and place: the order is stable, and no memory is needed that cannot be refused.
fn sort_pairs(keys: &mut [u32], values: &mut [u32]) -> Result<(), Error> {
    let size = keys.len() as u64 * 12;
    let (mut order, mut old) = (Vec::<u64>::new(), Vec::<u32>::new());
    order.try_reserve_exact(keys.len()).map_err(|_| Error::OutOfMemory { size })?;
    old.try_reserve_exact(keys.len()).map_err(|_| Error::OutOfMemory { size })?;
    order.extend(keys.iter().zip(0_u64..).map(|(&key, i)| u64::from(key) << 32 | i));
    old.extend_from_slice(values);
    order.par_sort_unstable();
    keys.par_iter_mut().zip(values).zip(&order).with_min_len(CHUNK).for_each(|((key, value), &word)| {
        *key = (word >> 32) as u32;
        *value = old[word as u32 as usize];
    });
    Ok(())
}

/// Runs belong to the chunk they begin in; what a chunk finds before its first beginning is added to the run before.
fn reduce_by_key(keys: &[u32], values: &[u32], unique: &mut [u32], sums: &mut [u32]) -> u32 {
    let begins = |i: usize| i == 0 || keys[i - 1] != keys[i];
    let chunks = || (0..keys.len().div_ceil(CHUNK)).into_par_iter().map(|c| c * CHUNK..keys.len().min((c + 1) * CHUNK));
    let counts: Vec<u32> = chunks().map(|chunk| chunk.filter(|&i| begins(i)).count() as u32).collect();
    let (starts, runs) = starts(&counts);
    let targets: Vec<_> = split(unique, &counts).into_iter().zip(split(sums, &counts)).collect();
    let carries: Vec<u32> = chunks()
        .zip(targets)
        .map(|(chunk, (unique, sums))| {
            let (mut run, mut carry) = (0, 0_u32);
            for i in chunk {
                if begins(i) {
                    (unique[run], sums[run]) = (keys[i], values[i]);
                    run += 1;
                } else {
                    let sum = if run == 0 { &mut carry } else { &mut sums[run - 1] };
                    *sum = sum.wrapping_add(values[i]);
                }
            }
            carry
        })
        .collect();
    for (start, carry) in starts.into_iter().zip(carries) {
        if start > 0 {
            let sum = &mut sums[start as usize - 1];
            *sum = sum.wrapping_add(carry);
        }
    }
    runs
}

/// Two passes: how many each chunk keeps, then each writes from the number before it.
fn compact(flags: &[u32], indices: &mut [u32]) -> u32 {
    let kept = |chunk: &[u32]| chunk.iter().filter(|&&flag| flag != 0).count() as u32;
    let counts: Vec<u32> = flags.par_chunks(CHUNK).map(kept).collect();
    let total = starts(&counts).1;
    flags.par_chunks(CHUNK).enumerate().zip(split(indices, &counts)).for_each(|((chunk, flags), target)| {
        let first = (chunk * CHUNK) as u32;
        let set = flags.iter().zip(first..).filter(|&(&flag, _)| flag != 0);
        for (place, (_, i)) in target.iter_mut().zip(set) {
            *place = i;
        }
    });
    total
}

/// The sum before each entry, and the whole.
fn starts(counts: &[u32]) -> (Vec<u32>, u32) {
    let mut sum = 0_u32;
    let mut starts = Vec::with_capacity(counts.len());
    for &count in counts {
        starts.push(sum);
        sum = sum.wrapping_add(count);
    }
    (starts, sum)
}

/// Consecutive pieces of the given lengths.
fn split<'a>(mut words: &'a mut [u32], counts: &[u32]) -> Vec<&'a mut [u32]> {
    let mut pieces = Vec::with_capacity(counts.len());
    for &count in counts {
        let (piece, rest) = words.split_at_mut(count as usize);
        pieces.push(piece);
        words = rest;
    }
    pieces
}
