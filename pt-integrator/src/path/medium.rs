//! What absorbs light between two vertices.

use glam::Vec3;
use hashcache_core::float;

use crate::bsdf::{kept_index, relative_index};
use crate::light::LightSample;
use crate::surface::Surface;

/// The solid that a path is in: absorption by channel, 1/m; zero outside.
///
/// One solid is remembered, not a stack of them: a surface met from behind says what the path was in, whatever was
/// remembered, and one that is left leaves nothing. Solids within solids absorb as the one entered last.
///
/// # Source
/// Beer's law; `KHR_materials_volume` for the coefficients.
#[derive(Clone, Copy)]
pub(super) struct Medium(Vec3);

impl Medium {
    /// Nothing absorbs.
    pub const NONE: Self = Self(Vec3::ZERO);

    /// Share of light that is left after `distance`, by channel; exactly 1 outside of all solids.
    #[inline]
    pub fn passed(self, distance: f32) -> Vec3 {
        if self.0 == Vec3::ZERO {
            return Vec3::ONE;
        }
        Vec3::from_array(self.0.to_array().map(|absorption| float::exp(-absorption * distance)))
    }

    /// [`Medium::passed`] on the way to a sampled emitter; light from outside of the scene comes from no solid.
    #[inline]
    pub fn passed_from(self, position: Vec3, light: &LightSample) -> Vec3 {
        match light.target {
            Some(target) if self.0 != Vec3::ZERO => self.passed(float::sqrt((target - position).length_squared())),
            _ => Vec3::ONE,
        }
    }

    /// What the path was in when it arrived at a surface.
    #[inline]
    pub fn before(self, surface: &Surface<'_>) -> Self {
        if surface.from_front { self } else { Self::inside(surface).unwrap_or(self) }
    }

    /// What the path is in after it was scattered, through the face if `crosses`; `self` as of [`Medium::before`].
    #[inline]
    pub fn after(self, surface: &Surface<'_>, crosses: bool) -> Self {
        match Self::inside(surface) {
            Some(inside) if crosses => {
                if surface.from_front {
                    inside
                } else {
                    Self::NONE
                }
            }
            _ => self,
        }
    }

    /// What is behind a surface, if that is a solid that lets light in.
    #[inline]
    fn inside(surface: &Surface<'_>) -> Option<Self> {
        if !surface.material.is_solid() {
            return None;
        }
        let [r, g, b, _] = surface.material.interior;
        Some(Self(Vec3::new(r, g, b)))
    }
}

/// How light from a direction comes through a surface, as far as its shading normal may say otherwise than its face.
///
/// Lobes go by the shading normal; whether a ray is inside of a solid, and which index and absorption that has, goes by
/// the faces that it meets. On smooth-shaded rims both may differ: light that a lobe reflects may come through the face,
/// and light that it lets through may not. Radiance then has to be that of the side from which it comes, or rims shine.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    /// Whether the light comes through the face.
    pub crosses: bool,
    /// Refractive index on the light's side of the face over that on the viewer's.
    pub eta: f32,
    /// What the lobe's value is multiplied by: 1 where normal and face agree.
    pub scale: f32,
}

impl Crossing {
    /// `transmitted`: whether the lobe takes the light for that of the other side.
    #[inline]
    pub fn new(surface: &Surface<'_>, incoming: Vec3, transmitted: bool) -> Self {
        if !surface.material.is_solid() {
            return Self { crosses: transmitted, eta: 1.0, scale: 1.0 };
        }
        let behind = match relative_index(kept_index(surface.material.interior[3]), !surface.from_front) {
            // Nothing is bent.
            0.0 => 1.0,
            index => index,
        };
        let crosses = surface.is_crossed_from(incoming);
        let [eta, taken] = [crosses, transmitted].map(|beyond| if beyond { behind } else { 1.0 });
        let ratio = taken / eta;
        Self { crosses, eta, scale: ratio * ratio }
    }
}
