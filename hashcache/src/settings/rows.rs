//! The settings by name: one row each.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use serde_json::Value;

use super::{MAX_BOUNCES, MAX_RESOLUTION, MAX_SIDE, MAX_SPP, MAX_STORE, Settings};
use crate::choice::Choice;
use crate::feature::FeatureSet;

/// A setting: its name, how it is read and how it is set.
pub(super) struct Row {
    pub key: &'static str,
    pub get: fn(&Settings) -> Value,
    /// Sets, or tells what the setting takes.
    pub set: fn(&mut Settings, &str) -> Result<(), String>,
}

macro_rules! choice {
    ($key:literal, $field:ident) => {
        Row {
            key: $key,
            get: |s| s.$field.name().into(),
            set: |s, v| {
                s.$field = Choice::parse(v)?;
                Ok(())
            },
        }
    };
}

macro_rules! number {
    ($key:literal, $field:ident, $range:expr) => {
        Row {
            key: $key,
            get: |s| s.$field.into(),
            set: |s, v| {
                s.$field = within(v, &$range)?;
                Ok(())
            },
        }
    };
}

/// A number that is 0 for "off", and else in the range that has a meaning.
macro_rules! off_or {
    ($key:literal, $field:ident, $range:expr) => {
        Row {
            key: $key,
            get: |s| s.$field.into(),
            set: |s, v| {
                let off = v.parse().is_ok_and(|x: f32| x == 0.0);
                s.$field = if off { 0.0 } else { within(v, &$range).map_err(|told| format!("0 (off) or {told}"))? };
                Ok(())
            },
        }
    };
}

