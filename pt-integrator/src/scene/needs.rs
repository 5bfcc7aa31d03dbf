//! What a scene asks of a path tracer.

use super::{Lobes, Material, NONE};

/// A set of features that a scene uses; what is missing here is not compiled into the loop that traces it.
///
/// Code for a feature asks the scene's data too. So a set with more than a scene uses changes no bit of its picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs(u32);

impl Needs {
    /// A material has a texture for what it scatters.
    pub const TEXTURES: u32 = 1;
    /// A triangle emits.
    pub const TRIANGLE_LIGHTS: u32 = 2;
    /// An environment image emits. (A constant environment is not sampled: scattering by the cosine is already in
    /// proportion to it.)
    pub const ENVIRONMENT_IMAGE: u32 = 4;
    /// A material has a lobe that is not diffuse.
    pub const GLOSSY: u32 = 8;
    /// A material lets light through.
    pub const TRANSMISSION: u32 = 16;
    /// A material has a clear coat.
    pub const COAT: u32 = 32;
    /// A material has a normal map.
    pub const NORMAL_MAPS: u32 = 64;
    /// There are lights without extent.
    pub const PUNCTUAL: u32 = 128;
    /// A material that emits has an emission texture.
    pub const EMISSIVE_TEXTURES: u32 = 256;

    /// Emitters that next-event estimation samples.
    pub const SAMPLED_LIGHTS: u32 = Self::TRIANGLE_LIGHTS | Self::ENVIRONMENT_IMAGE | Self::PUNCTUAL;
    /// What plain Lambertian scenes may need; each combination has a loop of its own.
    pub const LAMBERT: u32 = Self::TEXTURES | Self::TRIANGLE_LIGHTS | Self::ENVIRONMENT_IMAGE;
    /// The rest; scenes that need any of it share one loop.
    pub const GENERAL: u32 =
        Self::GLOSSY | Self::TRANSMISSION | Self::COAT | Self::NORMAL_MAPS | Self::PUNCTUAL | Self::EMISSIVE_TEXTURES;
    /// All bits.
    pub const ALL: u32 = Self::LAMBERT | Self::GENERAL;

    /// The needs of these materials.
    pub fn of_materials(materials: &[Material]) -> Self {
        let bit = |on: bool, bit: u32| if on { bit } else { 0 };
        let of = |m: &Material| {
            let lobes = m.lobes();
            let glossy = lobes.bits() & !Lobes::DIFFUSE.bits() != 0;
            let textured = |places: &[usize]| places.iter().any(|&place| m.textures[place] != NONE);
            let scattering = &[
                Material::METALLIC_ROUGHNESS,
                Material::SPECULAR,
                Material::SPECULAR_COLOR,
                Material::TRANSMISSION,
                Material::CLEARCOAT,
                Material::CLEARCOAT_ROUGHNESS,
            ];
            bit(textured(&[Material::BASE_COLOR]) || glossy && textured(scattering), Self::TEXTURES)
                | bit(glossy, Self::GLOSSY)
                | bit(lobes.contains(Lobes::TRANSMISSION), Self::TRANSMISSION)
                | bit(lobes.contains(Lobes::COAT), Self::COAT)
                | bit(m.has_normal_map(), Self::NORMAL_MAPS)
                | bit(m.emits() && textured(&[Material::EMISSION]), Self::EMISSIVE_TEXTURES)
        };
        Self(materials.iter().fold(0, |bits, material| bits | of(material)))
    }

    /// The set with these bits added; unknown bits are dropped.
    #[must_use]
    pub const fn with(self, bits: u32) -> Self {
        Self((self.0 | bits) & Self::ALL)
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

    /// Whether one of these bits is set.
    pub const fn intersects(self, bits: u32) -> bool {
        self.0 & bits != 0
    }
}
