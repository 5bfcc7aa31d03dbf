//! What a scene asks of a path tracer.

use super::{Material, NONE};

/// A set of features that a scene uses; what is missing here is not compiled into the loop that traces it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs(u32);

impl Needs {
    /// A material has a base colour texture.
    pub const TEXTURES: u32 = 1;
    /// A triangle emits.
    pub const TRIANGLE_LIGHTS: u32 = 2;
    /// An environment image emits. (A constant environment is not sampled: scattering by the cosine is already in
    /// proportion to it.)
    pub const ENVIRONMENT_IMAGE: u32 = 4;
    /// Emitters that next-event estimation samples.
    pub const SAMPLED_LIGHTS: u32 = Self::TRIANGLE_LIGHTS | Self::ENVIRONMENT_IMAGE;
    /// All bits.
    pub const ALL: u32 = 7;

    /// The needs of these materials and emitters.
    pub fn of(materials: &[Material], triangle_lights: bool, environment_image: bool) -> Self {
        let textures = materials.iter().any(|m| m.base_color_texture != NONE);
        let bit = |on: bool, bit: u32| if on { bit } else { 0 };
        Self(
            bit(textures, Self::TEXTURES)
                | bit(triangle_lights, Self::TRIANGLE_LIGHTS)
                | bit(environment_image, Self::ENVIRONMENT_IMAGE),
        )
    }

    /// The set as stored; unknown bits are dropped.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits & Self::ALL)
    }

    /// The word as stored.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether all these bits are set.
    pub const fn contains(self, bits: u32) -> bool {
        self.0 & bits == bits
    }
}
