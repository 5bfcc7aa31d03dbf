//! The kernel of errors.

use backend_api::{Access, BindingDecl, Kernel, Launch};
use bytemuck::{Pod, Zeroable};

use super::{PIXELS, of_items};
use crate::noise::NoisePixel;
use crate::pixel::{Direct, LayerPixel};

/// Parameters of [`NOISE`] (16 bytes).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct NoiseParams {
    /// 1: direct light has sums of its own ([`Direct::Record`]).
    pub direct: u32,
    /// Zero.
    pub reserved: [u32; 3],
}

/// Adds a layer's radiance and the variance of it to each pixel ([`NoisePixel::add`]).
pub static NOISE: Kernel = Kernel {
    name: "lf.noise",
    bindings: &[
        PIXELS,
        BindingDecl { name: "lf_noise", access: Access::OutPerItem, stride: size_of::<NoisePixel>() as u32 },
    ],
    params_size: size_of::<NoiseParams>() as u32,
    body: noise,
    wgsl: None,
    casts_rays: false,
};

const _: () = assert!(NOISE.is_well_formed());

fn noise(launch: &mut Launch<'_>) {
    let direct = if launch.params::<NoiseParams>().direct == 0 { Direct::Estimate } else { Direct::Record };
    let sums = of_items::<LayerPixel>(launch, 0);
    for (pixel, sums) in launch.output::<NoisePixel>(1).iter_mut().zip(sums) {
        pixel.add(sums, direct);
    }
}
