//! Wall time, CPU time and memory of this process.

use std::time::Instant;

use cpu_time::ProcessTime;

/// Wall and CPU seconds of a stretch of work.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Elapsed {
    /// Wall seconds.
    pub wall_s: f64,
    /// User and system seconds of all threads of the process.
    pub cpu_s: f64,
}

impl std::ops::AddAssign for Elapsed {
    fn add_assign(&mut self, other: Self) {
        self.wall_s += other.wall_s;
        self.cpu_s += other.cpu_s;
    }
}

/// Runs `work` and tells how long it took.
pub fn measure<T>(work: impl FnOnce() -> T) -> (T, Elapsed) {
    let (wall, cpu) = (Instant::now(), ProcessTime::now());
    let value = work();
    (value, Elapsed { wall_s: wall.elapsed().as_secs_f64(), cpu_s: cpu.elapsed().as_secs_f64() })
}

/// The most memory the process has held so far in bytes; `None` where the system does not tell.
pub fn peak_rss_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
