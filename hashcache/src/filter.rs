//! The filter's parameters from scene and settings.

use hashcache_core::error::ParamError;
use layered_filter::{
    ATrous, Composition, CrossBilateral, Direct, Filter, FilterSettings, LuminanceWeight, Taps, WeightSettings,
};
use pt_integrator::camera::CameraRays;
use pt_integrator::scene::Camera;

use crate::choice::{CacheKind, DenoiserKind, DirectLight, FilterKind};
use crate::settings::Settings;

/// What the filter of a session is built with.
pub(crate) fn settings(
    settings: &Settings,
    camera: &Camera,
    scene_radius: f32,
    direct: DirectLight,
) -> Result<FilterSettings, ParamError> {
    let (further, direct_filter) = filters(settings, camera, 1)?;
    Ok(FilterSettings {
        width: camera.width,
        height: camera.height,
        direct: match direct {
            DirectLight::Traced => Direct::Record,
            DirectLight::Cached => Direct::Estimate,
        },
        radius: scene_radius,
        pixel_angle: CameraRays::new(camera).pixel_angle(),
        further,
        direct_filter,
        carried: Filter::None,
        layers: 1,
        composition: Composition::Layered,
    })
}

/// The denoisers of the cache's and of direct light, for pixels of `samples` samples.
pub(crate) fn filters(settings: &Settings, camera: &Camera, samples: u32) -> Result<(Filter, Filter), ParamError> {
    if settings.filter == FilterKind::None {
        return Ok((Filter::None, Filter::None));
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
    let of = |radius: f32, by_samples: f32| -> Result<Filter, ParamError> {
        let passes = settings.filter_passes;
        Ok(match settings.denoiser {
            DenoiserKind::ATrous => Filter::ATrous(ATrous::new(&weights, Taps::Nine, passes)?),
            DenoiserKind::CrossBilateral => {
                let filter = CrossBilateral::new(&weights, radius, passes, settings.seed)?;
                Filter::CrossBilateral(filter.with_radius_by_samples(by_samples)?)
            }
        })
    };
    // Without a cache the samples behind a pixel's light are its own; a cache tells how many its cells have.
    let share = if settings.cache == CacheKind::None { samples.max(1) as f32 } else { 1.0 };
    Ok((of(settings.filter_radius, settings.filter_samples / share)?, of(settings.filter_direct_radius, 0.0)?))
}
