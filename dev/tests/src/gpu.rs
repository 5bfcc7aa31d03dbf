//! The GPU of this machine, for tests.

use std::env;
use std::sync::OnceLock;

use backend_wgpu::{AdapterChoice, WgpuBackend};
use wgpu::{Device, Queue};

/// A backend on the machine's GPU; all of a process share one device. `None`, after saying "skipped", when there is
/// none.
///
/// `HASHCACHE_GPU` decides: `auto` (or unset) uses a GPU where there is one, `require` fails without one, `off` uses
/// none. A software renderer counts as a GPU.
///
/// # Panics
/// With `HASHCACHE_GPU=require` when there is no adapter, and for a value that is none of the three.
pub fn backend() -> Option<WgpuBackend> {
    static DEVICE: OnceLock<Option<(Device, Queue)>> = OnceLock::new();
    let (device, queue) = DEVICE.get_or_init(open).clone()?;
    Some(WgpuBackend::new(device, queue))
}

fn open() -> Option<(Device, Queue)> {
    let required = match env::var("HASHCACHE_GPU").as_deref() {
        Err(_) | Ok("auto") => false,
        Ok("require") => true,
        Ok("off") => {
            eprintln!("skipped: HASHCACHE_GPU=off");
            return None;
        }
        Ok(other) => panic!("HASHCACHE_GPU={other}: expected auto, require or off"),
    };
    match WgpuBackend::open(AdapterChoice::Fastest) {
        Ok(backend) => {
            eprintln!("GPU: {}", backend.adapter_name());
            Some((backend.device().clone(), backend.queue().clone()))
        }
        Err(error) => {
            assert!(!required, "HASHCACHE_GPU=require: {error}; install mesa-vulkan-drivers");
            eprintln!("skipped: no GPU adapter; install mesa-vulkan-drivers");
            None
        }
    }
}
