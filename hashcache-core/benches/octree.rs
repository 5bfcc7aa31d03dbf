//! Building an octree and looking cells up, beside what the memory can do and beside the paper's tables of cells.
//!
//! `OCTREE_BENCH_RESOLUTION` sets the resolution of the lookups (default 1024). Times are CPU time of the process, so
//! that a busy machine does not blur them. The paper's tables are built here only: see `PerCell`.

use std::env;
use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hashcache_core::geometry::{Geometry, Instance, Mesh};
use hashcache_core::hash::{pcg, pcg2d};
use hashcache_core::octree::{BuildSettings, NO_CELL, OwnedOctree, Serial, build};

/// Lookups of one measured run.
const OPERATIONS: usize = 1 << 17;

/// CPU time that the process has used.
#[cfg(target_os = "linux")]
fn cpu_time() -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

/// Elapsed time.
#[cfg(not(target_os = "linux"))]
fn cpu_time() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}

/// A landscape of n×n squares over a unit square, and a wall.
struct Landscape {
    positions: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
}

impl Landscape {
    fn new(n: u32) -> Self {
        let mut positions = Vec::new();
        for i in 0..=n {
            for j in 0..=n {
                let (x, z) = (i as f32 / n as f32, j as f32 / n as f32);
                let bump = hashcache_core::float::sin(x * 9.0) * hashcache_core::float::cos(z * 7.0);
                positions.push([x, 0.2 * bump + 0.5, z]);
            }
        }
        let mut indices = Vec::new();
        for i in 0..n {
            for j in 0..n {
                let a = i * (n + 1) + j;
                indices.push([a, a + 1, a + n + 1]);
                indices.push([a + n + 2, a + n + 1, a + 1]);
            }
        }
        let first = positions.len() as u32;
        positions.extend([[0.3, 0.0, 0.0], [0.3, 1.0, 0.0], [0.3, 1.0, 1.0], [0.3, 0.0, 1.0]]);
        indices.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        Self { positions, indices }
    }

    fn build(&self, resolution: u32) -> OwnedOctree {
        let geometry = Geometry {
            positions: &self.positions,
            indices: &self.indices,
            meshes: &[Mesh { first_triangle: 0, triangle_count: self.indices.len() as u32 }],
            instances: &[Instance::identity(0)],
            ..Geometry::default()
        };
        let settings = BuildSettings { resolution, max_bytes: u64::MAX, ..BuildSettings::default() };
        build(&geometry, &settings, &Serial).expect("a landscape")
    }
}

fn measure(c: &mut Criterion, group: &str, id: BenchmarkId, operations: usize, mut work: impl FnMut()) {
    let mut group = c.benchmark_group(group);
    group.sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    group.throughput(Throughput::Elements(operations as u64));
    group.bench_function(id, |b| {
        b.iter_custom(|runs| {
            let start = cpu_time();
            for _ in 0..runs {
                work();
            }
            cpu_time().saturating_sub(start)
        });
    });
    group.finish();
}

/// A cell's key in 36 bits: 12 an axis, relative to the octree's corner.
type CellKey = u64;

/// The paper's structure (Roth et al. 2020, after Alcantara et al. 2009): one entry a cell, two functions, a table that
/// grows by 1.1·1.01ⁿ until all cells find a place. `SLOTS` entries a bucket: the paper's has one.
struct PerCell<const SLOTS: usize> {
    entries: Vec<[(CellKey, u32); SLOTS]>,
    attempts: u32,
}

impl<const SLOTS: usize> PerCell<SLOTS> {
    fn new(cells: &[(CellKey, u32)]) -> Self {
        let mut size = cells.len() as f64 * 1.1 / SLOTS as f64;
        for attempt in 0.. {
            if let Some(entries) = Self::fill(cells, size as usize + 1, attempt) {
                return Self { entries, attempts: attempt };
            }
            size *= 1.01;
        }
        unreachable!("a table of any size is tried")
    }

    fn pair(key: CellKey, seed: u32, buckets: usize) -> [usize; 2] {
        let high = pcg((key >> 32) as u32 ^ seed);
        pcg2d([key as u32, high]).map(|h| ((u64::from(h) * buckets as u64) >> 32) as usize)
    }

    fn fill(cells: &[(CellKey, u32)], buckets: usize, seed: u32) -> Option<Vec<[(CellKey, u32); SLOTS]>> {
        let mut entries = vec![[(0, NO_CELL); SLOTS]; buckets];
        let mut dice = seed;
        for cell in cells {
            let (mut row, mut from) = (*cell, usize::MAX);
            let mut moves = 0;
            'place: loop {
                let pair = Self::pair(row.0, seed, buckets);
                for bucket in pair {
                    if let Some(free) = entries[bucket].iter_mut().find(|entry| entry.1 == NO_CELL) {
                        *free = row;
                        break 'place;
                    }
                }
                moves += 1;
                if moves > 500 {
                    return None;
                }
                dice = pcg(dice);
                let bucket = if pair[0] == from { pair[1] } else { pair[0] };
                std::mem::swap(&mut row, &mut entries[bucket][dice as usize % SLOTS]);
                from = bucket;
            }
        }
        Some(entries)
    }

    fn cell(&self, key: CellKey) -> Option<u32> {
        Self::pair(key, self.attempts, self.entries.len())
            .into_iter()
            .flat_map(|bucket| &self.entries[bucket])
            .find(|entry| entry.0 == key && entry.1 != NO_CELL)
            .map(|entry| entry.1)
    }

    /// With a key and an index of 32 bits each, as the paper has them; the keys here are wider.
    fn bytes(&self) -> usize {
        self.entries.len() * SLOTS * 8
    }
}

