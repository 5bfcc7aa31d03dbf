//! Buffers: made, filled, read, and stages timed.

use std::collections::BTreeMap;

use backend_api::{Backend, Binding, BufferDesc, Error as BackendError};

use crate::clock::{self, Elapsed};
use crate::stats::Rays;

/// What a frame took.
#[derive(Clone, Debug, Default)]
pub(crate) struct Work {
    /// Seconds by stage.
    pub stages: BTreeMap<&'static str, Elapsed>,
    /// Rays.
    pub rays: Rays,
    /// Path contributions that were NaN or infinite.
    pub non_finite: u64,
    /// Samples a pixel.
    pub samples: u32,
}

impl Work {
    /// Records work, submits it, waits, and books its time under a stage's name.
    pub fn stage<B: Backend>(
        &mut self,
        backend: &mut B,
        name: &'static str,
        record: impl FnOnce(&mut B) -> Result<(), BackendError>,
    ) -> Result<(), BackendError> {
        let (result, elapsed) = clock::measure(|| {
            record(backend)?;
            backend.submit()?;
            backend.statuses().map(|_| ())
        });
        *self.stages.entry(name).or_default() += elapsed;
        result
    }
}

/// A zero-filled buffer.
pub(crate) fn create<B: Backend>(backend: &mut B, name: &'static str, size: u64) -> Result<Binding, BackendError> {
    let buffer = backend.create(&BufferDesc { name, size })?;
    Ok(Binding { buffer, offset: 0, size })
}

/// Buffers of these bytes: all of them, or none and an error.
pub(crate) fn upload_all<B: Backend, const N: usize>(
    backend: &mut B,
    all: [(&'static str, &[u8]); N],
) -> Result<[Binding; N], BackendError> {
    let mut made = Vec::with_capacity(N);
    let result = all.iter().try_for_each(|(name, bytes)| {
        let binding = create(backend, name, bytes.len() as u64)?;
        made.push(binding);
        backend.write(binding.buffer, 0, bytes)
    });
    if let Err(error) = result {
        made.iter().try_for_each(|binding| backend.destroy(binding.buffer))?;
        return Err(error);
    }
    Ok(std::array::from_fn(|k| made[k]))
}

/// The bytes of a binding, waited for.
pub(crate) fn read<B: Backend>(backend: &mut B, binding: Binding) -> Result<Vec<u8>, BackendError> {
    let ticket = backend.read(binding.buffer, binding.offset, binding.size)?;
    backend.redeem(ticket, true)?.ok_or(BackendError::UnknownTicket)
}

/// The elements `first..first + count` of a buffer.
pub(crate) fn part(whole: Binding, stride: usize, first: u32, count: u32) -> Binding {
    let stride = stride as u64;
    Binding { offset: whole.offset + u64::from(first) * stride, size: u64::from(count) * stride, ..whole }
}
