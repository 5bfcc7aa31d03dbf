//! Rough surfaces of microfacets, in a frame whose z axis is the normal.

use core::f32::consts::{FRAC_1_PI, TAU};

use glam::{Vec2, Vec3};
use hashcache_core::float;

/// The GGX distribution of microfacet normals with Smith's masking, seen from one direction.
///
/// Masking and shadowing of reflected light are height-correlated; those of transmitted light are independent.
///
/// # Source
/// Walter et al. 2007 (distribution, transmission), Heitz 2014 (visible normals, correlated masking),
/// Dupuy & Benyoub 2023 (sampling), Eto & Tokuyoshi 2023 (the bound of reflection).
#[derive(Clone, Copy, Debug)]
pub(super) struct Ggx {
    /// Width of the distribution of slopes.
    alpha: f32,
    /// Unit direction of view; z at least [`SMALLEST_COSINE`].
    pub view: Vec3,
    /// √(α²·(1 − z²) + z²) of the view.
    stretched: f32,
}

/// A smaller z would square to nothing beside 1.
const SMALLEST_COSINE: f32 = 1.0 / 1_048_576.0;

/// A microfacet that was drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    pub normal: Vec3,
    /// Cosine between its normal and the view.
    pub cosine: f32,
}

/// Light at a microfacet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scattering {
    /// Cosine between the facet's normal and the view: the angle for Fresnel's equations.
    pub cosine: f32,
    /// f·|cos θ| without Fresnel's factor.
    pub value: f32,
    /// Density by solid angle of the light's direction.
    pub pdf: f32,
}

impl Ggx {
    /// `view` is of unit length and has z above 0; `alpha` is above 2⁻¹² or so.
    #[inline]
    pub fn new(alpha: f32, view: Vec3) -> Self {
        let z = view.z.max(SMALLEST_COSINE);
        Self { alpha, view: Vec3::new(view.x, view.y, z), stretched: stretched(alpha, z) }
    }

    /// Without microfacets: nothing but the view is of use.
    #[inline]
    pub fn smooth(view: Vec3) -> Self {
        Self { alpha: 1.0, view, stretched: 1.0 }
    }

    #[inline]
    pub fn alpha(&self) -> f32 {
        self.alpha
    }

    /// Reflection of light from a direction with z above 0.
    #[inline]
    pub fn reflect(&self, light: Vec3) -> Scattering {
        let half = self.view + light;
        let squared = half.length_squared();
        let distribution = self.distribution(half, squared);
        Scattering {
            // |view + light| / 2, as both are of unit length.
            cosine: (0.5 * float::sqrt(squared)).min(1.0),
            value: distribution * 0.5 * light.z / self.masking(light.z),
            pdf: distribution * 0.5 / (self.bound() * self.view.z + self.stretched),
        }
    }

    /// Draws light for reflection: its direction, [`Scattering::cosine`], value / pdf, and the pdf. `None`: the facet
    /// sends light into the surface.
    #[inline]
    pub fn sample_reflection(&self, u: Vec2) -> Option<(Vec3, f32, f32, f32)> {
        let bound = self.bound();
        let facet = self.facet(u, bound);
        let light = facet.normal * (2.0 * facet.cosine) - self.view;
        let reach = bound * self.view.z + self.stretched;
        let pdf = self.distribution(facet.normal, 1.0) * 0.5 / reach;
        let weight = light.z * reach / self.masking(light.z);
        (light.z > 0.0).then_some((light, facet.cosine, weight, pdf))
    }

    /// Refraction of light from a direction with z below 0. `eta`: index on the light's side over that on the viewer's,
    /// not 1. The value is without Fresnel's factor, and divided by η² as radiance is.
    #[inline]
    pub fn refract(&self, light: Vec3, eta: f32) -> Option<Scattering> {
        let half = self.view + light * eta;
        let half = half * 1.0_f32.copysign(half.z);
        let squared = half.length_squared();
        let length = float::sqrt(squared);
        let (cosine, behind) = (self.view.dot(half) / length, -light.dot(half) / length);
        // Such a facet shows its front to the viewer and its back to the light; NaN does neither.
        (cosine > 0.0 && behind > 0.0).then(|| {
            let jacobian = eta * eta * behind / squared;
            let pdf = self.visible(half, squared, cosine) * jacobian;
            Scattering { cosine, value: pdf * self.shadowing(light.z) / (eta * eta), pdf }
        })
    }

