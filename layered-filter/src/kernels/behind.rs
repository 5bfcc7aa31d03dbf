//! The kernels of pictures with several layers.

use backend_api::{Access, BindingDecl, Kernel, Launch};
use bytemuck::{Pod, Zeroable};
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::EstimateRecord;

use super::{GATHER, PIXELS, add_sample, image, of_items, shown};
use crate::front::{Behind, Carry, FrontPixel};
use crate::guide::{GuideScale, PreparedGuide};
use crate::image::Light;
use crate::pixel::{GatherParams, LayerPixel, xyz};

/// Parameters of [`FRONT`] (32 bytes).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FrontParams {
    /// The scene's size.
    pub scale: GuideScale,
    /// 1: [`Carry::All`]; 0: [`Carry::Rough`].
    pub all: u32,
    /// Zero.
    pub reserved: [u32; 3],
}

const BEHIND: BindingDecl =
    BindingDecl { name: "lf_behind", access: Access::OutPerItem, stride: size_of::<Behind>() as u32 };
const FRONTS: BindingDecl =
    BindingDecl { name: "lf_fronts", access: Access::In, stride: size_of::<FrontPixel>() as u32 };

/// Sets items of 16 bytes to 0.
pub static CLEAR: Kernel = Kernel {
    name: "lf.clear",
    bindings: &[BindingDecl { name: "lf_words", access: Access::OutPerItem, stride: 16 }],
    params_size: 0,
    body: clear,
    wgsl: None,
    casts_rays: false,
};

/// [`GATHER`] of a layer that others may lie behind: also adds the vertices that chains go on from.
pub static GATHER_FRONT: Kernel = Kernel {
    name: "lf.gather_front",
    bindings: &[
        GATHER.bindings[0],
        GATHER.bindings[1],
        GATHER.bindings[2],
        BindingDecl { name: "lf_fronts", access: Access::OutPerItem, stride: size_of::<FrontPixel>() as u32 },
    ],
    params_size: size_of::<GatherParams>() as u32,
    body: gather_front,
    wgsl: None,
    casts_rays: false,
};

/// Makes guides of the vertices that chains go on from, and moves the light that is to be filtered with them from
/// `lf_behind` to an image. A pixel without such light has no vertex in these guides.
pub static FRONT: Kernel = Kernel {
    name: "lf.front",
    bindings: &[
        FRONTS,
        BindingDecl { name: "lf_guides", access: Access::OutPerItem, stride: size_of::<PreparedGuide>() as u32 },
        image("lf_carried", Access::OutPerItem),
        BEHIND,
    ],
    params_size: size_of::<FrontParams>() as u32,
    body: front,
    wgsl: None,
    casts_rays: false,
};

/// Puts what [`FRONT`] took, filtered, back.
pub static GIVE: Kernel = Kernel {
    name: "lf.give",
    bindings: &[image("lf_carried", Access::In), BEHIND],
    params_size: 0,
    body: give,
    wgsl: None,
    casts_rays: false,
};

/// Adds a layer's emission and its illumination times throughput to `lf_behind`.
pub static ACCUMULATE: Kernel = Kernel {
    name: "lf.accumulate",
    bindings: &[PIXELS, image("lf_direct", Access::In), image("lf_further", Access::In), BEHIND],
    params_size: 0,
    body: accumulate,
    wgsl: None,
    casts_rays: false,
};

/// Radiance of the pixels: all light of `lf_behind`; w is 0.
pub static RADIANCE: Kernel = Kernel {
    name: "lf.radiance",
    bindings: &[
        BindingDecl { name: "lf_behind", access: Access::In, stride: size_of::<Behind>() as u32 },
        image("lf_radiance", Access::OutPerItem),
    ],
    params_size: 0,
    body: radiance,
    wgsl: None,
    casts_rays: false,
};

const _: () = assert!(CLEAR.is_well_formed() && GATHER_FRONT.is_well_formed() && FRONT.is_well_formed());
const _: () = assert!(GIVE.is_well_formed() && ACCUMULATE.is_well_formed() && RADIANCE.is_well_formed());

fn clear(launch: &mut Launch<'_>) {
    launch.output::<[u32; 4]>(0).fill([0; 4]);
}

fn gather_front(launch: &mut Launch<'_>) {
    let params = launch.params::<GatherParams>();
    let (records, estimates) = (launch.input::<VertexRecord>(0), launch.input::<EstimateRecord>(1));
    let items = launch.items();
    let pixels = launch.output::<LayerPixel>(2).iter_mut().zip(launch.output::<FrontPixel>(3));
    super::gather_each(launch, items.zip(pixels), |item, (pixel, front)| {
        let (record, fine) = add_sample(params, records, estimates, item, pixel)?;
        front.add(params, record);
        Some(fine)
    });
}

fn front(launch: &mut Launch<'_>) {
    let params = launch.params::<FrontParams>();
    let carry = if params.all == 0 { Carry::Rough } else { Carry::All };
    let fronts = of_items::<FrontPixel>(launch, 0);
    let guides = launch.output::<PreparedGuide>(1);
    let carried = launch.output::<Light>(2);
    let behind = launch.output::<Behind>(3);
    for (k, front) in fronts.iter().enumerate() {
        let taken = behind[k].take(front, carry);
        guides[k] = taken.map_or(PreparedGuide::NONE, |_| PreparedGuide::of_front(&params.scale, front));
        carried[k] = taken.unwrap_or_default();
    }
}

fn give(launch: &mut Launch<'_>) {
    let carried = of_items::<Light>(launch, 0);
    for (behind, carried) in launch.output::<Behind>(1).iter_mut().zip(carried) {
        behind.give(xyz(carried));
    }
}

fn accumulate(launch: &mut Launch<'_>) {
    let pixels = of_items::<LayerPixel>(launch, 0);
    let (direct, further) = (of_items::<Light>(launch, 1), of_items::<Light>(launch, 2));
    for (k, behind) in launch.output::<Behind>(3).iter_mut().enumerate() {
        behind.add(&pixels[k], shown(&direct[k]) + shown(&further[k]));
    }
}

fn radiance(launch: &mut Launch<'_>) {
    let behind = of_items::<Behind>(launch, 0);
    for (out, behind) in launch.output::<Light>(1).iter_mut().zip(behind) {
        *out = behind.radiance().extend(0.0).to_array();
    }
}
