use std::sync::atomic::Ordering::Relaxed;

use hashgrid::tag::{EMPTY, NEW, tag};
use hashgrid::validate::Violation;

use super::*;

/// A table with keys 1, 2, 3 at home 5 (slots 5, 6, 7), all settled, after `harm` was done to its words.
fn harmed(harm: impl Fn(&dyn Fn(usize, usize, u64))) -> Result<u32, Violation> {
    let params = params(Settings { max_probes: 8, ..still() });
    let words = storage(64, &params);
    let table = Table::new(&words, &params).unwrap();
    for fingerprint in 1..=3 {
        table.claim_from(5, fingerprint, table.head(5));
    }
    for fingerprint in 1..=3 {
        let found = table.find_at(5, fingerprint);
        table.add(found.slot.unwrap(), found.head, &[7; 6], 1);
    }
    harm(&|slot, word, value| words[slot * CELL_WORDS + word].store(value, Relaxed));
    table.validate().map(|summary| summary.occupied)
}

fn head(tag: u32, count: u32) -> u64 {
    (u64::from(tag) << 32) | u64::from(count)
}

/// Each law, broken once.
#[test]
fn every_violation_is_found() {
    assert_eq!(harmed(|_| {}), Ok(3));
    let sum_in_empty = harmed(|set| set(9, 4, 1));
    assert_eq!(sum_in_empty, Err(Violation::EmptyWithDeposits { slot: 9 }));
    let count_in_empty = harmed(|set| set(9, 0, head(EMPTY, 1)));
    assert_eq!(count_in_empty, Err(Violation::EmptyWithDeposits { slot: 9 }));
    let far = harmed(|set| set(20, 0, head(tag(1, 8), 0)));
    assert_eq!(far, Err(Violation::TooFar { slot: 20 }));
    let gap = harmed(|set| {
        set(6, 0, head(EMPTY, 0));
        (1..7).for_each(|k| set(6, k, 0));
    });
    assert_eq!(gap, Err(Violation::Unreachable { slot: 7, gap: 6 }));
    let twin = harmed(|set| set(7, 0, head(tag(1, 2), 1)));
    assert_eq!(twin, Err(Violation::Duplicate { slot: 7, other: 5 }));
    let order = harmed(|set| {
        set(20, 0, head(NEW | tag(9, 0), 0));
        set(21, 0, head(NEW | tag(4, 1), 0));
    });
    assert_eq!(order, Err(Violation::Order { slot: 21, better: 20 }));
    let early = harmed(|set| set(20, 0, head(NEW | tag(9, 0), 1)));
    assert_eq!(early, Err(Violation::NewWithDeposits { slot: 20 }));
    let sum = harmed(|set| set(5, 3, (1 << 33) + 1));
    assert_eq!(sum, Err(Violation::SumAboveCount { slot: 5 }));
    let spare = harmed(|set| set(30, 7, 1));
    assert_eq!(spare, Err(Violation::Padding { slot: 30 }));
    assert!(spare.unwrap_err().to_string().contains("30"));
}
