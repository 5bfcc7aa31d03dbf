//! Putting a scene's lists together.

use glam::{DVec3, Vec3};
use hashcache_core::geometry::{Instance, Mesh};
use hashcache_core::pack::octahedral_encode;
use pt_integrator::scene::{NONE, SceneData, TriangleShading};

/// A scene that grows mesh by mesh.
#[derive(Debug, Default)]
pub(crate) struct Builder {
    /// What there is so far.
    pub data: SceneData,
    /// Whether second texture coordinates are kept.
    pub second_uv: bool,
    /// Whether masks are kept.
    pub masked: bool,
    first_triangle: u32,
    /// Triangles of no area among those stored.
    pub degenerate: u64,
}

/// What few triangles have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extra {
    /// Second texture coordinates.
    pub uv2: [[f32; 2]; 3],
    /// Index of the mask, or [`NONE`].
    pub mask: u32,
    /// The coordinates that the mask reads.
    pub mask_uv: [[f32; 2]; 3],
}

impl Extra {
    /// Nothing.
    pub const NOTHING: Self = Self { uv2: [[0.0; 2]; 3], mask: NONE, mask_uv: [[0.0; 2]; 3] };
}

impl Builder {
    /// Adds a triangle to the mesh that is being built.
    pub fn triangle(&mut self, corners: [u32; 3], shading: TriangleShading) {
        self.triangle_with(corners, shading, &Extra::NOTHING);
    }

    /// Adds a triangle with more than most have.
    pub fn triangle_with(&mut self, corners: [u32; 3], shading: TriangleShading, extra: &Extra) {
        if self.second_uv {
            self.data.uv2.push(extra.uv2);
        }
        if self.masked {
            self.data.opacity.mask_of_triangle.push(extra.mask);
            self.data.opacity.uv.push(extra.mask_uv);
        }
        let [a, b, c] = corners.map(|i| Vec3::from_array(self.data.positions[i as usize]));
        self.degenerate += u64::from((b - a).cross(c - a) == Vec3::ZERO);
        self.data.indices.push(corners);
        self.data.triangle_shading.push(shading);
    }

    /// Ends the mesh that is being built; `None` when it has no triangles.
    pub fn finish_mesh(&mut self) -> Option<u32> {
        let first_triangle = self.first_triangle;
        let triangle_count = self.data.indices.len() as u32 - first_triangle;
        self.first_triangle = self.data.indices.len() as u32;
        (triangle_count > 0).then(|| {
            self.data.meshes.push(Mesh { first_triangle, triangle_count });
            self.data.meshes.len() as u32 - 1
        })
    }

    /// Ends the mesh that is being built and places it where it was modelled.
    pub fn finish_world_mesh(&mut self) {
        if let Some(mesh) = self.finish_mesh() {
            self.data.instances.push(Instance::identity(mesh));
        }
    }
}

/// A vertex normal's code; `None` for a vector without direction.
pub(crate) fn pack_normal(n: Vec3) -> Option<u32> {
    // Three times NONE would ask for the triangle's own normal. Its neighbour is 3e-5 rad away.
    const NEXT: u32 = 0xffff_0000;
    (n.is_finite() && n.abs().max_element().is_normal()).then(|| match octahedral_encode(n) {
        NONE => NEXT,
        code => code,
    })
}

/// The origin for geometry that reaches from `low` to `high`: the centre, rounded to a multiple of the power of two
/// above the extent. Coordinates then stay below 1.5 extents, a scene around zero keeps its coordinates as they are,
/// and what is subtracted from the others has few bits, so it adds no rounding of its own.
pub(crate) fn origin(low: DVec3, high: DVec3) -> DVec3 {
    let centre = low + (high - low) * 0.5;
    let extent = (high - low).max_element();
    if extent <= 0.0 {
        return centre;
    }
    let exponent = (extent.to_bits() >> 52) & 0x7ff;
    let step = f64::from_bits((exponent + 1).min(0x7fe) << 52);
    (centre / step).round() * step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn origins() {
        assert_eq!(origin(DVec3::splat(-1.0), DVec3::splat(1.0)), DVec3::ZERO);
        assert_eq!(origin(DVec3::ZERO, DVec3::splat(559.0)), DVec3::ZERO);
        let far = DVec3::new(5e6, 0.0, -3e6);
        let o = origin(far, far + 10.0);
        assert!((o - far).abs().max_element() <= 16.0 + 10.0, "{o}");
        assert_eq!(o % 16.0, DVec3::ZERO);
        assert_eq!(origin(far, far), far);
        assert!(origin(DVec3::splat(-1e300), DVec3::splat(1e300)).is_finite());
        assert!(origin(DVec3::splat(1e-320), DVec3::splat(2e-320)).is_finite());
    }

    #[test]
    fn packed_normals_never_mean_flat() {
        assert_eq!(pack_normal(Vec3::ZERO), None);
        assert_eq!(pack_normal(Vec3::NAN), None);
        assert_eq!(pack_normal(Vec3::splat(f32::INFINITY)), None);
        for x in -40..40 {
            for y in -40..40 {
                let n = Vec3::new(x as f32 * 1e-5, y as f32 * 1e-5, 1.0);
                assert_ne!(pack_normal(n), Some(NONE));
            }
        }
    }
}
