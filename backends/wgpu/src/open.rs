//! A device of our own, for callers that have none.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use backend_api::Error;
use wgpu::{
    Adapter, Backends, Device, DeviceDescriptor, Instance, InstanceDescriptor, Limits, PowerPreference, Queue,
    RequestAdapterOptions,
};

/// Which adapter to open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum AdapterChoice {
    /// A discrete GPU before an integrated one before a software renderer.
    #[default]
    Fastest,
    /// An integrated GPU before a discrete one before a software renderer.
    LowPower,
    /// A software renderer (lavapipe, SwiftShader): slow, and the same on every machine.
    Software,
}

/// Storage buffers a shader stage needs: five of a kernel, its status word, four of the geometry.
const STORAGE_BUFFERS: u32 = 10;

/// A device with the least limits that kernels are written for, and a flag that its loss raises.
pub(crate) fn open(choice: AdapterChoice) -> Result<(Device, Queue, Arc<AtomicBool>), Error> {
    let adapter = adapter(choice).ok_or(Error::NoAdapter)?;
    let limits = Limits { max_storage_buffers_per_shader_stage: STORAGE_BUFFERS, ..Limits::default() };
    let desc = DeviceDescriptor { label: Some("hashcache"), required_limits: limits, ..DeviceDescriptor::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&desc)).map_err(|_| Error::NoAdapter)?;
    let lost = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&lost);
    device.set_device_lost_callback(move |_, _| raised.store(true, Ordering::Relaxed));
    Ok((device, queue, lost))
}

fn adapter(choice: AdapterChoice) -> Option<Adapter> {
    let instance = Instance::new(InstanceDescriptor {
        backends: Backends::PRIMARY,
        ..InstanceDescriptor::new_without_display_handle()
    });
    let power_preference = match choice {
        AdapterChoice::LowPower => PowerPreference::LowPower,
        AdapterChoice::Fastest | AdapterChoice::Software => PowerPreference::HighPerformance,
    };
    let options = RequestAdapterOptions {
        power_preference,
        force_fallback_adapter: choice == AdapterChoice::Software,
        ..RequestAdapterOptions::default()
    };
    pollster::block_on(instance.request_adapter(&options)).ok()
}
