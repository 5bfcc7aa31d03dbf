//! Builds the octree of a scene and prints what its levels hold, what they weigh, and what building took:
//! `cargo run --release -p octree-levels -- SCENE RESOLUTION [THREADS]`.

use std::error::Error;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;
use std::{env, fs, thread};

use cpu_time::ProcessTime;
use hashcache_core::octree::{BuildSettings, Triangles, Workers, build};

/// So many threads of the standard library, a contiguous part of the items each.
struct Threads(u32);

impl Workers for Threads {
    fn run(&self, items: u32, body: &(dyn Fn(Range<u32>) + Sync)) {
        let next = AtomicU32::new(0);
        thread::scope(|scope| {
            for _ in 0..self.0 {
                scope.spawn(|| {
                    loop {
                        let first = next.fetch_add(1024, Ordering::Relaxed);
                        if first >= items {
                            break;
                        }
                        body(first..items.min(first + 1024));
                    }
                });
            }
        });
    }
}

/// The most memory the process has had, in bytes, where the system tells.
fn peak() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<u64>().ok()).unwrap_or(0) << 10
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let source = arguments.next().unwrap_or_else(|| "builtin:cornell".into());
    let resolution: u32 = arguments.next().unwrap_or_else(|| "512".into()).parse()?;
    let threads: u32 = arguments.next().unwrap_or_else(|| "1".into()).parse()?;
    let loaded = scene::load(&source, &scene::LoadOptions::default())?;
    let geometry = loaded.data.geometry();
    let before = peak();
    let (wall, cpu) = (Instant::now(), ProcessTime::now());
    let settings = BuildSettings { resolution, max_bytes: u64::MAX, ..BuildSettings::default() };
    let octree = build(&geometry, &settings, &Threads(threads))?;
    let (wall, cpu) = (wall.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
    let view = octree.view();
    println!("{source}: {} triangles, resolution {resolution}", Triangles::new(&geometry)?.count());
    for level in 0..view.grid().levels {
        println!("{level} {} {}", view.grid().side(level), view.level_range(level).len());
    }
    let words = 4 * view.words().len() as u64;
    let cells = u64::from(view.cells());
    let finished = words + cells * 44;
    println!("{cells} cells, {words} bytes of tables ({:.3} a cell)", words as f64 / cells as f64);
    println!("built in {cpu:.3} CPU-s, {wall:.3} s on {threads} threads");
    let added = peak() - before;
    println!(
        "peak {} MB over {} MB of scene: {:.3} of the finished {} MB",
        added >> 20,
        before >> 20,
        added as f64 / finished as f64,
        finished >> 20
    );
    Ok(())
}
