//! A box whose picture is known exactly.

use glam::{DMat4, DVec3};
use pt_integrator::scene::Material;

use super::Builtin;
use super::shapes::cube;
use crate::builder::Builder;
use crate::view::View;

pub(super) const SCENE: Builtin = Builtin {
    name: "furnace",
    description: "inside a closed grey box that glows: with N bounces every pixel is exactly 2 - 1/2^N; 256x256",
    parameter: None,
    build: |builder, _| build(builder),
    view,
    size: [256, 256],
};

/// A closed box from −1 to 1, seen from inside, whose walls reflect half and emit radiance 1 to the inside.
///
/// Every point sees the same radiance from everywhere, so each bounce adds half of what the one before did: radiance is
/// the sum of 2⁻ᵏ for k = 0…N, which is 2 − 2⁻ᴺ, after at most N bounces, and 2 without a limit.
fn build(builder: &mut Builder) {
    builder.data.materials = vec![Material::emissive([0.5; 3], [1.0; 3])];
    cube(builder, DMat4::from_scale(DVec3::NEG_ONE), 0);
    builder.finish_world_mesh();
}

fn view() -> Result<View, &'static str> {
    let (position, target) = (DVec3::new(0.3, 0.2, 0.7), DVec3::new(-0.4, -0.3, -1.0));
    View::look_at("camera".into(), position, target, DVec3::Y, 60_f64.to_radians())
}
