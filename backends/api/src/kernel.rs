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

impl Access {
    /// Whether items may change the buffer.
    pub const fn writes(self) -> bool {
        !matches!(self, Self::In)
    }
}

/// One storage buffer a kernel works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BindingDecl {
    /// The name of the WGSL global and of the argument in messages.
    pub name: &'static str,
    /// How the kernel touches it.
    pub access: Access,
    /// Bytes of one element, a multiple of 4 above 0 (of 8 for [`Access::AtomicU64`]); the binding holds a whole number
    /// of them, at least one.
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
    /// Bytes of the parameter block, a multiple of 16 up to [`Kernel::MAX_PARAMS`], or 0 for none.
    pub params_size: u32,
    /// The host's body: runs the launch's items one after the other.
    pub body: fn(&mut Launch<'_>),
    /// The GPU's body, where there is one.
    pub wgsl: Option<Wgsl>,
    /// Whether the body casts rays, so that the launch needs geometry.
    pub casts_rays: bool,
}

impl Kernel {
    /// Most storage buffers of one kernel: with the four of ray casting and the status word they fill the ten that
    /// every GPU offers to a shader stage.
    pub const MAX_BINDINGS: usize = 5;

    /// Most bytes of the parameter block: what every GPU offers as a uniform buffer.
    pub const MAX_PARAMS: u32 = 65_536;

    /// Most invocations of one workgroup that every GPU offers.
    pub const MAX_WORKGROUP: u32 = 256;

    /// Whether the declaration keeps the rules of its fields. A backend refuses a kernel that does not; a crate finds
    /// out at compile time by `const _: () = assert!(KERNEL.is_well_formed());`.
    pub const fn is_well_formed(&self) -> bool {
        if self.bindings.len() > Self::MAX_BINDINGS
            || !self.params_size.is_multiple_of(16)
            || self.params_size > Self::MAX_PARAMS
        {
            return false;
        }
        let mut k = 0;
        while k < self.bindings.len() {
            let BindingDecl { access, stride, .. } = self.bindings[k];
            let unit = if matches!(access, Access::AtomicU64) { 8 } else { 4 };
            if stride == 0 || !stride.is_multiple_of(unit) {
                return false;
            }
            k += 1;
        }
        match &self.wgsl {
            Some(wgsl) => wgsl.workgroup_size > 0 && wgsl.workgroup_size <= Self::MAX_WORKGROUP,
            None => true,
        }
    }
}
