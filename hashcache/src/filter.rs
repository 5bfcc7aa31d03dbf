//! The filter's parameters from scene and settings.

use hashcache_core::error::ParamError;
use layered_filter::{ATrous, CrossBilateral, Direct, Filter, FilterSettings, LuminanceWeight, Taps, WeightSettings};
use pt_integrator::camera::CameraRays;
use pt_integrator::scene::Camera;

use crate::choice::{DenoiserKind, DirectLight, FilterKind};
use crate::settings::Settings;

/// What the filter of a session is built with.
pub(crate) fn settings(
    settings: &Settings,
    camera: &Camera,
    scene_radius: f32,
    direct: DirectLight,
) -> Result<FilterSettings, ParamError> {
    let (further, direct_filter) = filters(settings)?;
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
    })
}

/// The denoisers of the cache's and of direct light.
fn filters(settings: &Settings) -> Result<(Filter, Filter), ParamError> {
    if settings.filter == FilterKind::None {
        return Ok((Filter::None, Filter::None));
    }
    let of = |luminance: f32| -> Result<Filter, ParamError> {
        let weights = WeightSettings {
            normal_squarings: settings.filter_normal,
            path_scale: settings.filter_path,
            segment_scale: settings.filter_segment,
            plane_scale: settings.filter_plane,
            color_diffuse: settings.filter_color,
            luminance: LuminanceWeight::Deviation { scale: luminance },
            ..WeightSettings::PAPER
        };
        Ok(match settings.denoiser {
            DenoiserKind::ATrous => Filter::ATrous(ATrous::new(&weights, Taps::Nine, settings.filter_passes)?),
            DenoiserKind::CrossBilateral => Filter::CrossBilateral(CrossBilateral::new(
                &weights,
                settings.filter_radius,
                settings.filter_passes,
                settings.seed,
            )?),
        })
    };
    Ok((of(settings.filter_luminance)?, of(settings.filter_direct_luminance)?))
}
