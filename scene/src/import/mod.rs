//! glTF 2.0 and GLB files.

mod accessor;
mod clearcoat;
mod convert;
mod document;
mod features;
mod images;
mod light;
mod material;
mod mesh;
mod nodes;
mod opacity;
mod reference;
pub(crate) mod resource;
mod textures;

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DAffine3, DVec3};
use hashcache_core::geometry::Instance;

use self::document::{Document, SUPPORTED};
use self::material::Materials;
use self::mesh::{MeshSource, Placement, Target};
use self::nodes::{Graph, Placed};
use crate::builder::{Builder, origin};
use crate::error::{SceneError, one_line};
use crate::info::{Extension, Info};
use crate::progress::{Listener, Progress};
use crate::warning::Warnings;
use crate::{LoadOptions, Loaded};

/// Scenes wider than this are refused, in metres: areas and volumes of a larger one leave the range of f32.
const LARGEST_EXTENT: f64 = 1e12;

/// Loads a glTF or GLB file.
pub(crate) fn load(path: &Path, options: &LoadOptions, progress: Listener) -> Result<Loaded, SceneError> {
    import(&Document::open(path, options)?, options, progress)
}

fn import(document: &Document, options: &LoadOptions, progress: Listener) -> Result<Loaded, SceneError> {
    let mut warnings = Warnings::default();
    let graph = nodes::walk(document, &mut warnings)?;
    let mut materials = Materials::new(document);
    let mut meshes: BTreeMap<usize, MeshSource> = BTreeMap::new();
    for placed in &graph.placed {
        if let std::collections::btree_map::Entry::Vacant(entry) = meshes.entry(placed.mesh) {
            entry.insert(mesh::prepare(document, placed.mesh, &mut materials, &mut warnings)?);
        }
    }
    let plan = plan(document, &graph, &meshes, options)?;
    let mut lights = Vec::new();
    for placed in &graph.lights {
        lights.extend(light::punctual(document, placed, plan.origin, &mut warnings)?);
    }
    let look = materials.finish(options, progress, &mut warnings)?;
    let mut builder = Builder::default();
    builder.second_uv = meshes.values().any(MeshSource::has_second_uv);
    builder.masked = !look.opacity.masks.is_empty();
    let data = &mut builder.data;
    (data.materials, data.textures, data.texels, data.opacity) =
        (look.materials, look.textures, look.texels, look.opacity);
    data.punctual_lights = lights;
    let triangles = plan.triangles as usize;
    data.positions.reserve_exact(plan.vertices as usize);
    data.indices.reserve_exact(triangles);
    data.triangle_shading.reserve_exact(triangles);
    data.uv2.reserve_exact(if builder.second_uv { triangles } else { 0 });
    let masks = if builder.masked { triangles } else { 0 };
    data.opacity.mask_of_triangle.reserve_exact(masks);
    data.opacity.uv.reserve_exact(masks);
    let (mut done, total) = (0, plan.triangles);
    let mut tell = |more: u64| {
        done += more;
        progress(Progress { what: "triangles", done, total });
    };
    tell(0);
    let mut target = Target { builder: &mut builder, mask_of_material: &look.mask_of_material, progress: &mut tell };
    write(document, &plan, &mut target, &mut warnings)?;
    features::file(&document.root, &mut warnings);
    let info = Info {
        extent: plan.bounds.map(|b| b.to_array()),
        images: look.images,
        extensions: extensions(document),
        ..Info::default()
    };
    Loaded::new(document.name.clone(), builder, plan.origin, graph.views, warnings.into_vec(), info)
}

/// What is written where.
struct Plan<'a> {
    /// Placed once: written in world space, as one mesh.
    baked: Vec<(&'a MeshSource<'a>, DAffine3)>,
    /// Placed more often: written once in their own space, with the place of each.
    shared: Vec<(&'a MeshSource<'a>, Vec<DAffine3>)>,
    bounds: [DVec3; 2],
    origin: DVec3,
    triangles: u64,
    vertices: u64,
}

