//! Lookups and deposits of a hash grid at load 0.5, beside what the memory can do and beside plainer tables.
//!
//! `HASHGRID_BENCH_CELLS` lists the table sizes in mebi-cells of 64 bytes (default `1,4,16`; `64` needs 5 GiB).
//! Times are CPU time of all threads together, so that a busy machine does not blur them: with two threads (on one
//! table), a doubled time for the doubled number of operations is a perfect score. Elsewhere than on Linux it is elapsed
//! time times the number of threads.

mod common;

use std::collections::HashMap;
use std::env;
use std::hint::black_box;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;
use std::thread;
use std::time::Duration;

use common::{cpu_time, vertex};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hashcache_core::counters::Counters;
use hashcache_core::hash::{pcg, pcg2d};
use hashcache_core::record::VertexRecord;
use hashgrid::key::{fingerprint, home, key};
use hashgrid::vertex::{claim_vertices, deposit_vertices, estimate_vertices};
use hashgrid::{CELL_WORDS, Key, Params, Settings, Table, Word};

/// Operations of one thread in one measured run.
const OPERATIONS: usize = 1 << 17;

/// Words of which some begin at a line of the memory's caches, and where.
fn zeroed(words: usize) -> (Vec<AtomicU64>, usize) {
    let all: Vec<_> = (0..words + CELL_WORDS).map(|_| AtomicU64::new(0)).collect();
    let first = all.as_ptr().align_offset(64);
    (all, first)
}

/// A table of half as many keys as cells, and what asks for them.
struct Case {
    params: Params,
    storage: Vec<Word>,
    first: usize,
    cells: u32,
    vertices: Vec<VertexRecord>,
    keys: Vec<Key>,
    slots: Vec<u32>,
}

impl Case {
    fn new(cells: u32) -> Self {
        let params = Params::new(&Settings { jitter: 0.0, ..Settings::default() }).expect("settings of a bench");
        let (storage, first) = zeroed(cells as usize * CELL_WORDS);
        let table = Table::new(&storage[first..][..cells as usize * CELL_WORDS], &params).expect("storage of a bench");
        table.clear();
        for start in (0..cells / 2).step_by(4096) {
            let part: Vec<_> = (start..start + 4096).map(vertex).collect();
            claim_vertices(&table, &params, &part);
            deposit_vertices(&table, &params, &part, &mut Counters::default());
        }
        let chosen = (0..2 * OPERATIONS as u32).map(|i| pcg(i) % (cells / 2));
        let vertices: Vec<_> = chosen.map(vertex).collect();
        let keys = vertices.iter().filter_map(|vertex| key(&params, vertex, 0)).collect();
        let slots = (0..2 * OPERATIONS as u32).map(|i| pcg2d([i, 7])[0] & (cells - 1)).collect();
        Self { params, storage, first, cells, vertices, keys, slots }
    }

    fn words(&self) -> &[Word] {
        &self.storage[self.first..][..self.cells as usize * CELL_WORDS]
    }

    fn table(&self) -> Table<'_> {
        Table::new(self.words(), &self.params).expect("storage of a bench")
    }

    /// Runs `work` on `threads` parts of all operations and measures the whole.
    fn measure(&self, c: &mut Criterion, name: &str, threads: usize, work: impl Fn(std::ops::Range<usize>) + Sync) {
        let (group, case) = name.split_once('/').expect("a name with a group");
        let mut group = c.benchmark_group(format!("hashgrid/{group}"));
        group.sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
        group.throughput(Throughput::Elements((threads * OPERATIONS) as u64));
        let id = BenchmarkId::new(case, format!("{}M/{threads}t", self.cells >> 20));
        group.bench_function(id, |b| {
            b.iter_custom(|runs| {
                let start = cpu_time(threads);
                for _ in 0..runs {
                    thread::scope(|scope| {
                        for t in 1..threads {
                            let work = &work;
                            scope.spawn(move || work(t * OPERATIONS..(t + 1) * OPERATIONS));
                        }
                        work(0..OPERATIONS);
                    });
                }
                cpu_time(threads).saturating_sub(start)
            });
        });
        group.finish();
    }
}

