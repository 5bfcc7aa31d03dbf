//! The filter's steps as kernels: host bodies over borrowed slices.
//!
//! | kernel | items | reads | writes | parameters |
//! |---|---|---|---|---|
//! | [`GATHER`] | samples, one a pixel | records, estimates | pixels (added to) | [`GatherParams`] |
//! | [`PREPARE`] | pixels | pixels | guides, direct, further; counters | [`GuideScale`] |
//! | [`FILL`] | pixels | guides, image | image; counters | [`ImageParams`] + [`Weights`] |
//! | [`BILATERAL`], [`ATROUS`] | pixels | guides, image | image | [`ImageParams`] + the filter |
//! | [`COMPOSE`] | pixels | pixels, direct, further | radiance | none |
//! | [`NOISE`] | pixels | pixels | noise (added to) | [`NoiseParams`] |
//! | [`CLEAR`] | runs of 16 bytes | | zeros | none |
//!
//! Pictures of several layers, deepest first:
//!
//! | kernel | items | reads | writes | parameters |
//! |---|---|---|---|---|
//! | [`GATHER_FRONT`] | samples, one a pixel | records, estimates | pixels, fronts (added to) | [`GatherParams`] |
//! | [`FRONT`] | pixels | fronts | guides, carried; behind (taken from) | [`FrontParams`] |
//! | [`GIVE`] | pixels | carried | behind (added to) | none |
//! | [`ACCUMULATE`] | pixels | pixels, direct, further | behind (added to) | none |
//! | [`RADIANCE`] | pixels | behind | radiance | none |
//!
//! An image is a buffer of [`Light`] with the view's number of pixels; the whole of it is bound to be read, also by
//! dispatches over a part of the pixels. [`pass_kernel`] makes a kernel of any [`Denoiser`] that is [`Pod`].

mod behind;
mod noise;

use core::sync::atomic::Ordering::Relaxed;

use backend_api::{Access, BindingDecl, Kernel, Launch, Status};
use bytemuck::{Pod, Zeroable};
use hashcache_core::glam::Vec3;
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::EstimateRecord;
use hashcache_core::traits::Estimate;

use crate::atrous::ATrous;
use crate::bilateral::CrossBilateral;
use crate::denoiser::{Denoiser, filter_pixels};
use crate::fill::{Filled, fill};
use crate::guide::{GuideScale, PreparedGuide};
use crate::image::{Light, View, is_hole};
use crate::pixel::{GatherParams, LayerPixel};
use crate::weights::Weights;

pub use behind::{ACCUMULATE, CLEAR, FRONT, FrontParams, GATHER_FRONT, GIVE, RADIANCE};
pub use noise::{NOISE, NoiseParams};

/// What a frame's pixels held and what became of their holes (48 bytes), added up over all layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct FilterCounters {
    /// Samples.
    pub samples: u64,
    /// Samples that met a vertex.
    pub vertices: u64,
    /// Vertices that no illumination was known for.
    pub holes: u64,
    /// Values left out because they were NaN, infinite or negative.
    pub left_out: u64,
    /// Pixels without illumination that neighbours filled.
    pub filled: u64,
    /// Pixels without illumination that stayed black.
    pub empty: u64,
}

impl FilterCounters {
    /// Number of words.
    pub const WORDS: usize = 6;
}

/// The first part of the parameters of every kernel that reads neighbours (16 bytes).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct ImageParams {
    /// Pixels of a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The pass, from 0; 0 where there is only one.
    pub pass: u32,
    /// The first item's pixel.
    pub first: u32,
}

/// Largest parameter block of this crate's kernels: the bilateral filter's.
pub const MAX_PARAMS: usize = size_of::<ImageParams>() + size_of::<CrossBilateral>();

const PIXELS: BindingDecl =
    BindingDecl { name: "lf_pixels", access: Access::In, stride: size_of::<LayerPixel>() as u32 };
const GUIDES: BindingDecl =
    BindingDecl { name: "lf_guides", access: Access::In, stride: size_of::<PreparedGuide>() as u32 };
const COUNTERS: BindingDecl =
    BindingDecl { name: "lf_counters", access: Access::AtomicU64, stride: size_of::<FilterCounters>() as u32 };

const fn image(name: &'static str, access: Access) -> BindingDecl {
    BindingDecl { name, access, stride: size_of::<Light>() as u32 }
}

const PASS: &[BindingDecl] = &[GUIDES, image("lf_input", Access::In), image("lf_output", Access::OutPerItem)];

