//! What every backend checks before it acts, so that bad arguments give the same error everywhere.
//!
//! Each function returns the first thing that is wrong, in the order of its documentation, and changes nothing.

use crate::{Access, Binding, BufferDesc, BufferId, Error, Items, Kernel, Primitive};

/// A binding's first byte is a multiple of this many bytes (the least that WebGPU lets a device ask for).
pub const OFFSET_ALIGNMENT: u64 = 256;

/// What one backend can do, as far as arguments depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest size of one binding in bytes.
    pub max_binding_size: u64,
    /// Whether geometry was set, so that kernels may cast rays.
    pub has_geometry: bool,
}

/// Checks the arguments of [`crate::Backend::create`]; `limit` is the largest buffer of the backend in bytes.
///
/// # Errors
/// [`Error::BadSize`] when the size is 0, no multiple of 4 or above `limit`.
///
/// ```
/// use backend_api::{BufferDesc, Error, check};
///
/// let desc = BufferDesc { name: "table", size: 6 };
/// assert_eq!(check::create(&desc, 1024), Err(Error::BadSize { at: "table", size: 6, limit: 1024 }));
/// ```
pub fn create(desc: &BufferDesc, limit: u64) -> Result<(), Error> {
    if is_size(desc.size, limit) { Ok(()) } else { Err(Error::BadSize { at: desc.name, size: desc.size, limit }) }
}

/// Checks the arguments of [`crate::Backend::write`] and [`crate::Backend::read`] (`at` says which); `len` is the
/// buffer's size, `None` when the handle is dead. A transfer of 0 bytes is fine.
///
/// # Errors
/// [`Error::UnknownBuffer`]; [`Error::BadRange`] when offset or size is no multiple of 4 or the range leaves the
/// buffer.
pub fn transfer(at: &'static str, offset: u64, size: u64, len: Option<u64>) -> Result<(), Error> {
    let len = len.ok_or(Error::UnknownBuffer { at })?;
    if offset.is_multiple_of(4) && size.is_multiple_of(4) && is_inside(offset, size, len) {
        Ok(())
    } else {
        Err(Error::BadRange { at, offset, size })
    }
}

/// Checks the arguments of [`crate::Backend::dispatch`]; `size_of` gives the size of a living buffer in bytes.
///
/// # Errors
/// - [`Error::Unsupported`]: the kernel is malformed, see [`Kernel::is_well_formed`]
/// - [`Error::BindingCount`], [`Error::ParamsSize`]
/// - for each binding in turn: [`Error::UnknownBuffer`]; [`Error::BadSize`] when the size is 0, no multiple of 4 or
///   above the limit; [`Error::BadRange`] when the offset is no multiple of 256 or the range leaves the buffer;
///   [`Error::BindingTooSmall`] when the size is no whole number of elements or, for [`Access::OutPerItem`], has
///   fewer than the items need
/// - [`Error::Aliased`]: a buffer is bound twice, at least once to be written, whatever the ranges
/// - the buffer of [`Items::FromBuffer`]: [`Error::UnknownBuffer`]; [`Error::BadRange`] when the word lies outside;
///   [`Error::Aliased`] when the same buffer is bound to be written
/// - [`Error::NoGeometry`]
pub fn dispatch(
    kernel: &Kernel,
    params: &[u8],
    bindings: &[Binding],
    items: Items,
    limits: &Limits,
    size_of: impl Fn(BufferId) -> Option<u64>,
) -> Result<(), Error> {
    let at = kernel.name;
    if !kernel.is_well_formed() {
        return Err(Error::Unsupported { what: at });
    }
    if bindings.len() != kernel.bindings.len() {
        let expected = kernel.bindings.len() as u32;
        return Err(Error::BindingCount { kernel: at, expected, found: saturate(bindings.len()) });
    }
    if params.len() != kernel.params_size as usize {
        return Err(Error::ParamsSize { kernel: at, expected: kernel.params_size, found: saturate(params.len()) });
    }
    for (binding, decl) in bindings.iter().zip(kernel.bindings) {
        let len = size_of(binding.buffer).ok_or(Error::UnknownBuffer { at })?;
        let Binding { offset, size, .. } = *binding;
        if !is_size(size, limits.max_binding_size) {
            return Err(Error::BadSize { at, size, limit: limits.max_binding_size });
        }
        if !offset.is_multiple_of(OFFSET_ALIGNMENT) || !is_inside(offset, size, len) {
            return Err(Error::BadRange { at, offset, size });
        }
        let needed = needed_bytes(decl.access, u64::from(decl.stride), size, items.max());
        if size < needed {
            return Err(Error::BindingTooSmall { kernel: at, binding: decl.name, needed, found: size });
        }
    }
    for (k, (binding, decl)) in bindings.iter().zip(kernel.bindings).enumerate() {
        let mut others = bindings.iter().enumerate().filter(|&(other, _)| other != k);
        if decl.access.writes() && others.any(|(_, other)| other.buffer == binding.buffer) {
            return Err(Error::Aliased { kernel: at, binding: decl.name });
        }
    }
    if let Items::FromBuffer { buffer, index, .. } = items {
        let len = size_of(buffer).ok_or(Error::UnknownBuffer { at })?;
        let offset = u64::from(index) * 4;
        if !is_inside(offset, 4, len) {
            return Err(Error::BadRange { at, offset, size: 4 });
        }
        let mut bound = bindings.iter().zip(kernel.bindings);
        if let Some((_, decl)) = bound.find(|(binding, decl)| decl.access.writes() && binding.buffer == buffer) {
            return Err(Error::Aliased { kernel: at, binding: decl.name });
        }
    }
    if kernel.casts_rays && !limits.has_geometry {
        return Err(Error::NoGeometry { kernel: at });
    }
    Ok(())
}

