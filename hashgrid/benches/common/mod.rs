//! What the benches share.

use std::time::Duration;

/// CPU time that the process has used.
#[cfg(target_os = "linux")]
pub fn cpu_time(_threads: usize) -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

/// Elapsed time, as if all threads had worked throughout.
#[cfg(not(target_os = "linux"))]
pub fn cpu_time(threads: usize) -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed() * threads as u32
}