/// Less than one of a thousand: a few keys of a large table find no slot.
fn is_rare(count: u64) -> bool {
    count < OPERATIONS as u64 / 1000
}

/// A random line's eight words, added.
fn raw_read(words: &[AtomicU64], slot: u32) -> u64 {
    let first = slot as usize * CELL_WORDS;
    words[first..first + CELL_WORDS].iter().fold(0, |sum, word| sum.wrapping_add(word.load(Relaxed)))
}

/// Seven additions to a random line.
fn raw_adds(words: &[AtomicU64], slot: u32) {
    let first = slot as usize * CELL_WORDS;
    for word in &words[first..first + 7] {
        word.fetch_add(1, Relaxed);
    }
}

/// The plain table: an empty slot is taken by one compare-exchange and keeps its key. Who comes first decides.
fn plain_insert(words: &[AtomicU64], mask: u32, probes: u32, key: &Key) -> Option<usize> {
    let tag = u64::from(fingerprint(key)) + 1;
    let mut slot = home(key) & mask;
    for _ in 0..probes {
        let head = &words[slot as usize * CELL_WORDS];
        let mut found = head.load(Relaxed);
        if found >> 32 == 0 {
            match head.compare_exchange(found, tag << 32, Relaxed, Relaxed) {
                Ok(_) => return Some(slot as usize),
                Err(now) => found = now,
            }
        }
        if found >> 32 == tag {
            return Some(slot as usize);
        }
        slot = (slot + 1) & mask;
    }
    None
}

fn lookups(c: &mut Criterion, case: &Case, threads: usize) {
    let table = case.table();
    case.measure(c, "lookup/raw_line", threads, |part| {
        black_box(case.slots[part].iter().fold(0_u64, |sum, slot| sum.wrapping_add(raw_read(case.words(), *slot))));
    });
    case.measure(c, "lookup/key", threads, |part| {
        let found = case.keys[part].iter().filter_map(|key| table.lookup(key));
        black_box(found.fold(0_u64, |sum, cell| sum.wrapping_add(cell.direct[0] ^ cell.further[2])));
    });
    case.measure(c, "lookup/vertices", threads, |part| {
        let (mut counters, mut sum) = (Counters::default(), 0.0);
        estimate_vertices(&table, &case.params, &case.vertices[part], &mut counters, |_, estimate| {
            sum += estimate.direct.x + estimate.further.z;
        });
        assert!(is_rare(black_box((counters.fallbacks, sum)).0));
    });
}

fn deposits(c: &mut Criterion, case: &Case, threads: usize) {
    let table = case.table();
    case.measure(c, "deposit/key", threads, |part| {
        assert!(is_rare(case.keys[part].iter().filter(|key| !table.deposit(key, &[1; 6])).count() as u64));
    });
    case.measure(c, "deposit/vertices", threads, |part| {
        let mut counters = Counters::default();
        deposit_vertices(&table, &case.params, &case.vertices[part], &mut counters);
        assert!(is_rare(counters.refusals));
    });
    case.measure(c, "claim/vertices", threads, |part| {
        black_box(claim_vertices(&table, &case.params, &case.vertices[part]));
    });
}

fn plain_tables(c: &mut Criterion, case: &mut Case) {
    for word in &mut case.storage {
        *word.get_mut() = 0;
    }
    let (words, mask) = (case.words(), case.cells - 1);
    for i in 0..case.cells / 2 {
        let key = key(&case.params, &vertex(i), 0).expect("a finite vertex");
        black_box(plain_insert(words, mask, 32, &key));
    }
    for threads in [1, 2] {
        case.measure(c, "deposit/plain_cas", threads, |part| {
            for key in &case.keys[part] {
                if let Some(slot) = plain_insert(words, mask, 32, key) {
                    raw_adds(words, slot as u32);
                }
            }
        });
        case.measure(c, "deposit/raw_adds", threads, |part| {
            for slot in &case.slots[part] {
                raw_adds(words, *slot);
            }
        });
    }
}