/// Checks the arguments of [`crate::Backend::primitive`]; `size_of` gives the size of a living buffer in bytes.
///
/// # Errors
/// For each buffer in the order of the primitive's fields: [`Error::UnknownBuffer`]; [`Error::BindingTooSmall`] with
/// the primitive's and the field's name; [`Error::BadSize`] when the words in use exceed the limit. Then
/// [`Error::Aliased`] when two fields name one buffer and the primitive writes either.
pub fn primitive(
    primitive: &Primitive,
    limits: &Limits,
    size_of: impl Fn(BufferId) -> Option<u64>,
) -> Result<(), Error> {
    let kernel = primitive.name();
    let operands = primitive.operands();
    for operand in operands.iter().flatten() {
        let found = size_of(operand.buffer).ok_or(Error::UnknownBuffer { at: kernel })?;
        // `None`: the whole buffer.
        let needed = operand.words.map_or(found, |words| words * 4);
        if found < needed {
            return Err(Error::BindingTooSmall { kernel, binding: operand.name, needed, found });
        }
        if needed > limits.max_binding_size {
            return Err(Error::BadSize { at: kernel, size: needed, limit: limits.max_binding_size });
        }
    }
    for (k, operand) in operands.iter().flatten().enumerate() {
        let mut others = operands.iter().flatten().enumerate().filter(|&(other, _)| other != k);
        if operand.written && others.any(|(_, other)| other.buffer == operand.buffer) {
            return Err(Error::Aliased { kernel, binding: operand.name });
        }
    }
    Ok(())
}

/// Bytes that a binding of `size` bytes must have: all elements of the items where each item has its own, at least
/// one element, and no torn one.
fn needed_bytes(access: Access, stride: u64, size: u64, items: u32) -> u64 {
    let of_items = if access == Access::OutPerItem { stride.saturating_mul(u64::from(items)) } else { 0 };
    of_items.max(size.div_ceil(stride).saturating_mul(stride))
}

fn is_size(size: u64, limit: u64) -> bool {
    size > 0 && size.is_multiple_of(4) && size <= limit
}

fn is_inside(offset: u64, size: u64, len: u64) -> bool {
    offset.checked_add(size).is_some_and(|end| end <= len)
}

fn saturate(len: usize) -> u32 {
    u32::try_from(len).unwrap_or(u32::MAX)
}
