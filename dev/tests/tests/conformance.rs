//! The conformance suite on every backend.

use backend_cpu::CpuBackend;
use hashcache_dev_tests::{conformance, gpu};

conformance!(serial, Some(CpuBackend::serial()));
conformance!(serial_launches_of_1, Some(CpuBackend::serial().with_launch_items(1)));
conformance!(rayon_1, Some(CpuBackend::rayon(1).expect("one thread")));
conformance!(rayon_2, Some(CpuBackend::rayon(2).expect("two threads")));
conformance!(rayon_5_launches_of_7, Some(CpuBackend::rayon(5).expect("five threads").with_launch_items(7)));
conformance!(wgpu, gpu::backend());