fn std_map(c: &mut Criterion, case: &Case) {
    // A map of the largest tables would not fit beside them.
    if case.cells > 4 << 20 {
        return;
    }
    let of = |i| key(&case.params, &vertex(i), 0).expect("a finite vertex");
    let mut map: HashMap<Key, [u64; 7]> = (0..case.cells / 2).map(|i| (of(i), [1; 7])).collect();
    case.measure(c, "lookup/std_map", 1, |part| {
        black_box(case.keys[part].iter().filter_map(|key| map.get(key)).fold(0_u64, |sum, v| sum.wrapping_add(v[1])));
    });
    let map = std::sync::Mutex::new(std::mem::take(&mut map));
    case.measure(c, "deposit/std_map", 1, |part| {
        let mut map = map.lock().expect("one thread");
        for key in &case.keys[part] {
            for sum in map.entry(*key).or_default() {
                *sum += 1;
            }
        }
    });
}

/// Sixty-four maps of the standard library (hashbrown) behind locks of their own, with the same sums.
fn sharded_maps(c: &mut Criterion, case: &Case) {
    const SHARDS: usize = 64;
    if case.cells > 4 << 20 {
        return;
    }
    let maps: Vec<_> = (0..SHARDS).map(|_| std::sync::Mutex::new(HashMap::<Key, [u64; 7]>::new())).collect();
    let add = |key: &Key| {
        let shard = &maps[fingerprint(key) as usize % SHARDS];
        for sum in shard.lock().expect("nobody panics").entry(*key).or_default() {
            *sum += 1;
        }
    };
    for i in 0..case.cells / 2 {
        add(&key(&case.params, &vertex(i), 0).expect("a finite vertex"));
    }
    for threads in [1, 2] {
        case.measure(c, "deposit/sharded_maps", threads, |part| case.keys[part].iter().for_each(add));
    }
}

/// Lookups and deposits of keys that were claimed, by load, in the smallest of the tables.
fn load_curve(c: &mut Criterion) {
    let cells = sizes().into_iter().min().expect("a size") << 20;
    for percent in [10, 30, 50, 70, 80, 90, 95] {
        let mut case = Case::new(cells);
        let table = case.table();
        table.clear();
        let count = (u64::from(cells) * percent / 100) as u32;
        for first in (0..count).step_by(4096) {
            let part: Vec<_> = (first..(first + 4096).min(count)).map(vertex).collect();
            claim_vertices(&table, &case.params, &part);
            deposit_vertices(&table, &case.params, &part, &mut Counters::default());
        }
        let chosen = (0..2 * OPERATIONS as u32).map(|i| vertex(pcg(i) % count));
        case.keys = chosen.filter_map(|vertex| key(&case.params, &vertex, 0)).collect();
        let table = case.table();
        case.measure(c, &format!("lookup/load_{percent}"), 1, |part| {
            let found = case.keys[part].iter().filter_map(|key| table.lookup(key));
            black_box(found.fold(0_u64, |sum, cell| sum.wrapping_add(cell.direct[0] ^ cell.further[2])));
        });
        case.measure(c, &format!("deposit/load_{percent}"), 1, |part| {
            black_box(case.keys[part].iter().filter(|key| table.deposit(key, &[1; 6])).count());
        });
    }
}

/// Sizes of tables in mebi-cells.
fn sizes() -> Vec<u32> {
    let sizes = env::var("HASHGRID_BENCH_CELLS").unwrap_or_else(|_| "1,4,16".into());
    sizes.split(',').map(|size| size.trim().parse().expect("a list of numbers")).collect()
}

fn grid(c: &mut Criterion) {
    for size in sizes() {
        let mut case = Case::new(size << 20);
        for threads in [1, 2] {
            lookups(c, &case, threads);
            deposits(c, &case, threads);
        }
        std_map(c, &case);
        sharded_maps(c, &case);
        plain_tables(c, &mut case);
    }
}

criterion_group!(benches, grid, load_curve);
criterion_main!(benches);
