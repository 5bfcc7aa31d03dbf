//! What absorbs light between two vertices.

use glam::Vec3;
use hashcache_core::float;

use crate::light::LightSample;
use crate::scene::Material;
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
        // The coefficient of a channel that is absorbed wholly may be infinite: light at the surface itself is left.
        let passed = |absorption: f32| if distance > 0.0 { float::exp(-absorption * distance) } else { 1.0 };
        Vec3::from_array(self.0.to_array().map(passed))
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

    /// What the path is in after it was scattered, to the other side if `transmitted`; `self` as of [`Medium::before`].
    #[inline]
    pub fn after(self, surface: &Surface<'_>, transmitted: bool) -> Self {
        match Self::inside(surface) {
            Some(inside) if transmitted => {
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
        if surface.material.flags & Material::VOLUME == 0 {
            return None;
        }
        let [r, g, b, _] = surface.material.interior;
        Some(Self(Vec3::new(r, g, b)))
    }
}