/// Adds a sample to each pixel: item i adds record and estimate i·stride to pixel i. Raises [`Status::NON_FINITE`] when
/// a value was left out.
pub static GATHER: Kernel = Kernel {
    name: "lf.gather",
    bindings: &[
        BindingDecl { name: "lf_records", access: Access::In, stride: size_of::<VertexRecord>() as u32 },
        BindingDecl { name: "lf_estimates", access: Access::In, stride: size_of::<EstimateRecord>() as u32 },
        BindingDecl { name: "lf_pixels", access: Access::OutPerItem, stride: size_of::<LayerPixel>() as u32 },
    ],
    params_size: size_of::<GatherParams>() as u32,
    body: gather,
    wgsl: None,
    casts_rays: false,
};

/// Makes guides and images of illumination from the pixels' sums.
pub static PREPARE: Kernel = Kernel {
    name: "lf.prepare",
    bindings: &[
        PIXELS,
        BindingDecl { name: "lf_guides", access: Access::OutPerItem, stride: size_of::<PreparedGuide>() as u32 },
        image("lf_direct", Access::OutPerItem),
        image("lf_further", Access::OutPerItem),
        COUNTERS,
    ],
    params_size: size_of::<GuideScale>() as u32,
    body: prepare,
    wgsl: None,
    casts_rays: false,
};

/// Fills the holes of an image ([`fill`]).
pub static FILL: Kernel = Kernel {
    name: "lf.fill",
    bindings: &[GUIDES, image("lf_input", Access::In), image("lf_output", Access::OutPerItem), COUNTERS],
    params_size: (size_of::<ImageParams>() + size_of::<Weights>()) as u32,
    body: fill_holes,
    wgsl: None,
    casts_rays: false,
};

/// A pass of the cross-bilateral filter.
pub static BILATERAL: Kernel = pass_kernel::<CrossBilateral>("lf.bilateral");

/// A pass of the à-trous wavelet.
pub static ATROUS: Kernel = pass_kernel::<ATrous>("lf.atrous");

/// Radiance of the pixels: mean emitted light + mean throughput · (direct + further illumination); w is 0.
pub static COMPOSE: Kernel = Kernel {
    name: "lf.compose",
    bindings: &[
        PIXELS,
        image("lf_direct", Access::In),
        image("lf_further", Access::In),
        image("lf_radiance", Access::OutPerItem),
    ],
    params_size: 0,
    body: compose,
    wgsl: None,
    casts_rays: false,
};

/// The kernel for a pass of a denoiser: guides and image in, image out. Its parameters are [`ImageParams`] and, behind
/// them, the denoiser's own bytes.
///
/// The denoiser's size is a multiple of 16 bytes, or the kernel is malformed.
pub const fn pass_kernel<D: Denoiser + Pod>(name: &'static str) -> Kernel {
    Kernel {
        name,
        bindings: PASS,
        params_size: (size_of::<ImageParams>() + size_of::<D>()) as u32,
        body: pass::<D>,
        wgsl: None,
        casts_rays: false,
    }
}

const _: () = assert!(GATHER.is_well_formed() && PREPARE.is_well_formed() && FILL.is_well_formed());
const _: () = assert!(BILATERAL.is_well_formed() && ATROUS.is_well_formed() && COMPOSE.is_well_formed());

/// The elements of an input that belong to the launch's items.
fn of_items<'a, T: Pod>(launch: &Launch<'a>, slot: usize) -> &'a [T] {
    &launch.input::<T>(slot)[launch.first as usize..][..launch.count as usize]
}

/// The two parts of a parameter block.
fn image_params<'a, T: Pod>(launch: &Launch<'a>) -> (&'a ImageParams, &'a T) {
    let (head, rest) = launch.params.split_at(size_of::<ImageParams>());
    (bytemuck::from_bytes(head), bytemuck::from_bytes(rest))
}

fn gather(launch: &mut Launch<'_>) {
    let params = launch.params::<GatherParams>();
    let (records, estimates) = (launch.input::<VertexRecord>(0), launch.input::<EstimateRecord>(1));
    let (items, pixels) = (launch.items(), launch.output::<LayerPixel>(2));
    gather_each(launch, items.zip(pixels), |item, pixel| {
        add_sample(params, records, estimates, item, pixel).map(|(_, fine)| fine)
    });
}

/// Runs `add` for every item; it tells whether all values were fine, or `None` for a binding that is too short: that adds
/// nothing rather than something else.
fn gather_each<T>(
    launch: &Launch<'_>,
    items: impl Iterator<Item = (u32, T)>,
    mut add: impl FnMut(u32, T) -> Option<bool>,
) {
    let mut fine = true;
    for (item, sums) in items {
        let Some(of_item) = add(item, sums) else {
            launch.raise(Status::OVERFLOW);
            return;
        };
        fine &= of_item;
    }
    if !fine {
        launch.raise(Status::NON_FINITE);
    }
}

