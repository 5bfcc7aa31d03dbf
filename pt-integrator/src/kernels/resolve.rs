//! From film to image.

use backend_api::{Access, BindingDecl, Kernel, Launch};

use crate::film::FilmPixel;

/// The film's mean radiance; w: number of samples.
///
/// Bindings: film ([`FilmPixel`]), radiance (`[f32; 4]`). No parameters.
pub static RESOLVE: Kernel = Kernel {
    name: "pt.resolve",
    bindings: &[
        BindingDecl { name: "pt_film", access: Access::In, stride: size_of::<FilmPixel>() as u32 },
        BindingDecl { name: "pt_radiance", access: Access::OutPerItem, stride: 16 },
    ],
    params_size: 0,
    body: resolve,
    wgsl: None,
    casts_rays: false,
};

fn resolve(launch: &mut Launch<'_>) {
    let radiance = launch.output::<[f32; 4]>(1);
    let film = &launch.input::<FilmPixel>(0)[launch.first as usize..][..launch.count as usize];
    for (out, pixel) in radiance.iter_mut().zip(film) {
        *out = pixel.mean().to_array();
    }
}
