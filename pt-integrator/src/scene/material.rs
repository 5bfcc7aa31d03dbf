//! Materials.

use bytemuck::{Pod, Zeroable};

use super::NONE;

/// A surface: what it reflects, lets through and emits. 160 bytes; what every hit reads stands first.
///
/// Parameters are those of glTF's metallic-roughness material and its extensions. Each is a factor on its texture, if
/// it has one.
///
/// ```
/// use pt_integrator::scene::{Lobes, Material};
/// let plain = Material::lambert([0.5; 3]);
/// assert_eq!(plain.lobes(), Lobes::DIFFUSE);
/// let plastic = Material { specular: [1.0; 4], ..plain };
/// assert_eq!(plastic.lobes(), Lobes::DIFFUSE | Lobes::REFLECTION);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Material {
    /// Linear Rec. 709 albedo; w: opacity.
    pub base_color: [f32; 4],
    /// Emitted radiance, linear Rec. 709; w: opacity below which an [`Material::ALPHA_MASK`] surface is not there.
    pub emission: [f32; 4],
    /// Indices of textures, or [`NONE`]: [`Material::BASE_COLOR`] and so on are the places. The rest is [`NONE`].
    pub textures: [u32; 12],
    /// [`Material::DOUBLE_SIDED`] and so on.
    pub flags: u32,
    /// Zero.
    pub reserved: [u32; 3],
    /// Colour of the dielectric reflection at normal incidence, linear Rec. 709; w: factor on all of it. Factor 0: the
    /// surface reflects like a Lambertian one.
    pub specular: [f32; 4],
    /// Absorption inside of the solid by channel, 1/m; w: index of refraction, at least 1.
    pub interior: [f32; 4],
    /// Metalness, roughness (its square is the microfacets' α), transmission, and the factor on the normal map's
    /// tangential part.
    pub surface: [f32; 4],
    /// Clear coat, its roughness, the factor on its normal map's tangential part, 0.
    pub coat: [f32; 4],
}

impl Material {
    /// Flag: emits from both sides. Without it a triangle emits from its front (counter-clockwise) side only.
    /// Reflection is two-sided in either case.
    pub const DOUBLE_SIDED: u32 = 1;
    /// Flag: encloses a solid that refracts and absorbs. Without it transmission is that of a thin sheet.
    pub const VOLUME: u32 = 2;
    /// Flag: the surface is not there where its opacity is below the cutoff.
    pub const ALPHA_MASK: u32 = 4;
    /// Flag: emits its base colour and scatters nothing.
    pub const UNLIT: u32 = 8;

    /// Place in `textures`: base colour, sRGB-encoded.
    pub const BASE_COLOR: usize = 0;
    /// Place in `textures`: roughness (green), metalness (blue).
    pub const METALLIC_ROUGHNESS: usize = 1;
    /// Place in `textures`: normal in the frame of the texture coordinates.
    pub const NORMAL: usize = 2;
    /// Place in `textures`: emission, sRGB-encoded.
    pub const EMISSION: usize = 3;
    /// Place in `textures`: specular factor (alpha).
    pub const SPECULAR: usize = 4;
    /// Place in `textures`: specular colour, sRGB-encoded.
    pub const SPECULAR_COLOR: usize = 5;
    /// Place in `textures`: transmission (red).
    pub const TRANSMISSION: usize = 6;
    /// Place in `textures`: clear coat (red).
    pub const CLEARCOAT: usize = 7;
    /// Place in `textures`: roughness of the clear coat (green).
    pub const CLEARCOAT_ROUGHNESS: usize = 8;
    /// Place in `textures`: normal of the clear coat.
    pub const CLEARCOAT_NORMAL: usize = 9;

    /// A surface that reflects `albedo` and emits nothing.
    pub const fn lambert(albedo: [f32; 3]) -> Self {
        Self {
            base_color: [albedo[0], albedo[1], albedo[2], 1.0],
            emission: [0.0; 4],
            textures: [NONE; 12],
            flags: 0,
            reserved: [0; 3],
            specular: [1.0, 1.0, 1.0, 0.0],
            interior: [0.0, 0.0, 0.0, 1.5],
            surface: [0.0, 1.0, 0.0, 1.0],
            coat: [0.0, 0.0, 1.0, 0.0],
        }
    }

