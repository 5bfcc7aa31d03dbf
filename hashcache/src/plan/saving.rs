//! What a frame leaves out.

use std::fmt;

use layered_filter::{Composition, Direct, FilterStages};
use pt_integrator::film::PairedPixel;

use crate::choice::{CacheKind, DirectLight, FilterKind};
use crate::feature::{FEATURES, Saving};
use crate::needs::Needs;
use crate::pipeline::batches::look_bytes;
use crate::settings::Settings;

/// Bytes of a triangle for holes: the index of its mask and the coordinates of its corners.
const MASK_BYTES: u64 = 4 + 24;

/// Bytes of a triangle for second coordinates.
const SECOND_UV_BYTES: u64 = 24;

/// The features that a scene does without, and the bytes that buffers for them would have.
pub(super) fn without(needs: &Needs, settings: &Settings, pixels: u32) -> Vec<Saving> {
    // What is forced is modelled like what is needed.
    let forced = settings.needs_force;
    let absent = FEATURES.iter().filter(|feature| !feature.is_needed(needs) && !forced.contains(feature));
    let saving = |feature, about, bytes| Saving { feature, about, bytes, ns_per_sample: None };
    let mut all: Vec<_> = absent
        .map(|feature| {
            // What only the tracing loop knows has buffers by the scene's own lists, which are empty.
            let bytes = if feature.is_layers() { layer_bytes(settings, pixels) } else { 0 };
            saving(feature.name, feature.about, bytes)
        })
        .collect();
    if !needs.alpha_masks {
        all.push(saving("alpha_masks", "holes by textures' opacity", needs.triangles * MASK_BYTES));
    }
    if !needs.second_uv {
        all.push(saving("second_uv", "second texture coordinates", needs.triangles * SECOND_UV_BYTES));
    }
    if settings.check_fraction <= 0.0 {
        all.push(saving("check", "paths without cache that tell the bias", check_bytes(pixels)));
    }
    all
}

/// Bytes that a check of all pixels would have: their sums and their places.
fn check_bytes(pixels: u32) -> u64 {
    u64::from(pixels) * (size_of::<PairedPixel>() + size_of::<(u32, f64)>()) as u64
}

/// Bytes that further layers would have.
fn layer_bytes(settings: &Settings, pixels: u32) -> u64 {
    if settings.cache == CacheKind::None {
        return 0;
    }
    let composition = match settings.filter {
        FilterKind::Screen => Composition::Screen,
        // As in a scene with rough lobes.
        FilterKind::Layered => Composition::LayeredRough,
        FilterKind::None => Composition::Layered,
    };
    let direct = if settings.direct == DirectLight::Traced { Direct::Record } else { Direct::Estimate };
    let of = |layers| {
        u64::from(pixels) * FilterStages::pixel_bytes(direct, layers, composition) + look_bytes(pixels, layers)
    };
    of(settings.filter_layers) - of(1)
}

impl fmt::Display for Saving {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "leaves out {}: {}", self.feature, self.about)?;
        if self.bytes > 0 {
            write!(f, "; saves {:.1} MiB", self.bytes as f64 / f64::from(1 << 20))?;
        }
        match self.ns_per_sample {
            Some(ns) => write!(f, "; saves {ns:.1} ns a sample"),
            None => Ok(()),
        }
    }
}
