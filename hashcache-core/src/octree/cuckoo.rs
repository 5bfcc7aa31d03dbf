//! Fills the tables.

use super::block::NO_KEY;
use super::table::{BUCKET_ENTRIES, BUCKET_WORDS, bucket_pair};
use super::view::BATCH;
use crate::hash::pcg;

/// Moves after which an insertion is given up. At a load of 0.9 a few dozen suffice for tables of any size; small ones
/// fail with some pairs of functions whatever the number of moves.
const MAX_MOVES: u32 = 1 << 9;

/// Failures after which a table is made larger by a 64th.
const MAX_RESTARTS: u32 = 8;

/// Buckets for so many blocks: nine entries of ten are in use. 0.97 is possible, at more moves and restarts.
///
/// ```
/// # use hashcache_core::octree::buckets_for;
/// assert_eq!((buckets_for(0), buckets_for(3), buckets_for(36_000)), (0, 1, 10_000));
/// ```
pub const fn buckets_for(blocks: u32) -> u32 {
    (blocks as u64 * 10).div_ceil(BUCKET_ENTRIES as u64 * 9) as u32
}

/// Key, occupancy, base.
pub(crate) type Row = [u32; 3];

/// The buckets and the seed with which all `rows` find a place; `resize` gives the words for so many buckets.
///
/// The result depends on the rows and their order only.
pub(crate) fn fill<I: Iterator<Item = Row>>(
    words: &mut alloc::vec::Vec<u32>,
    blocks: u32,
    rows: impl Fn() -> I,
) -> (u32, u32) {
    let first = words.len();
    let mut buckets = buckets_for(blocks);
    let mut seed = 0;
    loop {
        words.truncate(first);
        words.resize(first + (buckets * BUCKET_WORDS) as usize, 0);
        if try_fill(&mut words[first..], seed, buckets, rows()) {
            return (buckets, seed);
        }
        seed += 1;
        if seed % MAX_RESTARTS == 0 {
            buckets += 1 + buckets / 64;
        }
    }
}

fn try_fill(table: &mut [u32], seed: u32, buckets: u32, rows: impl Iterator<Item = Row>) -> bool {
    for bucket in table.chunks_exact_mut(BUCKET_WORDS as usize) {
        bucket[..BUCKET_ENTRIES as usize].fill(NO_KEY);
        bucket[BUCKET_ENTRIES as usize..].fill(0);
    }
    // A random walk needs luck, but the same luck every time.
    let mut dice = seed;
    let mut batch = [[0; 3]; BATCH];
    let mut rows = rows;
    loop {
        let mut count = 0;
        // All buckets are looked at first, so that their cache misses overlap.
        let mut full = [[false; 2]; BATCH];
        for ((place, full), row) in batch.iter_mut().zip(&mut full).zip(rows.by_ref()) {
            let pair = bucket_pair(row[0], seed, buckets);
            *full = pair.map(|bucket| table[(bucket * BUCKET_WORDS + BUCKET_ENTRIES - 1) as usize] != NO_KEY);
            *place = row;
            count += 1;
        }
        for (row, full) in batch[..count].iter().zip(full) {
            if !insert(table, seed, buckets, *row, full, &mut dice) {
                return false;
            }
        }
        if count < BATCH {
            return true;
        }
    }
}

/// Buckets are filled from their first entry on and never emptied: whether the last is taken says whether they are `full`.
fn insert(table: &mut [u32], seed: u32, buckets: u32, mut row: Row, mut full: [bool; 2], dice: &mut u32) -> bool {
    let mut pair = bucket_pair(row[0], seed, buckets);
    for _ in 0..MAX_MOVES {
        if pair.iter().zip(full).any(|(bucket, full)| !full && put(table, *bucket, row)) {
            return true;
        }
        // Both are full: another entry has to move to its other bucket.
        *dice = pcg(dice.wrapping_add(1));
        let (bucket, at) = (pair[(*dice >> 31) as usize], (*dice & (BUCKET_ENTRIES - 1)) as usize);
        let words = bucket_words(table, bucket);
        for (k, word) in row.iter_mut().enumerate() {
            core::mem::swap(word, &mut words[k * BUCKET_ENTRIES as usize + at]);
        }
        pair = bucket_pair(row[0], seed, buckets);
        // Back to where it was taken from would take a step for nothing.
        if pair[0] == bucket {
            pair.swap(0, 1);
        }
        pair[1] = pair[0];
        full = [false; 2];
    }
    false
}

fn put(table: &mut [u32], bucket: u32, row: Row) -> bool {
    let words = bucket_words(table, bucket);
    let free = words[..BUCKET_ENTRIES as usize].iter().position(|key| *key == NO_KEY);
    if let Some(at) = free {
        for (k, word) in row.into_iter().enumerate() {
            words[k * BUCKET_ENTRIES as usize + at] = word;
        }
    }
    free.is_some()
}

fn bucket_words(table: &mut [u32], bucket: u32) -> &mut [u32] {
    let first = (bucket * BUCKET_WORDS) as usize;
    &mut table[first..first + BUCKET_WORDS as usize]
}
