//! Meshes: their primitives looked up and checked, then written as triangles.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3};
use gltf::json;
use json::accessor::Type;
use json::mesh::{Mode, Semantic};
use json::validation::Checked;
use pt_integrator::scene::{Material, NONE, TriangleShading};

use super::accessor::{Elements, elements};
use super::document::Document;
use super::features;
use super::material::{Materials, Surface};
use crate::builder::{Builder, Extra, pack_normal};
use crate::error::SceneError;
use crate::warning::Warnings;

/// A primitive of triangles whose accessors lie inside of their buffers.
pub(crate) struct Primitive<'a> {
    /// Index in its mesh.
    index: usize,
    positions_accessor: usize,
    positions: Elements<'a>,
    normals: Option<Elements<'a>>,
    /// First and second texture coordinates.
    uv: [Option<Elements<'a>>; 2],
    /// The accessor's index and its elements.
    indices: Option<(usize, Elements<'a>)>,
    mode: Mode,
    surface: Surface,
    /// Number of triangles.
    pub triangles: u64,
}

/// A mesh that is placed somewhere.
pub(crate) struct MeshSource<'a> {
    /// Index in the file.
    pub index: usize,
    /// Its primitives of triangles.
    pub primitives: Vec<Primitive<'a>>,
    /// Smallest and largest coordinates in its own space; `low > high` when it has no vertices.
    pub bounds: [DVec3; 2],
    /// Number of triangles.
    pub triangles: u64,
    /// Number of vertices, those shared by primitives once.
    pub vertices: u64,
}

impl MeshSource<'_> {
    /// Whether a primitive has second texture coordinates.
    pub fn has_second_uv(&self) -> bool {
        self.primitives.iter().any(|p| p.uv[1].is_some())
    }
}

/// Where triangles go.
pub(crate) struct Target<'b> {
    /// The scene; its materials are complete.
    pub builder: &'b mut Builder,
    /// Index of each material's mask, or [`NONE`].
    pub mask_of_material: &'b [u32],
    /// Triangles written so far are told to it.
    pub progress: &'b mut dyn FnMut(u64),
}

impl Target<'_> {
    fn surface(&self, material: u32) -> (&Material, u32) {
        (&self.builder.data.materials[material as usize], self.mask_of_material[material as usize])
    }
}

/// How a mesh's vertices become the scene's.
pub(crate) struct Placement {
    /// To the world, or to the mesh's own re-centred space for an instance.
    pub map: DAffine3,
    /// Subtracted afterwards.
    pub origin: DVec3,
}

/// Looks up and checks all that a mesh needs.
pub(crate) fn prepare<'a>(
    document: &'a Document,
    index: usize,
    materials: &mut Materials<'_>,
    warnings: &mut Warnings,
) -> Result<MeshSource<'a>, SceneError> {
    let mut mesh = MeshSource {
        index,
        primitives: Vec::new(),
        bounds: [DVec3::INFINITY, DVec3::NEG_INFINITY],
        triangles: 0,
        vertices: 0,
    };
    let mut seen = std::collections::HashSet::new();
    for (p, source) in document.root.meshes[index].primitives.iter().enumerate() {
        let place = format!("/meshes/{index}/primitives/{p}");
        features::primitive(&place, source, warnings);
        let Some(primitive) = prepare_primitive(document, (p, source), &place, materials, warnings)? else { continue };
        mesh.triangles += primitive.triangles;
        if seen.insert(primitive.positions_accessor) {
            mesh.vertices += primitive.positions.count as u64;
            grow_bounds(document, &primitive, &mut mesh.bounds)?;
        }
        mesh.primitives.push(primitive);
    }
    Ok(mesh)
}

fn grow_bounds(document: &Document, primitive: &Primitive, bounds: &mut [DVec3; 2]) -> Result<(), SceneError> {
    for (i, p) in primitive.positions.floats::<3>().enumerate() {
        if !p.iter().all(|x| x.is_finite()) {
            let place = format!("/accessors/{}", primitive.positions_accessor);
            return Err(document.at().malformed(place, format!("vertex {i} has a coordinate that is not finite")));
        }
        let p = DVec3::from_array(p.map(f64::from));
        *bounds = [bounds[0].min(p), bounds[1].max(p)];
    }
    Ok(())
}