    /// Draws light for refraction, as [`sample_reflection`](Self::sample_reflection). `None` also for total reflection.
    #[inline]
    pub fn sample_refraction(&self, u: Vec2, eta: f32) -> Option<(Vec3, f32, f32, f32)> {
        let facet = self.facet(u, 1.0);
        let cosine = facet.cosine;
        let (light, bent) = refracted(self.view, facet.normal, cosine, eta)?;
        // |view + η·light|, without its cancellation.
        let length = (eta - 1.0) * (eta + 1.0) / (cosine + bent);
        let jacobian = eta * bent / (length * length);
        let pdf = self.visible(facet.normal, 1.0, cosine) * jacobian;
        (light.z < 0.0).then_some((light, cosine, self.shadowing(light.z) / (eta * eta), pdf))
    }

    /// Density of facets by solid angle of their normals, for a vector in the normal's direction and its squared length.
    #[inline]
    fn distribution(&self, normal: Vec3, squared: f32) -> f32 {
        let squared_alpha = self.alpha * self.alpha;
        // From the tangential part: 1 − z² loses all digits at small roughness.
        let slope = normal.x * normal.x + normal.y * normal.y + squared_alpha * (normal.z * normal.z);
        let ratio = squared * self.alpha / slope;
        FRAC_1_PI * ratio * ratio
    }

    /// Density of the facets that the viewer sees, by solid angle of their normals.
    #[inline]
    fn visible(&self, normal: Vec3, squared: f32, cosine: f32) -> f32 {
        self.distribution(normal, squared) * 2.0 * cosine / (self.view.z + self.stretched)
    }

    /// 2·cos θ·cos θ′ over the height-correlated masking and shadowing.
    #[inline]
    fn masking(&self, light_z: f32) -> f32 {
        light_z * self.stretched + self.view.z * stretched(self.alpha, light_z)
    }

    /// Share of the facets towards the light that the light reaches.
    #[inline]
    fn shadowing(&self, light_z: f32) -> f32 {
        let z = light_z.abs();
        2.0 * z / (z + stretched(self.alpha, z))
    }

    /// By how much the cap of facets shrinks when those that reflect into the surface are left out.
    #[inline]
    fn bound(&self) -> f32 {
        let Vec3 { x, y, z } = self.view;
        let s = 1.0 + float::sqrt(x * x + y * y);
        let (a, s) = (self.alpha * self.alpha, s * s);
        (1.0 - a) * s / (s + a * z * z)
    }

    /// Draws a facet that the viewer sees: a point on a cap of the unit sphere, after stretching the surface until it
    /// has roughness 1.
    #[inline]
    fn facet(&self, u: Vec2, bound: f32) -> Facet {
        let inverse = 1.0 / self.stretched;
        let view = Vec3::new(self.view.x * self.alpha, self.view.y * self.alpha, self.view.z) * inverse;
        let (sine, cosine) = float::sin_cos(TAU * u.x);
        // 1 − z, so that the sine keeps its digits near the pole.
        let drop = u.y * (1.0 + bound * view.z);
        let radius = float::sqrt((drop * (2.0 - drop)).max(0.0));
        let half = Vec3::new(radius * cosine + view.x, radius * sine + view.y, 1.0 - drop + view.z);
        let normal = Vec3::new(half.x * self.alpha, half.y * self.alpha, half.z.max(0.0));
        let squared = normal.length_squared();
        let normal = if squared > 0.0 { normal * (1.0 / float::sqrt(squared)) } else { Vec3::Z };
        Facet { normal, cosine: self.view.dot(normal).clamp(0.0, 1.0) }
    }
}

/// √(α²·(1 − z²) + z²): length of a unit vector after its tangential part has been stretched by α.
#[inline]
fn stretched(alpha: f32, z: f32) -> f32 {
    let squared = z * z;
    float::sqrt((alpha * alpha * (1.0 - squared)).max(0.0) + squared)
}

/// The direction from which light reaches the viewer through an interface, and η times the cosine of its angle to the
/// normal. `None` beyond the critical angle.
#[inline]
pub(super) fn refracted(view: Vec3, normal: Vec3, cosine: f32, eta: f32) -> Option<(Vec3, f32)> {
    let bent = (eta - 1.0) * (eta + 1.0) + cosine * cosine;
    (bent > 0.0).then(|| {
        let bent = float::sqrt(bent);
        let light = normal * (cosine - bent) - view;
        // Of length η, but not when η is so small that it drowns in rounding.
        (light * (1.0 / float::sqrt(light.length_squared())), bent)
    })
}