/// All settings.
pub(super) const ROWS: &[Row] = &[
    choice!("backend", backend),
    choice!("integrator", integrator),
    choice!("cache", cache),
    choice!("visibility", visibility),
    choice!("filter", filter),
    number!("spp", spp, 1..=MAX_SPP),
    Row { key: "size", get: |s| s.size.map_or(Value::Null, |(w, h)| format!("{w}x{h}").into()), set: set_size },
    Row {
        key: "camera",
        get: |s| s.camera.clone().into(),
        set: |s, v| {
            s.camera = Some(v.to_owned());
            Ok(())
        },
    },
    Row {
        key: "env",
        get: |s| s.env.as_ref().map(|path| path.to_string_lossy().into_owned()).into(),
        set: |s, v| {
            s.env = Some(v.into());
            Ok(())
        },
    },
    number!("env_scale", env_scale, 0.0..=1e12),
    number!("env.rotation", env_rotation, -3600.0..=3600.0),
    number!("max_bounces", max_bounces, 0..=MAX_BOUNCES),
    number!("seed", seed, 0..=u32::MAX),
    number!("threads", threads, 0..=1024),
    choice!("cpu.launcher", launcher),
    Row {
        key: "path.roulette_depth",
        get: |s| s.roulette_depth.map_or("off".into(), Value::from),
        set: |s, v| {
            s.roulette_depth = optional(v, "off", &(1..=MAX_BOUNCES))?;
            Ok(())
        },
    },
    choice!("path.moments", path_moments),
    Row {
        key: "cache.roulette_depth",
        get: |s| s.cache_roulette_depth.map_or("off".into(), Value::from),
        set: |s, v| {
            s.cache_roulette_depth = optional(v, "off", &(1..=MAX_BOUNCES))?;
            Ok(())
        },
    },
    choice!("cache.direct", direct),
    number!("cache.crf", crf, 0.05..=8.0),
    number!("cache.store", store, 1..=MAX_STORE),
    Row {
        key: "cache.length",
        get: |s| s.store_length.map_or("auto".into(), Value::from),
        set: |s, v| {
            s.store_length = optional(v, "auto", &(0..=MAX_BOUNCES))?;
            Ok(())
        },
    },
    number!("direct.samples", direct_samples, 1..=256),
    number!("direct.candidates", direct_candidates, 1..=64),
    number!("direct.scattered", direct_scattered, 0..=64),
    number!("reconstruct.samples", reconstruct_samples, 1..=4096),
    Row {
        key: "needs.force",
        get: |s| s.needs_force.to_string().into(),
        set: |s, v| {
            s.needs_force = FeatureSet::parse(v)?;
            Ok(())
        },
    },
    number!("filter.layers", filter_layers, 1..=layered_filter::MAX_LAYERS),
    choice!("filter.denoiser", denoiser),
    number!("filter.passes", filter_passes, 1..=8),
    number!("filter.radius", filter_radius, 1.0..=256.0),
    number!("filter.samples", filter_samples, 0.0..=1e9),
    off_or!("filter.wide_radius", filter_wide_radius, 1.0..=256.0),
    number!("filter.wide_samples", filter_wide_samples, 0.0..=1e9),
    number!("filter.significance", filter_significance, 0.001..=1e6),
    number!("filter.direct_radius", filter_direct_radius, 1.0..=256.0),
    off_or!("filter.luminance", filter_luminance, 0.001..=1e6),
    number!("filter.normal", filter_normal, 0..=10),
    number!("filter.path", filter_path, 0.0..=1e9),
    number!("filter.segment", filter_segment, 0.0..=1e9),
    off_or!("filter.plane", filter_plane, 0.01..=1e4),
    number!("filter.color", filter_color, 0.0..=1e6),
    Row {
        key: "octree.resolution",
        get: |s| s.octree_resolution.map_or("auto".into(), Value::from),
        set: |s, v| {
            let resolution = optional(v, "auto", &(4..=MAX_RESOLUTION))?;
            if resolution.is_some_and(|n| !n.is_power_of_two()) {
                return Err(format!("auto or a power of two from 4 to {MAX_RESOLUTION}"));
            }
            s.octree_resolution = resolution;
            Ok(())
        },
    },
    number!("octree.memory", octree_memory, 1..=1 << 20),
    number!("octree.cell", octree_cell, 0.01..=10_000.0),
    number!("octree.jitter", octree_jitter, 0.0..=2.0),
    number!("octree.min_samples", octree_min_samples, 0..=1 << 24),
    number!("octree.shrinkage", octree_shrinkage, 0.0..=65_536.0),
    number!("octree.max_climb", octree_max_climb, 0..=31),
    choice!("octree.layout", octree_layout),
    number!("grid.cell", grid_cell, 0.01..=10_000.0),
    number!("grid.jitter", grid_jitter, 0.0..=1.0),
    Row {
        key: "grid.normal_bins",
        get: |s| s.grid_normal_bins.into(),
        set: |s, v| {
            let odd = v.parse().ok().filter(|bins| bins % 2 == 1 && *bins <= 15);
            s.grid_normal_bins = odd.ok_or("an odd number from 1 to 15")?;
            Ok(())
        },
    },
    Row {
        key: "grid.slots",
        get: |s| s.grid_slots.map_or("auto".into(), Value::from),
        set: |s, v| {
            let slots = optional(v, "auto", &(64..=1 << 28))?;
            if slots.is_some_and(|n| !n.is_power_of_two()) {
                return Err("auto or a power of two from 64 to 268435456".into());
            }
            s.grid_slots = slots;
            Ok(())
        },
    },
    number!("grid.max_probes", grid_max_probes, 1..=64),
    number!("grid.history", grid_history, 0..=1_000_000),
    number!("check.fraction", check_fraction, 0.0..=1.0),
    Row {
        key: "check.spp",
        get: |s| s.check_spp.into(),
        set: |s, v| {
            let even = v.parse().ok().filter(|spp| spp % 2 == 0 && (2..=MAX_SPP).contains(spp));
            s.check_spp = even.ok_or_else(|| format!("an even number from 2 to {MAX_SPP}"))?;
            Ok(())
        },
    },
    number!("image.exposure", image_exposure, -100.0..=100.0),
    choice!("image.tonemap", image_tonemap),
];

/// A number of a range, or what is expected.
fn within<T: FromStr + PartialOrd + Display>(value: &str, range: &RangeInclusive<T>) -> Result<T, String> {
    let number = value.parse().ok().filter(|x| range.contains(x));
    number.ok_or_else(|| format!("a number from {} to {}", range.start(), range.end()))
}

fn optional(value: &str, none: &str, range: &RangeInclusive<u32>) -> Result<Option<u32>, String> {
    if value == none {
        return Ok(None);
    }
    within(value, range).map(Some).map_err(|told| format!("{none} or {told}"))
}

fn set_size(settings: &mut Settings, value: &str) -> Result<(), String> {
    let side = |text: &str| text.parse::<u32>().ok().filter(|n| (1..=MAX_SIDE).contains(n));
    let size = value.split_once(['x', 'X']).and_then(|(w, h)| Some((side(w)?, side(h)?)));
    settings.size = Some(size.ok_or_else(|| format!("WIDTHxHEIGHT, each from 1 to {MAX_SIDE}"))?);
    Ok(())
}