fn prepare_primitive<'a>(
    document: &'a Document,
    (index, source): (usize, &json::mesh::Primitive),
    place: &str,
    materials: &mut Materials<'_>,
    warnings: &mut Warnings,
) -> Result<Option<Primitive<'a>>, SceneError> {
    let at = document.at();
    let Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) = source.mode else {
        warnings.add("points and lines have no surface; they are left out", || format!("{place}/mode"));
        return Ok(None);
    };
    let accessor = |semantic| source.attributes.get(&Checked::Valid(semantic)).map(json::Index::value);
    let positions_accessor = accessor(Semantic::Positions)
        .ok_or_else(|| at.malformed(format!("{place}/attributes"), "POSITION is missing"))?;
    let positions = elements(document, positions_accessor, &[Type::Vec3])?;
    let same_count = |name: &str, e: Elements<'a>| {
        if e.count == positions.count {
            return Ok(e);
        }
        let what = format!("{} entries for {} vertices", e.count, positions.count);
        Err(at.malformed(format!("{place}/attributes/{name}"), what))
    };
    let surface = materials.surface(source.material.map(|m| m.value()), warnings)?;
    let normals = accessor(Semantic::Normals);
    let normals = normals.map(|a| same_count("NORMAL", elements(document, a, &[Type::Vec3])?)).transpose()?;
    let mut uv = [None; 2];
    for (uv, set) in uv.iter_mut().zip(surface.sets) {
        let Some(set) = set else { continue };
        let name = format!("TEXCOORD_{set}");
        if let Some(a) = accessor(Semantic::TexCoords(set)) {
            *uv = Some(same_count(&name, elements(document, a, &[Type::Vec2])?)?);
        } else {
            let what = "textured primitives without the texture's coordinates show its upper left corner";
            warnings.add(what, || format!("{place}/attributes"));
        }
    }
    if surface.normal_map && accessor(Semantic::Tangents).is_some() {
        let what = "the vertices' TANGENT is ignored: normal maps stand in the frame of their texture coordinates, \
                    triangle by triangle";
        warnings.add(what, || format!("{place}/attributes/TANGENT"));
    }
    let indices = source.indices.map(|a| a.value());
    let indices = indices.map(|a| Ok((a, elements(document, a, &[Type::Scalar])?))).transpose()?;
    let corners = indices.map_or(positions.count, |(_, e)| e.count) as u64;
    let triangles = if mode == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) };
    if mode == Mode::Triangles && !corners.is_multiple_of(3) {
        warnings.add("left-over corners that make no whole triangle are ignored", || place.to_owned());
    }
    Ok(Some(Primitive { index, positions_accessor, positions, normals, uv, indices, mode, surface, triangles }))
}

impl MeshSource<'_> {
    /// Appends the mesh's vertices and triangles, transformed.
    pub fn write(
        &self,
        document: &Document,
        placement: &Placement,
        target: &mut Target,
        warnings: &mut Warnings,
    ) -> Result<(), SceneError> {
        let mut bases = HashMap::new();
        for primitive in &self.primitives {
            let base = *bases.entry(primitive.positions_accessor).or_insert_with(|| {
                let positions = &mut target.builder.data.positions;
                let base = positions.len() as u32;
                let place = |p: [f32; 3]| {
                    let p = placement.map.transform_point3(DVec3::from_array(p.map(f64::from)));
                    (p - placement.origin).as_vec3().to_array()
                };
                positions.extend(primitive.positions.floats().map(place));
                base
            });
            let place = || format!("/meshes/{}/primitives/{}", self.index, primitive.index);
            primitive.write(document, &place, &placement.map, base, target, warnings)?;
        }
        Ok(())
    }
}