    /// A surface that reflects `albedo` and emits `radiance` from its front side.
    pub const fn emissive(albedo: [f32; 3], radiance: [f32; 3]) -> Self {
        let mut material = Self::lambert(albedo);
        material.emission = [radiance[0], radiance[1], radiance[2], 0.0];
        material
    }

    /// The material with a texture in one of the places, below 12.
    ///
    /// ```
    /// use pt_integrator::scene::Material;
    /// let brick = Material::lambert([1.0; 3]).textured(Material::BASE_COLOR, 3);
    /// assert_eq!(brick.textures[0], 3);
    /// ```
    #[must_use]
    pub const fn textured(mut self, place: usize, texture: u32) -> Self {
        self.textures[place] = texture;
        self
    }

    /// Whether the material emits: a component of its emission (of its base colour, for [`Material::UNLIT`]) is above 0
    /// and all are finite. A texture may still be black.
    pub fn emits(&self) -> bool {
        let [r, g, b, _] = if self.flags & Self::UNLIT == 0 { self.emission } else { self.base_color };
        (r > 0.0 || g > 0.0 || b > 0.0) && r.is_finite() && g.is_finite() && b.is_finite()
    }

    /// Whether triangles shade with their own normals, as emitters without an emission texture do. Others are surfaces
    /// of which a part shines. The side that emits is in both cases the triangle's own.
    pub fn shades_flat(&self) -> bool {
        self.emits() && self.flags & Self::UNLIT == 0 && self.textures[Self::EMISSION] == NONE
    }

    /// Whether the surface or its clear coat has a normal map.
    #[inline]
    pub const fn has_normal_map(&self) -> bool {
        self.textures[Self::NORMAL] != NONE || self.textures[Self::CLEARCOAT_NORMAL] != NONE
    }

    /// Whether the material encloses a solid that light may enter.
    #[inline]
    pub fn is_solid(&self) -> bool {
        self.flags & Self::VOLUME != 0 && self.lobes().contains(Lobes::TRANSMISSION)
    }

    /// The same surface said without [`Material::UNLIT`], which path tracing then need not know: a black one that emits
    /// its base colour. Others stay as they are.
    #[must_use]
    pub const fn resolved(self) -> Self {
        if self.flags & Self::UNLIT == 0 {
            return self;
        }
        let [r, g, b, _] = self.base_color;
        let mut emitter = Self::emissive([0.0; 3], [r, g, b]);
        emitter.base_color[3] = self.base_color[3];
        emitter.emission[3] = self.emission[3];
        emitter.textures[Self::EMISSION] = self.textures[Self::BASE_COLOR];
        emitter.flags = self.flags & !Self::UNLIT;
        emitter
    }

    /// What the material may scatter by; textures may be anything in `[0, 1]`.
    pub fn lobes(&self) -> Lobes {
        let [metallic, _, transmission, _] = self.surface;
        let mut lobes = Lobes(0);
        if self.flags & Self::UNLIT != 0 {
            return lobes;
        }
        let textured = |place: usize| self.textures[place] != NONE;
        let certain = |factor: f32, place: usize| factor >= 1.0 && !textured(place);
        let opaque = !certain(metallic, Self::METALLIC_ROUGHNESS);
        if opaque && !certain(transmission, Self::TRANSMISSION) {
            lobes = lobes | Lobes::DIFFUSE;
        }
        if metallic > 0.0 || self.specular[3] > 0.0 || transmission > 0.0 {
            lobes = lobes | Lobes::REFLECTION;
        }
        if opaque && transmission > 0.0 {
            lobes = lobes | Lobes::TRANSMISSION;
        }
        if self.coat[0] > 0.0 {
            lobes = lobes | Lobes::COAT;
        }
        lobes
    }
}

/// A set of ways to scatter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lobes(u32);

impl Lobes {
    /// None: the surface only emits.
    pub const NONE: Self = Self(0);
    /// Lambertian reflection.
    pub const DIFFUSE: Self = Self(1);
    /// Reflection by microfacets or a mirror.
    pub const REFLECTION: Self = Self(2);
    /// Refraction, or transmission through a thin sheet.
    pub const TRANSMISSION: Self = Self(4);
    /// Reflection by a clear coat.
    pub const COAT: Self = Self(8);

    /// The set as a word.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether all of `other` are in the set.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

impl core::ops::BitOr for Lobes {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}
