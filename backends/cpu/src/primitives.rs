//! The primitives on buffers: the serial model, or the same in chunks on the pool.

use std::mem;
use std::sync::atomic::{AtomicU64, Ordering};

use backend_api::primitive::model;
use backend_api::{BufferTable, Error, Primitive};
use rayon::prelude::*;

use crate::launch::Cut;
use crate::storage::{Storage, atomics};

/// Words of a chunk: enough to outweigh handing it to a thread, few enough to share.
const CHUNK: usize = 16_384;

/// Pairs of a chunk of the sort: enough to outweigh the table of 256 counts that each needs.
const SORTED: usize = 65_536;

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

/// Sorts by one byte of the keys after the other, lowest first; every pass keeps the order of equal bytes.
fn sort_pairs(keys: &mut [u32], values: &mut [u32]) -> Result<(), Error> {
    let size = 8 * keys.len() as u64;
    let (mut pairs, mut target) = (Storage::zeroed(size)?, Storage::zeroed(size)?);
    for ((pair, &key), &value) in pairs.pairs_mut().iter_mut().zip(&*keys).zip(&*values) {
        *pair = (u64::from(key) << 32) | u64::from(value);
    }
    for byte in [32, 40, 48, 56] {
        if move_by_byte(pairs.pairs(), atomics(target.bytes_mut()), byte) {
            mem::swap(&mut pairs, &mut target);
        }
    }
    keys.par_iter_mut().zip(values).zip(pairs.pairs()).with_min_len(CHUNK).for_each(|((key, value), &pair)| {
        (*key, *value) = ((pair >> 32) as u32, pair as u32);
    });
    Ok(())
}

/// Copies `pairs` to `target` in the order of the byte at bit `byte`; false when all have the same and nothing was done.
fn move_by_byte(pairs: &[u64], target: &[AtomicU64], byte: u32) -> bool {
    let digit = |pair: u64| (pair >> byte) as usize & 0xff;
    let mut places: Vec<[u32; 256]> = pairs
        .par_chunks(SORTED)
        .map(|chunk| {
            let mut counts = [0; 256];
            for &pair in chunk {
                counts[digit(pair)] += 1;
            }
            counts
        })
        .collect();
    // From how many there are of each byte in each chunk to where the first of them goes.
    let mut next = 0;
    for digit in 0..256 {
        let before = next;
        for chunk in &mut places {
            next += mem::replace(&mut chunk[digit], next);
        }
        if (next - before) as usize == pairs.len() {
            return false;
        }
    }
    // Chunks write to places of their own all over the target. Relaxed stores say so without unsafe code, at the price
    // of plain ones.
    pairs.par_chunks(SORTED).zip(places).for_each(|(chunk, mut places)| {
        for &pair in chunk {
            let place = &mut places[digit(pair)];
            target[*place as usize].store(pair, Ordering::Relaxed);
            *place += 1;
        }
    });
    true
}

/// Runs belong to the chunk they begin in; what a chunk finds before its first beginning is added to the run before.
fn reduce_by_key(keys: &[u32], values: &[u32], unique: &mut [u32], sums: &mut [u32]) -> u32 {
    let Some((&first, behind)) = keys.split_first() else { return 0 };
    // Word 0 begins a run; after it, every word does that differs from the one before.
    let before = |chunk: usize| if chunk == 0 { !first } else { keys[chunk * CHUNK - 1] };
    let counts: Vec<u32> = keys
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(c, chunk)| {
            let inner = chunk.iter().zip(&behind[c * CHUNK..]).take(chunk.len() - 1).filter(|(a, b)| a != b).count();
            u32::from(before(c) != chunk[0]) + inner as u32
        })
        .collect();
    let (starts, runs) = starts(&counts);
    let targets: Vec<_> = split(unique, &counts).into_iter().zip(split(sums, &counts)).collect();
    let chunks = keys.par_chunks(CHUNK).zip(values.par_chunks(CHUNK)).enumerate();
    let carries: Vec<u32> = chunks
        .zip(targets)
        .map(|((c, (keys, values)), (unique, sums))| {
            let (mut last, mut sum, mut carry) = (before(c), 0_u32, 0);
            let mut ends = unique.iter_mut().zip(sums);
            let mut current: Option<&mut u32> = None;
            for (&key, &value) in keys.iter().zip(values) {
                if key != last {
                    *current.unwrap_or(&mut carry) = sum;
                    current = ends.next().map(|(unique, sum)| {
                        *unique = key;
                        sum
                    });
                    (last, sum) = (key, 0);
                }
                sum = sum.wrapping_add(value);
            }
            *current.unwrap_or(&mut carry) = sum;
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