impl Primitive<'_> {
    fn write(
        &self,
        document: &Document,
        place: &dyn Fn() -> String,
        map: &DAffine3,
        base: u32,
        target: &mut Target,
        warnings: &mut Warnings,
    ) -> Result<(), SceneError> {
        let count = self.positions.count;
        let corners = self.corners(document)?;
        let (cofactor, mirrored) = cofactor(&map.matrix3);
        let (material, mask) = target.surface(self.surface.index);
        // The side on which a lamp emits is its triangles' own, so they are shaded by their own normals.
        let normals = self.normals.filter(|_| !material.shades_flat());
        let normals: Option<Vec<u32>> =
            normals.map(|e| e.floats().map(|n| transform_normal(&cofactor, n).unwrap_or(NONE)).collect());
        let uv = self.uv.map(|e| {
            let (uv, replaced) = coordinates(e?);
            let what = "texture coordinates that are not finite are read as 0";
            warnings.add_many(what, replaced, || format!("{}/attributes", place()));
            Some(uv)
        });
        let mut without = 0;
        for i in 0..self.triangles as usize {
            let [a, b, c] = triangle(self.mode, i).map(|k| corners.get(k));
            let corners = if mirrored { [a, c, b] } else { [a, b, c] };
            debug_assert!(corners.iter().all(|&v| (v as usize) < count));
            let mut shading = TriangleShading::flat(self.surface.index);
            if let Some(normals) = &normals {
                let n = corners.map(|v| normals[v as usize]);
                if n.contains(&NONE) { without += 1 } else { shading.normals = n }
            }
            let [first, second] =
                [0, 1].map(|set| uv[set].as_ref().map_or([[0.0; 2]; 3], |uv| corners.map(|v| uv[v as usize])));
            shading.uv = first;
            let extra = Extra { uv2: second, mask, mask_uv: first };
            target.builder.triangle_with(corners.map(|v| base + v), shading, &extra);
        }
        let what = "triangles with a vertex normal that has no direction are shaded by their own normal";
        warnings.add_many(what, without, || format!("{}/attributes/NORMAL", place()));
        (target.progress)(self.triangles);
        Ok(())
    }

    /// The vertex indices, each checked against the number of vertices.
    fn corners(&self, document: &Document) -> Result<Corners, SceneError> {
        let Some((accessor, indices)) = self.indices else { return Ok(Corners::InOrder) };
        let at = document.at();
        let place = || format!("/accessors/{accessor}");
        let list = indices.indices().ok_or_else(|| at.malformed(place(), "indices must be unsigned integers"))?;
        let list: Vec<u32> = list.collect();
        match list.iter().position(|&v| v as usize >= self.positions.count) {
            None => Ok(Corners::Listed(list)),
            Some(i) => {
                let what = format!("index {i} is {}, there are {} vertices", list[i], self.positions.count);
                Err(at.malformed(place(), what))
            }
        }
    }
}

/// Texture coordinates, and how many were replaced because they were not finite.
fn coordinates(elements: Elements) -> (Vec<[f32; 2]>, usize) {
    let mut replaced = 0;
    let finite = |uv: [f32; 2]| {
        let good = uv.iter().all(|x| x.is_finite());
        replaced += usize::from(!good);
        if good { uv } else { [0.0; 2] }
    };
    (elements.floats().map(finite).collect(), replaced)
}

/// Which vertex a corner is.
enum Corners {
    InOrder,
    Listed(Vec<u32>),
}

impl Corners {
    fn get(&self, i: usize) -> u32 {
        match self {
            Self::InOrder => i as u32,
            Self::Listed(list) => list[i],
        }
    }
}

/// The corners of triangle `i` (glTF 2.0, 3.7.2.1).
fn triangle(mode: Mode, i: usize) -> [usize; 3] {
    match mode {
        Mode::TriangleStrip => [i, i + 1 + i % 2, i + 2 - i % 2],
        Mode::TriangleFan => [i + 1, i + 2, 0],
        _ => [3 * i, 3 * i + 1, 3 * i + 2],
    }
}

/// The matrix that maps normals (the cofactors: the inverse transpose times the determinant, so that a flattening
/// transform has one too) with the inverse transpose's sign, and whether the map mirrors.
fn cofactor(m: &DMat3) -> (DMat3, bool) {
    let cofactor = DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    let mirrored = m.x_axis.dot(cofactor.x_axis) < 0.0;
    (if mirrored { cofactor * -1.0 } else { cofactor }, mirrored)
}

fn transform_normal(cofactor: &DMat3, n: [f32; 3]) -> Option<u32> {
    let n = *cofactor * DVec3::from_array(n.map(f64::from));
    let largest = n.abs().max_element();
    (largest > 0.0 && n.is_finite()).then(|| pack_normal((n / largest).as_vec3())).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_side() {
        let strip: Vec<_> = (0..4).map(|i| triangle(Mode::TriangleStrip, i)).collect();
        assert_eq!(strip, [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]]);
        let fan: Vec<_> = (0..3).map(|i| triangle(Mode::TriangleFan, i)).collect();
        assert_eq!(fan, [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
    }

    #[test]
    fn normals_map_by_the_inverse_transpose() {
        let m = DMat3::from_cols(DVec3::new(2.0, 0.1, 0.0), DVec3::new(0.3, 1e-3, 0.2), DVec3::new(0.0, -0.5, -4.0));
        let (cofactor, mirrored) = cofactor(&m);
        assert_eq!(mirrored, m.determinant() < 0.0);
        let expected = m.inverse().transpose();
        let scale = m.determinant().abs();
        assert!((cofactor * (1.0 / scale)).abs_diff_eq(expected, 1e-9), "{cofactor} {expected}");
    }
}
