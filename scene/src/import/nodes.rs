//! Where the default scene's nodes stand.

use glam::{DAffine3, DMat4, DQuat, DVec3};
use gltf::json;
use json::camera::Type;
use json::validation::Checked;

use super::document::{Document, escape};
use super::light::PlacedLight;
use crate::error::SceneError;
use crate::view::View;
use crate::warning::Warnings;

/// A mesh and where it stands.
pub(crate) struct Placed {
    /// Index of the mesh.
    pub mesh: usize,
    /// From the mesh's space to the world's.
    pub world: DAffine3,
}

/// What the nodes of the default scene place.
#[derive(Default)]
pub(crate) struct Graph {
    /// Meshes, depth first.
    pub placed: Vec<Placed>,
    /// Perspective cameras, depth first.
    pub views: Vec<View>,
    /// Lights of `KHR_lights_punctual`, depth first.
    pub lights: Vec<PlacedLight>,
}

/// Walks the default scene (the first one when none is named), depth first, children in their order.
pub(crate) fn walk(document: &Document, warnings: &mut Warnings) -> Result<Graph, SceneError> {
    let (root, at) = (&document.root, document.at());
    let first = root.scene.map_or(0, |s| s.value());
    let Some(scene) = root.scenes.get(first) else {
        return Err(SceneError::NoGeometry { file: crate::error::one_line(&document.name) });
    };
    let others = root.scenes.len() - 1;
    warnings.add_many("only the default scene is shown; the other scenes are ignored", others, || "/scenes".into());
    let mut graph = Graph::default();
    let mut reached = vec![false; root.nodes.len()];
    let mut stack: Vec<(usize, DAffine3)> = Vec::new();
    stack.extend(scene.nodes.iter().rev().map(|n| (n.value(), DAffine3::IDENTITY)));
    while let Some((index, parent)) = stack.pop() {
        let place = format!("/nodes/{index}");
        // Nodes form trees. Without this rule a cycle would not end, and shared children multiply without bound.
        if std::mem::replace(&mut reached[index], true) {
            return Err(at.malformed(place, "is reached twice: nodes must form trees without cycles"));
        }
        let node = &root.nodes[index];
        let local = local_transform(node).map_err(|what| at.malformed(&place, what))?;
        let world = parent * local;
        if !world.is_finite() {
            return Err(at.malformed(place, "its transform overflows together with its parents'"));
        }
        if let Some(mesh) = node.mesh {
            graph.placed.push(Placed { mesh: mesh.value(), world });
        }
        if let Some(camera) = node.camera {
            add_view(document, &mut graph, warnings, node, camera.value(), &world)?;
        }
        if let Some(light) = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref()) {
            graph.lights.push(PlacedLight { light: light.light.value(), world });
        }
        features(node, &place, warnings);
        stack.extend(node.children.iter().flatten().rev().map(|n| (n.value(), world)));
    }
    Ok(graph)
}

/// Names what a node holds beyond mesh, camera and transform.
fn features(node: &json::Node, place: &str, warnings: &mut Warnings) {
    if node.skin.is_some() {
        warnings.add("skins are not modelled; the mesh is shown unskinned", || format!("{place}/skin"));
    }
    for name in node.extensions.iter().flat_map(|e| e.others.keys()) {
        super::features::foreign(warnings, name, || format!("{place}/extensions/{}", escape(name)));
    }
}

/// A node's transform to its parent's space.
fn local_transform(node: &json::Node) -> Result<DAffine3, &'static str> {
    if let Some(m) = node.matrix {
        if !m.iter().all(|x| x.is_finite()) {
            return Err("its matrix has a number that is not finite");
        }
        let m = DMat4::from_cols_array(&m.map(f64::from));
        if m.row(3) != glam::DVec4::W {
            return Err("its matrix is not affine: the last row must be 0, 0, 0, 1");
        }
        return Ok(DAffine3::from_mat4(m));
    }
    let vector = |v: Option<[f32; 3]>, default| v.map_or(default, |v| DVec3::from_array(v.map(f64::from)));
    let translation = vector(node.translation, DVec3::ZERO);
    let scale = vector(node.scale, DVec3::ONE);
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.0.map(f64::from)));
    if !(translation.is_finite() && scale.is_finite() && rotation.is_finite()) {
        return Err("its translation, rotation or scale has a number that is not finite");
    }
    if rotation.length_squared() == 0.0 {
        return Err("its rotation is a quaternion of length 0");
    }
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation.normalize(), translation))
}

fn add_view(
    document: &Document,
    graph: &mut Graph,
    warnings: &mut Warnings,
    node: &json::Node,
    index: usize,
    world: &DAffine3,
) -> Result<(), SceneError> {
    let camera = &document.root.cameras[index];
    let place = || format!("/cameras/{index}");
    let perspective = match (camera.type_, &camera.perspective) {
        (Checked::Valid(Type::Perspective), Some(perspective)) => perspective,
        (Checked::Valid(Type::Orthographic), _) => {
            warnings.add("orthographic cameras are not modelled; this one is ignored", place);
            return Ok(());
        }
        _ => return Err(document.at().malformed(place(), "has no perspective")),
    };
    let name = camera.name.clone().or_else(|| node.name.clone()).unwrap_or_else(|| format!("camera {index}"));
    let view = View::from_transform(name, world, f64::from(perspective.yfov))
        .map_err(|what| document.at().malformed(place(), what))?;
    graph.views.push(view);
    Ok(())
}
