//! Guides: what a pixel's vertex in one layer looks like, so that a filter knows which pixels belong together.

use bytemuck::{Pod, Zeroable};
use hashcache_core::error::ParamError;
use hashcache_core::glam::Vec3;

use crate::lab::lab_from_linear;
use crate::pixel::LayerPixel;

/// A pixel's vertex in one layer (64 bytes), as an embedder with several layers fills it in.
///
/// Layer i holds the i-th vertex of the pixel's path. A pixel without a vertex there has `shininess` below 0.
///
/// | bytes | field | xyz | w |
/// |---|---|---|---|
/// | 0..16 | `position_path` | position | Dᵢ^Σ, path length from the camera |
/// | 16..32 | `normal_segment` | unit normal | Dᵢ, length of the last segment |
/// | 32..48 | `albedo_shininess` | Cᵢ, albedo | α, shininess: 0 diffuse, above 0 glossy, below 0 no vertex |
/// | 48..64 | `throughput` | Tᵢ, throughput of the ray that goes on from here | samples behind the illumination; 0: unknown |
///
/// # Units
/// Lengths in scene units; albedo and throughput are plain factors.
///
/// # Source
/// Roth et al. 2020, section 3.4.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GuideRecord {
    /// Position; w: path length from the camera, Dᵢ^Σ.
    pub position_path: [f32; 4],
    /// Unit normal; w: length of the segment that arrives here, Dᵢ.
    pub normal_segment: [f32; 4],
    /// Albedo of the diffuse lobe, 1 where light only passes on; w: shininess, 0 for a diffuse vertex, below 0 for none.
    pub albedo_shininess: [f32; 4],
    /// Throughput of the ray that leaves towards layer i+1; w: number of samples behind the vertex's illumination, 0 where
    /// that is not known.
    pub throughput: [f32; 4],
}

impl GuideRecord {
    /// A pixel without a vertex.
    pub const NONE: Self = Self {
        position_path: [0.0; 4],
        normal_segment: [0.0; 4],
        albedo_shininess: [0.0, 0.0, 0.0, -1.0],
        throughput: [0.0; 4],
    };
}

/// The parameter of the kernel `lf.prepare` (16 bytes): the scene's size.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GuideScale {
    recip_radius: f32,
    reserved: [f32; 3],
}

impl GuideScale {
    /// For a scene whose bounding sphere has `radius`, in scene units. Guides hold lengths in radii, so that the weights'
    /// scales mean the same in every scene.
    ///
    /// # Errors
    /// [`ParamError`] when the radius is not between 10⁻³⁰ and 10³⁰.
    pub fn new(radius: f32) -> Result<Self, ParamError> {
        ParamError::check_range("radius", f64::from(radius), 1e-30, 1e30)?;
        Ok(Self { recip_radius: 1.0 / radius, reserved: [0.0; 3] })
    }

    /// 1 / radius.
    #[inline]
    pub(crate) const fn recip_radius(&self) -> f32 {
        self.recip_radius
    }
}

/// A guide as the filter's inner loop reads it (64 bytes, a line of the memory's caches): lengths in scene radii, the albedo in L\*a\*b\*.
///
/// | bytes | field | xyz | w |
/// |---|---|---|---|
/// | 0..16 | `normal_path` | unit normal | D^Σ / radius |
/// | 16..32 | `position_segment` | position / radius | D / radius |
/// | 32..48 | `lab_shininess` | L\*a\*b\* of the albedo | α; below 0: no vertex |
/// | 48..64 | `support` | samples behind the illumination (0: unknown), 0, 0 | 0 |
///
/// A guide with any component that is not finite belongs to no other pixel.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PreparedGuide {
    /// Unit normal; w: path length in radii.
    pub normal_path: [f32; 4],
    /// Position in radii; w: length of the last segment in radii.
    pub position_segment: [f32; 4],
    /// Albedo in L\*a\*b\*; w: shininess, below 0 for a pixel without a vertex.
    pub lab_shininess: [f32; 4],
    /// Number of samples behind the illumination, 0 where that is not known; the rest is 0.
    pub support: [f32; 4],
}

impl PreparedGuide {
    /// A pixel without a vertex.
    pub const NONE: Self = Self {
        normal_path: [0.0; 4],
        position_segment: [0.0; 4],
        lab_shininess: [0.0, 0.0, 0.0, -1.0],
        support: [0.0; 4],
    };

    /// The guide of a layer's vertex.
    pub fn new(scale: &GuideScale, record: &GuideRecord) -> Self {
        let [px, py, pz, path] = record.position_path;
        let [nx, ny, nz, segment] = record.normal_segment;
        let [r, g, b, shininess] = record.albedo_shininess;
        // NaN is no vertex either.
        if shininess.is_nan() || shininess < 0.0 {
            return Self::NONE;
        }
        let s = scale.recip_radius;
        let lab = lab_from_linear(Vec3::new(r, g, b));
        Self {
            normal_path: [nx, ny, nz, path * s],
            position_segment: [px * s, py * s, pz * s, segment * s],
            lab_shininess: lab.extend(shininess).to_array(),
            support: [record.throughput[3], 0.0, 0.0, 0.0],
        }
    }

    /// The guide of a pixel's first vertices: means over those that its samples met, the normal made unit again.
    pub fn of_pixel(scale: &GuideScale, pixel: &LayerPixel) -> Self {
        if !pixel.has_vertex() {
            return Self::NONE;
        }
        let recip = 1.0 / pixel.counts[1] as f32;
        let [nx, ny, nz, _] = pixel.normal;
        let [px, py, pz, path] = pixel.position;
        let [r, g, b, _] = pixel.throughput;
        let (s, normal) = (scale.recip_radius * recip, Vec3::new(nx, ny, nz).normalize_or_zero());
        let length = path * s;
        Self {
            normal_path: normal.extend(length).to_array(),
            position_segment: [px * s, py * s, pz * s, length],
            lab_shininess: lab_from_linear(Vec3::new(r, g, b) * recip).extend(0.0).to_array(),
            support: [pixel.support(), 0.0, 0.0, 0.0],
        }
    }

    /// Whether the pixel has a vertex in this layer.
    #[inline]
    pub fn has_vertex(&self) -> bool {
        self.lab_shininess[3] >= 0.0
    }
}
