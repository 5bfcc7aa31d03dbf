//! Whether a ray can meet an emitter at all.

use hashcache_core::geometry::Ray;

use super::TriangleLight;

/// Most emitters that are tried one by one. Trying so many costs about as much as half a ray in a large scene; with
/// more of them rays meet one too often for the trial to pay.
pub const MAX_TRIED: usize = 16;

/// Relative to the triangle: far more than rounding moves a hit in or out of it.
const SLACK: f32 = 1.0 / 1024.0;

/// Relative to the products that are compared: some units in the last place.
const ROUNDING: f32 = 1.0 / 262_144.0;

/// `false`: the ray meets none of these emitters' bright sides, whatever else stands in its way. `true`: perhaps.
///
/// A ray that is only asked for emission need not be cast when this is false.
///
/// # Source
/// Möller & Trumbore 1997, without the division, and with slack: no hit that a ray caster finds is missed.
#[inline]
pub fn may_meet_emitter(lights: &[TriangleLight], ray: &Ray) -> bool {
    lights.len() > MAX_TRIED || lights.iter().any(|light| may_meet(light, ray))
}

#[inline]
fn may_meet(light: &TriangleLight, ray: &Ray) -> bool {
    let [vertex, edge1, edge2, normal] =
        [&light.vertex, &light.edge1, &light.edge2, &light.normal].map(|v| glam::Vec3::new(v[0], v[1], v[2]));
    if light.normal[3] == 0.0 && normal.dot(ray.direction) > SLACK {
        return false;
    }
    let p = ray.direction.cross(edge2);
    let determinant = edge1.dot(p);
    let (sign, size) = (1.0_f32.copysign(determinant), determinant.abs());
    let s = ray.origin - vertex;
    let q = s.cross(edge1);
    let (u, v, t) = (s.dot(p) * sign, ray.direction.dot(q) * sign, edge2.dot(q) * sign);
    let sum = |v: glam::Vec3| v.abs().element_sum();
    let (around, far) = (sum(edge1).max(sum(edge2)), sum(s));
    let slack = size * SLACK + around * far * ROUNDING;
    // Turned round, so that numbers beyond f32's range count as a meeting.
    !(u < -slack || v < -slack || u + v > size + 2.0 * slack || t < -around * slack)
}
