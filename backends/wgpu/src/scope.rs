//! Errors of the device, caught where they arise.

use backend_api::Error;
use wgpu::{Device, ErrorFilter};

/// What the device reported while some calls were made.
pub(crate) enum Fault {
    /// Memory did not suffice.
    OutOfMemory(String),
    /// Anything else.
    Refused(String),
}

impl Fault {
    /// As an error of the interface, for calls that needed `size` bytes; and the device's words.
    pub(crate) fn into_error(self, size: u64) -> (Error, String) {
        match self {
            Self::OutOfMemory(text) => (Error::OutOfMemory { size }, text),
            Self::Refused(text) => (Error::DeviceLost, text),
        }
    }
}

/// Makes the calls in `f` and returns what they gave, or the first error that the device reported of them.
///
/// Without a scope, wgpu hands errors to the handler of the device's owner, which panics unless it was replaced.
pub(crate) fn catch<T>(device: &Device, f: impl FnOnce() -> T) -> Result<T, Fault> {
    let internal = device.push_error_scope(ErrorFilter::Internal);
    let memory = device.push_error_scope(ErrorFilter::OutOfMemory);
    let validation = device.push_error_scope(ErrorFilter::Validation);
    let value = f();
    let errors = [validation.pop(), memory.pop(), internal.pop()].map(pollster::block_on);
    match errors.into_iter().flatten().next() {
        None => Ok(value),
        Some(error @ wgpu::Error::OutOfMemory { .. }) => Err(Fault::OutOfMemory(error.to_string())),
        Some(error) => Err(Fault::Refused(error.to_string())),
    }
}
