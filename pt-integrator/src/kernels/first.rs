//! The kernel that takes the paths' first vertices out of the records of several.

use backend_api::{Access, BindingDecl, Kernel, Launch};
use bytemuck::{Pod, Zeroable};
use hashcache_core::record::VertexRecord;

/// Parameters of [`FIRST_VERTICES`]. 16 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct FirstParams {
    /// Records of a path: what [`super::trace_records`] was asked for, above 0.
    pub store: u32,
    /// Zero.
    pub reserved: [u32; 3],
}

const STRIDE: u32 = size_of::<VertexRecord>() as u32;

/// Copies the first record of each path: a picture needs one a pixel, a cache takes them all.
///
/// Bindings: kept records ([`VertexRecord`], `store` for each item), records (one for each item). Parameters:
/// [`FirstParams`]. A path whose record lies behind the first binding's end gets an empty one.
pub static FIRST_VERTICES: Kernel = Kernel {
    name: "pt.first_vertices",
    bindings: &[
        BindingDecl { name: "pt_kept", access: Access::In, stride: STRIDE },
        BindingDecl { name: "pt_records", access: Access::OutPerItem, stride: STRIDE },
    ],
    params_size: size_of::<FirstParams>() as u32,
    body: run,
    wgsl: None,
    casts_rays: false,
};

fn run(launch: &mut Launch<'_>) {
    let records = launch.output::<VertexRecord>(1);
    let kept = launch.input::<VertexRecord>(0);
    let store = launch.params::<FirstParams>().store as usize;
    for (item, record) in launch.items().zip(records) {
        *record = kept.get(item as usize * store).copied().unwrap_or_else(VertexRecord::zeroed);
    }
}
