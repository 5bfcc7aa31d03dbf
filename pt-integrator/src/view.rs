//! A scene as path tracing reads it.

use bytemuck::Pod;
use glam::{Vec2, Vec3};

use crate::light::{AliasEntry, EnvironmentSample, EnvironmentView, TriangleLight};
use crate::packed::{SceneHeader, SceneInstance, SceneTriangle, Section};
use crate::scene::{Material, Needs, PunctualLight, Texture};

/// Borrowed slices of a packed scene. Made without copying from the three buffers of [`crate::packed`].
#[derive(Clone, Copy, Debug)]
pub struct SceneView<'a> {
    /// Numbers of the whole scene.
    pub header: &'a SceneHeader,
    /// Triangles, by the index in a hit.
    pub triangles: &'a [SceneTriangle],
    /// Instances, by the index in a hit.
    pub instances: &'a [SceneInstance],
    /// Materials.
    pub materials: &'a [Material],
    /// Textures.
    pub textures: &'a [Texture],
    /// Texels of all textures.
    pub texels: &'a [u32],
    /// Emitting triangles.
    pub lights: &'a [TriangleLight],
    /// Chooses among `lights` and, behind them, `punctual_lights`.
    pub alias: &'a [AliasEntry],
    /// Lights without extent.
    pub punctual_lights: &'a [PunctualLight],
    /// Second texture coordinates of triangles, or empty.
    pub second_uv: &'a [[[f32; 2]; 3]],
    /// See [`SceneHeader::emitters`].
    pub emitters: &'a [u32],
    /// The environment image, if there is one.
    pub environment: EnvironmentView<'a>,
}

impl<'a> SceneView<'a> {
    /// The scene in these buffers, or `None` when a section leaves the buffer: it was not packed by this crate.
    pub fn new(triangles: &'a [SceneTriangle], words: &'a [u32], texels: &'a [u32]) -> Option<Self> {
        let header = words.get(..size_of::<SceneHeader>() / 4)?;
        let header: &SceneHeader = bytemuck::try_from_bytes(bytemuck::cast_slice(header)).ok()?;
        let [width, height] = header.environment_size;
        let environment = EnvironmentView {
            width,
            height,
            texels: section(words, header.environment_texels)?,
            row_density: section(words, header.environment_row_density)?,
            rows: section(words, header.environment_rows)?,
            columns: section(words, header.environment_columns)?,
            guides: section(words, header.environment_guides)?,
            rotation: header.environment_rotation,
        };
        Some(Self {
            header,
            triangles,
            instances: section(words, header.instances)?,
            materials: section(words, header.materials)?,
            textures: section(words, header.textures)?,
            texels,
            lights: section(words, header.lights)?,
            alias: section(words, header.alias)?,
            punctual_lights: section(words, header.punctual_lights)?,
            second_uv: section(words, header.second_uv)?,
            emitters: section(words, header.emitters)?,
            environment,
        })
    }

    /// What the scene needs of a path tracer.
    #[inline]
    pub fn needs(&self) -> Needs {
        Needs::from_bits(self.header.needs)
    }

    /// Whether next-event estimation has anything to sample.
    #[inline]
    pub fn has_sampled_lights(&self) -> bool {
        !self.alias.is_empty() || self.environment.width != 0
    }

    /// The coordinates of a triangle's corners that this texture reads; zeros when the scene has none of that set.
    #[inline]
    pub(crate) fn coordinates(&self, texture: &Texture, triangle: u32) -> [Vec2; 3] {
        texture.reads(&self.triangles[triangle as usize].uv, self.second_uv.get(triangle as usize))
    }

    /// What a ray sees that leaves the scene in `direction`, and with which density next-event estimation would have
    /// chosen it. `NEEDS` as in [`crate::light::sample_light`].
    #[inline]
    pub(crate) fn outside<const NEEDS: u32>(&self, direction: Vec3) -> EnvironmentSample {
        let [r, g, b, _] = self.header.constant_environment;
        if NEEDS & Needs::ENVIRONMENT_IMAGE == 0 || self.environment.width == 0 {
            return EnvironmentSample { radiance: Vec3::new(r, g, b), pdf: 0.0 };
        }
        let seen = self.environment.evaluate(direction);
        EnvironmentSample { radiance: seen.radiance, pdf: seen.pdf * self.header.environment_probability }
    }
}

fn section<T: Pod>(words: &[u32], section: Section) -> Option<&[T]> {
    if section.count == 0 {
        return Some(&[]);
    }
    let first = section.first_word as usize;
    let length = (section.count as usize).checked_mul(size_of::<T>() / 4)?;
    bytemuck::try_cast_slice(words.get(first..first.checked_add(length)?)?).ok()
}