/// Cells to ask for, and their keys.
struct Questions {
    cells: Vec<[u32; 3]>,
    keys: Vec<CellKey>,
}

fn read(data: &[[u32; 6]], at: u32) -> u32 {
    data[at as usize].iter().fold(0, |sum, word| sum.wrapping_add(*word))
}

fn lookups(c: &mut Criterion) {
    let resolution: u32 =
        env::var("OCTREE_BENCH_RESOLUTION").map_or(1024, |text| text.trim().parse().expect("a number"));
    let owned = Landscape::new(200).build(resolution);
    let octree = owned.view();
    let corner = octree.levels()[0].corner;
    let all: Vec<[u32; 3]> = octree.blocks(0).flat_map(|block| block.cells().map(|(cell, _)| cell)).collect();
    let key = |cell: &[u32; 3]| (0..3).fold(0, |key, axis| key << 12 | u64::from(cell[axis] - corner[axis]));
    let chosen = |salt: u32, miss: u32| -> Questions {
        let pick = |i| all[pcg2d([i, salt])[0] as usize % all.len()];
        let cells: Vec<[u32; 3]> = (0..OPERATIONS as u32).map(pick).map(|[x, y, z]| [x, y + miss, z]).collect();
        let keys = cells.iter().map(key).collect();
        Questions { cells, keys }
    };
    let (hits, misses) = (chosen(1, 0), chosen(2, 9));
    let finest = octree.level_range(0).len();
    println!(
        "{finest} cells on the finest level of {resolution}: {:.3} bytes a cell",
        octree.statistics(0, 48).table_bytes as f64 / finest as f64
    );
    let group = "octree/lookup";
    let id = |name: &str| BenchmarkId::new(name, resolution);
    // What a lookup is for: 24 bytes of data.
    let data: Vec<[u32; 6]> = (0..finest as u32).map(|i| [i; 6]).collect();
    let places: Vec<u32> = hits.cells.iter().filter_map(|cell| octree.cell(0, *cell)).collect();
    measure(c, group, id("raw_24_bytes"), OPERATIONS, || {
        black_box(places.iter().fold(0_u32, |sum, at| sum.wrapping_add(read(&data, *at))));
    });
    let mut indices = vec![0; OPERATIONS];
    for (name, questions) in [("batch_hits", &hits), ("batch_misses", &misses)] {
        measure(c, group, id(name), OPERATIONS, || {
            octree.find_cells(0, &questions.cells, &mut indices);
            black_box(&indices);
        });
    }
    measure(c, group, id("batch_hits_and_24_bytes"), OPERATIONS, || {
        octree.find_cells(0, &hits.cells, &mut indices);
        black_box(indices.iter().fold(0_u32, |sum, at| sum.wrapping_add(read(&data, *at))));
    });
    measure(c, group, id("single_hits"), OPERATIONS, || {
        black_box(hits.cells.iter().filter_map(|cell| octree.cell(0, *cell)).fold(0_u32, u32::wrapping_add));
    });
    let rows: Vec<(CellKey, u32)> = all.iter().map(key).zip(0..).collect();
    per_cell::<1>(c, &rows, &hits, &misses, resolution);
    per_cell::<4>(c, &rows, &hits, &misses, resolution);
}

fn per_cell<const SLOTS: usize>(
    c: &mut Criterion,
    rows: &[(CellKey, u32)],
    hits: &Questions,
    misses: &Questions,
    resolution: u32,
) {
    let start = cpu_time();
    let table = PerCell::<SLOTS>::new(rows);
    println!(
        "one entry a cell, {SLOTS} a bucket: built in {:.3} CPU-s after {} restarts, {:.3} bytes a cell, load {:.3}",
        cpu_time().saturating_sub(start).as_secs_f64(),
        table.attempts,
        table.bytes() as f64 / rows.len() as f64,
        rows.len() as f64 / (table.entries.len() * SLOTS) as f64,
    );
    for (name, questions) in [("hits", hits), ("misses", misses)] {
        let id = BenchmarkId::new(format!("cells_of_{SLOTS}_{name}"), resolution);
        measure(c, "octree/lookup", id, OPERATIONS, || {
            black_box(questions.keys.iter().filter_map(|key| table.cell(*key)).fold(0_u32, u32::wrapping_add));
        });
    }
}

fn builds(c: &mut Criterion) {
    for (name, squares) in [("walls", 1), ("small_triangles", 400)] {
        let landscape = Landscape::new(squares);
        for resolution in [256, 1024] {
            let cells = landscape.build(resolution).view().cells() as usize;
            measure(c, "octree/build", BenchmarkId::new(name, resolution), cells, || {
                black_box(landscape.build(resolution));
            });
        }
    }
}

criterion_group!(benches, lookups, builds);
criterion_main!(benches);
