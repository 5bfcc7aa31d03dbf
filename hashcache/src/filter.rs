//! The filter's parameters from scene and settings.

use hashcache_core::error::ParamError;
use layered_filter::{
    ATrous, Composition, CrossBilateral, Direct, Filter, FilterSettings, LuminanceWeight, Taps, WeightSettings,
};
use pt_integrator::camera::CameraRays;
use pt_integrator::scene::Camera;

use crate::choice::{CacheKind, DenoiserKind, DirectLight, FilterKind};
use crate::plan::FramePlan;
use crate::settings::Settings;

/// What the filter of a session is built with.
pub(crate) fn settings(
    settings: &Settings,
    plan: &FramePlan,
    camera: &Camera,
    scene_radius: f32,
) -> Result<FilterSettings, ParamError> {
    let Filters { further, direct: direct_filter, carried } = filters(settings, camera, 1)?;
    Ok(FilterSettings {
        width: camera.width,
        height: camera.height,
        direct: match plan.direct {
            DirectLight::Traced => Direct::Record,
            DirectLight::Cached => Direct::Estimate,
        },
        radius: scene_radius,
        pixel_angle: CameraRays::new(camera).pixel_angle(),
        further,
        direct_filter,
        carried,
        layers: plan.layers,
        composition: match settings.filter {
            FilterKind::Screen => Composition::Screen,
            FilterKind::Layered if plan.needs.rough_lobes => Composition::LayeredRough,
            FilterKind::Layered | FilterKind::None => Composition::Layered,
        },
    })
}

/// The denoisers of a picture.
pub(crate) struct Filters {
    /// Of the cache's light.
    pub further: Filter,
    /// Of direct light that is apart.
    pub direct: Filter,
    /// Of light from behind that is filtered once more.
    pub carried: Filter,
}

/// Whether a wide pass comes before the others: over light of a cache that tells how noisy its answers are, which is the
/// octree, by the denoiser that has one.
pub(crate) fn has_wide_pass(settings: &Settings) -> bool {
    settings.filter != FilterKind::None
        && settings.cache == CacheKind::Octree
        && settings.denoiser == DenoiserKind::CrossBilateral
        && settings.filter_wide_radius > 0.0
}

/// The denoisers for pixels of `samples` samples.
pub(crate) fn filters(settings: &Settings, camera: &Camera, samples: u32) -> Result<Filters, ParamError> {
    if settings.filter == FilterKind::None {
        return Ok(Filters { further: Filter::None, direct: Filter::None, carried: Filter::None });
    }
    let footprint = CameraRays::new(camera).pixel_angle();
    let weights = WeightSettings {
        normal_squarings: settings.filter_normal,
        path_scale: settings.filter_path,
        segment_scale: settings.filter_segment,
        // A bell of so many footprints; a footprint is path length times angle.
        plane_scale: if settings.filter_plane > 0.0 { 1.0 / (settings.filter_plane * footprint) } else { 0.0 },
        color_diffuse: settings.filter_color,
        luminance: match settings.filter_luminance {
            0.0 => LuminanceWeight::Off,
            scale => LuminanceWeight::Deviation { scale },
        },
        ..WeightSettings::PAPER
    };
    let wide = has_wide_pass(settings);
    let of = |radius: f32, by_samples: f32, wide: bool| -> Result<Filter, ParamError> {
        let passes = settings.filter_passes;
        Ok(match settings.denoiser {
            DenoiserKind::ATrous => Filter::ATrous(ATrous::new(&weights, Taps::Nine, passes)?),
            DenoiserKind::CrossBilateral => {
                let filter = CrossBilateral::new(&weights, radius, passes, settings.seed)?;
                let filter = filter.with_radius_by_samples(by_samples)?;
                let (radius, samples) = (settings.filter_wide_radius, settings.filter_wide_samples);
                Filter::CrossBilateral(if wide {
                    filter.with_wide_pass(&weights, radius, samples, settings.filter_significance)?
                } else {
                    filter
                })
            }
        })
    };
    // Without a cache the samples behind a pixel's light are its own; a cache tells how many its cells have.
    let share = if settings.cache == CacheKind::None { samples.max(1) as f32 } else { 1.0 };
    Ok(Filters {
        further: of(settings.filter_radius, settings.filter_samples / share, wide)?,
        direct: of(settings.filter_direct_radius, 0.0, false)?,
        carried: of(settings.filter_radius, settings.filter_samples, false)?,
    })
}
