//! What all tracing kernels bind and do.

use core::sync::atomic::Ordering;

use backend_api::{Access, BindingDecl, Launch, Status};
use hashcache_core::stages::LaunchRays;

use crate::packed::SceneTriangle;
use crate::path::RayCounts;
use crate::view::SceneView;

pub(super) const TRIANGLES: BindingDecl =
    BindingDecl { name: "pt_triangles", access: Access::In, stride: size_of::<SceneTriangle>() as u32 };
pub(super) const SCENE: BindingDecl = BindingDecl { name: "pt_scene", access: Access::In, stride: 4 };
pub(super) const TEXELS: BindingDecl = BindingDecl { name: "pt_texels", access: Access::In, stride: 4 };
pub(super) const COUNTERS: BindingDecl = BindingDecl { name: "pt_counters", access: Access::AtomicU64, stride: 8 };

/// The bindings of kernels that write records, `stride` bytes for each item.
pub(super) const fn tracing_bindings(stride: u32) -> [BindingDecl; 5] {
    let records = BindingDecl { name: "pt_records", access: Access::OutPerItem, stride };
    [TRIANGLES, SCENE, TEXELS, records, COUNTERS]
}

/// What a launch traces in: bindings 0 to 2 and its rays.
pub(super) struct Tracing<'a> {
    pub scene: SceneView<'a>,
    pub caster: LaunchRays<'a>,
    pub counts: RayCounts,
}

impl<'a> Tracing<'a> {
    /// `None` for buffers that this crate did not pack.
    pub(super) fn new(launch: &Launch<'a>) -> Option<Self> {
        let scene = SceneView::new(launch.input(0), launch.input(1), launch.input(2));
        debug_assert!(scene.is_some(), "the scene buffer was not packed by this crate");
        Some(Self { scene: scene?, caster: LaunchRays(launch.rays()), counts: RayCounts::default() })
    }

    /// Adds the counts to binding 4 and raises what they say.
    pub(super) fn finish(self, launch: &Launch<'_>) {
        for (counter, count) in launch.atomic_u64(4).iter().zip(self.counts.to_words()) {
            counter.fetch_add(count, Ordering::Relaxed);
        }
        if self.counts.non_finite > 0 {
            launch.raise(Status::NON_FINITE);
        }
    }
}