/// Adds an item's record and estimate to its pixel; whether all values were fine. `None` when there is no such record.
#[inline(always)]
fn add_sample<'a>(
    params: &GatherParams,
    records: &'a [VertexRecord],
    estimates: &[EstimateRecord],
    item: u32,
    pixel: &mut LayerPixel,
) -> Option<(&'a VertexRecord, bool)> {
    let (record, estimate) = (records.get(params.record_of(item))?, estimates.get(params.estimate_of(item))?);
    let EstimateRecord { direct: [r, g, b, samples], further: [x, y, z, variance] } = *estimate;
    let (direct, further) = (Vec3::new(r, g, b), Vec3::new(x, y, z));
    let estimate = Estimate { direct, further, samples: samples.max(0.0) as u32, variance };
    Some((record, pixel.add(params, record, &estimate)))
}

fn prepare(launch: &mut Launch<'_>) {
    let scale = launch.params::<GuideScale>();
    let pixels = of_items::<LayerPixel>(launch, 0);
    let guides = launch.output::<PreparedGuide>(1);
    let (direct, further) = (launch.output::<Light>(2), launch.output::<Light>(3));
    let mut counters = FilterCounters::default();
    for (k, pixel) in pixels.iter().enumerate() {
        guides[k] = PreparedGuide::of_pixel(scale, pixel);
        direct[k] = pixel.direct_light();
        further[k] = pixel.further_light();
        let [samples, vertices, holes, _] = pixel.counts.map(u64::from);
        let left_out = u64::from(pixel.left_out());
        counters.samples += samples;
        counters.vertices += vertices;
        counters.holes += holes;
        counters.left_out += left_out;
    }
    add(launch, 4, &counters);
}

fn fill_holes(launch: &mut Launch<'_>) {
    let (params, weights) = image_params::<Weights>(launch);
    let Some((view, input)) = view(launch, params) else { return };
    let mut counters = FilterCounters::default();
    let first = launch.first + params.first;
    let (mut x, mut y) = (first % params.width, first / params.width);
    for out in launch.output::<Light>(2) {
        let (light, filled) = fill(weights, &view, input, x, y);
        *out = light;
        counters.filled += u64::from(filled == Filled::Filled);
        counters.empty += u64::from(filled == Filled::Empty);
        x += 1;
        if x == params.width {
            (x, y) = (0, y + 1);
        }
    }
    add(launch, 3, &counters);
}

fn pass<D: Denoiser + Pod>(launch: &mut Launch<'_>) {
    let (params, denoiser) = image_params::<D>(launch);
    let Some((view, input)) = view(launch, params) else { return };
    let first = launch.first as usize + params.first as usize;
    filter_pixels(denoiser, params.pass, &view, input, first, launch.output(2));
}

/// The view and the image to read; raises a flag when bindings and parameters do not fit each other.
fn view<'a>(launch: &Launch<'a>, params: &ImageParams) -> Option<(View<'a>, &'a [Light])> {
    let (view, input) = (View::new(params.width, params.height, launch.input(0)), launch.input::<Light>(1));
    let end = launch.first as u64 + launch.count as u64 + params.first as u64;
    let view = view.filter(|view| input.len() == view.pixels() && end <= view.pixels() as u64);
    if view.is_none() {
        launch.raise(Status::OVERFLOW);
    }
    Some((view?, input))
}

fn compose(launch: &mut Launch<'_>) {
    let pixels = of_items::<LayerPixel>(launch, 0);
    let (direct, further) = (of_items::<Light>(launch, 1), of_items::<Light>(launch, 2));
    for (k, out) in launch.output::<Light>(3).iter_mut().enumerate() {
        let light = shown(&direct[k]) + shown(&further[k]);
        let radiance = pixels[k].mean_emitted() + pixels[k].mean_throughput() * light;
        *out = radiance.extend(0.0).to_array();
    }
}

/// A hole shows black.
fn shown(light: &Light) -> Vec3 {
    if is_hole(light) { Vec3::ZERO } else { Vec3::new(light[0], light[1], light[2]) }
}

fn add(launch: &Launch<'_>, slot: usize, counters: &FilterCounters) {
    let words: &[u64; FilterCounters::WORDS] = bytemuck::cast_ref(counters);
    for (sum, word) in launch.atomic_u64(slot).iter().zip(words) {
        if *word > 0 {
            sum.fetch_add(*word, Relaxed);
        }
    }
}
