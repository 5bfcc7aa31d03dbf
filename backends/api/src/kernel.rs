//! A kernel as data: name, bindings, and two bodies.

use crate::Launch;

/// How a kernel touches a buffer; enough for one launch to be safe on one thread, on many, and on a GPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Read by every item, written by none.
    In,
    /// Item `i` reads and writes element `i` only.
    OutPerItem,
    /// Read and written by every item through 32-bit atomics.
    AtomicU32,
    /// Read and written by every item through 64-bit atomics (pairs of `u32`, low word first, in WGSL).
    AtomicU64,
}

/// One storage buffer a kernel works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BindingDecl {
    /// The name of the WGSL global and of the argument in messages.
    pub name: &'static str,
    /// How the kernel touches it.
    pub access: Access,
    /// Bytes of one element, a multiple of 4.
    pub stride: u32,
}

/// The WGSL body of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct Wgsl {
    /// Source modules in the order in which they are concatenated.
    pub modules: &'static [&'static str],
    /// The entry point's name.
    pub entry: &'static str,
    /// Invocations of one workgroup (at most 256); the entry point declares the same number.
    pub workgroup_size: u32,
}

/// An algorithm's step "for item `i`, from these buffers to those", with a body for the host and one for GPUs.
///
/// In WGSL, binding `k` of the list is `@group(0) @binding(k)`, the parameters are the uniform `@binding(14)` and
/// the status word is the storage buffer `@binding(15)`; an entry point takes the item's index from
/// `hc_item(...)` (see the assembly of the wgpu backend).
#[derive(Clone, Copy)]
pub struct Kernel {
    /// Unique name, `crate.step`, e.g. `hashgrid.claim`.
    pub name: &'static str,
    /// Storage buffers in binding order, at most five.
    pub bindings: &'static [BindingDecl],
    /// Bytes of the parameter block, a multiple of 16, or 0 for none.
    pub params_size: u32,
    /// The host's body: runs the launch's items one after the other.
    pub body: fn(&mut Launch<'_>),
    /// The GPU's body, where there is one.
    pub wgsl: Option<Wgsl>,
    /// Whether the body casts rays, so that the launch needs geometry.
    pub casts_rays: bool,
}
