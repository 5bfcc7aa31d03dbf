//! Materials and views for the tests of lobes.
#![allow(dead_code, reason = "each test binary uses some of it")]

use pt_integrator::bsdf::{Bsdf, BsdfInputs};
use pt_integrator::glam::{Vec2, Vec3};

/// Some normal that is no axis.
pub const NORMAL: Vec3 = Vec3::new(0.48, 0.6, -0.64);
const TANGENT: Vec3 = Vec3::new(0.8, -0.6, 0.0352);

pub fn glossy(roughness: f32) -> BsdfInputs {
    BsdfInputs { roughness, specular: 1.0, coat_normal: NORMAL, ..BsdfInputs::lambert(Vec3::ONE) }
}

pub fn metal(roughness: f32) -> BsdfInputs {
    BsdfInputs { metallic: 1.0, ..glossy(roughness) }
}

/// A solid.
pub fn glass(roughness: f32, ior: f32) -> BsdfInputs {
    BsdfInputs { transmission: 1.0, thin: false, ior, ..glossy(roughness) }
}

/// A thin wall.
pub fn pane(roughness: f32, ior: f32) -> BsdfInputs {
    BsdfInputs { thin: true, ..glass(roughness, ior) }
}

/// A clear coat over something.
pub fn coated(base: BsdfInputs, clearcoat_roughness: f32) -> BsdfInputs {
    BsdfInputs { clearcoat: 1.0, clearcoat_roughness, ..base }
}

/// The unit direction at this cosine to [`NORMAL`].
pub fn at_cosine(cosine: f32) -> Vec3 {
    let tangent = (TANGENT - NORMAL * TANGENT.dot(NORMAL)).normalize();
    (NORMAL * cosine + tangent * (1.0 - cosine * cosine).max(0.0).sqrt()).normalize()
}

pub fn seen(inputs: &BsdfInputs, cosine: f32, entering: bool) -> Bsdf {
    Bsdf::new(inputs, NORMAL, at_cosine(cosine), entering)
}

/// Midpoints of `n` × `n` equal squares of the unit square.
pub fn grid(n: usize) -> impl Iterator<Item = Vec2> {
    (0..n * n).map(move |i| Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32)
}
