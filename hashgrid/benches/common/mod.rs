//! What the benches share.

use std::time::Duration;

use bytemuck::Zeroable;
use hashcache_core::record::VertexRecord;

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

/// Vertex `i` of a lattice of 512³ cells, with light in all channels.
pub fn vertex(i: u32) -> VertexRecord {
    let at = |bits: u32| ((bits & 511) as f32 + 0.1) / 1024.0;
    VertexRecord {
        position_footprint: [at(i), at(i >> 9), at(i >> 18), 0.0001],
        direct: [1.0, 0.5, 0.25, 0.0],
        further: [0.125, 0.3, 0.7, 0.0],
        seed: i,
        flags: VertexRecord::VALID,
        ..VertexRecord::zeroed()
    }
}
