//! From film to image.

use backend_api::{Access, BindingDecl, Kernel, Launch};

use crate::film::{FilmPixel, MomentPixel};

/// The film's mean radiance; w: number of samples.
///
/// Bindings: film ([`FilmPixel`]), radiance (`[f32; 4]`). No parameters.
pub static RESOLVE: Kernel = Kernel {
    name: "pt.resolve",
    bindings: &[BindingDecl { name: "pt_film", access: Access::In, stride: size_of::<FilmPixel>() as u32 }, RADIANCE],
    params_size: 0,
    body: |launch| resolve::<FilmPixel>(launch, |pixel| pixel.mean().to_array()),
    wgsl: None,
    casts_rays: false,
};

/// [`RESOLVE`] of a film of [`MomentPixel`]; w: variance of the mean's luminance ([`MomentPixel::variance`]).
pub static RESOLVE_MOMENTS: Kernel = Kernel {
    name: "pt.resolve_moments",
    bindings: &[BindingDecl { name: "pt_film", access: Access::In, stride: size_of::<MomentPixel>() as u32 }, RADIANCE],
    params_size: 0,
    body: |launch| resolve::<MomentPixel>(launch, |pixel| pixel.film.mean().with_w(pixel.variance()).to_array()),
    wgsl: None,
    casts_rays: false,
};

const RADIANCE: BindingDecl = BindingDecl { name: "pt_radiance", access: Access::OutPerItem, stride: 16 };

const _: () = assert!(RESOLVE.is_well_formed() && RESOLVE_MOMENTS.is_well_formed());

fn resolve<P: bytemuck::Pod>(launch: &mut Launch<'_>, texel: impl Fn(&P) -> [f32; 4]) {
    let radiance = launch.output::<[f32; 4]>(1);
    let film = &launch.input::<P>(0)[launch.first as usize..][..launch.count as usize];
    for (out, pixel) in radiance.iter_mut().zip(film) {
        *out = texel(pixel);
    }
}