fn plan<'a>(
    document: &Document,
    graph: &Graph,
    meshes: &'a BTreeMap<usize, MeshSource<'a>>,
    options: &LoadOptions,
) -> Result<Plan<'a>, SceneError> {
    let at = document.at();
    let (none, all) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut plan = Plan {
        baked: Vec::new(),
        shared: Vec::new(),
        bounds: [none, all],
        origin: DVec3::ZERO,
        triangles: 0,
        vertices: 0,
    };
    let mut places: BTreeMap<usize, Vec<&Placed>> = BTreeMap::new();
    for placed in &graph.placed {
        places.entry(placed.mesh).or_default().push(placed);
    }
    for (index, places) in places {
        let mesh = &meshes[&index];
        if mesh.triangles == 0 {
            continue;
        }
        for placed in &places {
            grow(&mut plan.bounds, mesh.bounds, &placed.world);
        }
        // An instance needs an inverse; what a singular transform flattens is baked.
        let (regular, flat): (Vec<_>, Vec<_>) = places.iter().map(|p| p.world).partition(invertible);
        let (alone, shared) = if regular.len() > 1 { (flat, regular) } else { ([regular, flat].concat(), Vec::new()) };
        let copies = alone.len() as u64 + u64::from(!shared.is_empty());
        plan.triangles = plan.triangles.saturating_add(mesh.triangles.saturating_mul(copies));
        plan.vertices = plan.vertices.saturating_add(mesh.vertices.saturating_mul(copies));
        plan.baked.extend(alone.into_iter().map(|world| (mesh, world)));
        if !shared.is_empty() {
            plan.shared.push((mesh, shared));
        }
    }
    if plan.triangles == 0 {
        return Err(SceneError::NoGeometry { file: one_line(&document.name) });
    }
    let limit = u64::from(options.max_triangles);
    if plan.triangles > limit || plan.vertices > 3 * limit {
        let what = format!("{} triangles with {} vertices", plan.triangles, plan.vertices);
        return Err(at.too_large("/meshes", what, limit, "max_triangles"));
    }
    let [low, high] = plan.bounds;
    if !((high - low).max_element() <= LARGEST_EXTENT && low.is_finite() && high.is_finite()) {
        let what = format!("the scene reaches from {low} to {high}, wider than {LARGEST_EXTENT:e} m");
        return Err(at.unsupported("/nodes", what, "scale it down"));
    }
    plan.origin = origin(low, high);
    Ok(plan)
}

/// Includes the corners of a transformed box.
fn grow(bounds: &mut [DVec3; 2], [low, high]: [DVec3; 2], world: &DAffine3) {
    for corner in 0..8_u32 {
        let pick = |bit: u32, low: f64, high: f64| if corner & bit == 0 { low } else { high };
        let p = DVec3::new(pick(1, low.x, high.x), pick(2, low.y, high.y), pick(4, low.z, high.z));
        let p = world.transform_point3(p);
        *bounds = [bounds[0].min(p), bounds[1].max(p)];
    }
}

/// Whether the map can be inverted in f32 with bits to spare, whatever its scale.
fn invertible(world: &DAffine3) -> bool {
    // Volume of the unit cube's image, relative to the box that its edges would span at right angles.
    const FLATTEST: f64 = 1e-6;
    let m = world.matrix3;
    let lengths = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    m.determinant().abs() > FLATTEST * lengths
}

fn write(document: &Document, plan: &Plan, target: &mut Target, warnings: &mut Warnings) -> Result<(), SceneError> {
    for (mesh, world) in &plan.baked {
        mesh.write(document, &Placement { map: *world, origin: plan.origin }, target, warnings)?;
    }
    target.builder.finish_world_mesh();
    for (mesh, worlds) in &plan.shared {
        // The mesh's own coordinates are re-centred too: far from its own zero they would lose their last bits.
        let centre = origin(mesh.bounds[0], mesh.bounds[1]);
        mesh.write(document, &Placement { map: DAffine3::IDENTITY, origin: centre }, target, warnings)?;
        let builder = &mut *target.builder;
        let Some(index) = builder.finish_mesh() else { continue };
        for world in worlds {
            let to_scene = DAffine3::from_translation(-plan.origin) * *world * DAffine3::from_translation(centre);
            let (m, t) = (to_scene.matrix3, to_scene.translation);
            let row = |i: usize| [m.row(i).x as f32, m.row(i).y as f32, m.row(i).z as f32, t[i] as f32];
            let mirrored = u32::from(m.determinant() < 0.0);
            builder.data.instances.push(Instance {
                to_scene: [row(0), row(1), row(2)],
                mesh: index,
                mirrored,
                reserved: [0; 2],
            });
        }
    }
    Ok(())
}

fn extensions(document: &Document) -> Vec<Extension> {
    let used = document.root.extensions_used.iter();
    let mut list: Vec<_> =
        used.map(|n| Extension { name: one_line(n), respected: SUPPORTED.contains(&n.as_str()) }).collect();
    list.sort_by(|a, b| a.name.cmp(&b.name));
    list.dedup();
    list
}
