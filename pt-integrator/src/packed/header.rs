//! What stands first in the scene buffer.

use bytemuck::{Pod, Zeroable};

/// A run of records within the scene buffer. 8 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Section {
    /// First 32-bit word, a multiple of 4.
    pub first_word: u32,
    /// Number of records (not words).
    pub count: u32,
}

/// Where everything is, and the numbers that belong to the whole scene. 176 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SceneHeader {
    /// [`crate::scene::Needs`].
    pub needs: u32,
    /// See [`crate::light::LightList::environment_probability`].
    pub environment_probability: f32,
    /// See [`crate::light::LightList::density_per_luminance`].
    pub density_per_luminance: f32,
    /// Zero.
    pub reserved: u32,
    /// Radiance of a constant environment; black when there is none or an image. w is 0.
    pub constant_environment: [f32; 4],
    /// Centre of a sphere about the scene; w: its radius.
    pub bounding_sphere: [f32; 4],
    /// Columns and rows of the environment image, or zeros.
    pub environment_size: [u32; 2],
    /// [`super::SceneInstance`]s.
    pub instances: Section,
    /// [`crate::scene::Material`]s.
    pub materials: Section,
    /// [`crate::scene::Texture`]s.
    pub textures: Section,
    /// [`crate::light::TriangleLight`]s.
    pub lights: Section,
    /// [`crate::light::AliasEntry`]s, as many as `lights` and `punctual_lights` together, or none when none has power.
    pub alias: Section,
    /// Texels of the environment image, `[f32; 4]`.
    pub environment_texels: Section,
    /// [`crate::light::EnvironmentView::row_density`].
    pub environment_row_density: Section,
    /// [`crate::light::EnvironmentView::rows`].
    pub environment_rows: Section,
    /// [`crate::light::EnvironmentView::columns`].
    pub environment_columns: Section,
    /// [`crate::light::EnvironmentView::guides`].
    pub environment_guides: Section,
    /// Cosine and sine of [`crate::light::EnvironmentView::rotation`].
    pub environment_rotation: [f32; 2],
    /// [`crate::scene::PunctualLight`]s.
    pub punctual_lights: Section,
    /// Second texture coordinates, `[[f32; 2]; 3]` for each triangle; or none.
    pub second_uv: Section,
    /// For each of the emitting triangles its index among all triangles, when one of them has an emission texture;
    /// else none.
    pub emitters: Section,
    /// Zero.
    pub padding: [u32; 2],
}

impl SceneHeader {
    /// Whether a constant environment gives light.
    #[inline]
    pub fn has_constant_environment(&self) -> bool {
        self.constant_environment.iter().any(|&x| x > 0.0)
    }
}
