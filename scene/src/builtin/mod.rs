//! Scenes that need no file.

mod caustic_glass;
mod cornell;
mod furnace;
mod instances;
mod interior;
mod materials;
mod shapes;
mod thin_wall;

use glam::{DVec3, Vec3};
use pt_integrator::scene::SceneData;

use crate::builder::Builder;
use crate::error::{SceneError, one_line};
use crate::info::Info;
use crate::view::View;
use crate::{Loaded, SCHEME};

/// A scene that needs no file.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Builtin {
    /// Its name: it is loaded as `builtin:NAME`.
    pub name: &'static str,
    /// What it is, in one line.
    pub description: &'static str,
    /// The number that may follow as `builtin:NAME:NUMBER`.
    pub parameter: Option<Parameter>,
    build: fn(&mut Builder, f64),
    view: fn() -> Result<View, &'static str>,
    size: [u32; 2],
}

/// A number that a built-in scene is made from.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Parameter {
    /// What it is, with its unit.
    pub name: &'static str,
    /// Its value where none is given.
    pub default: f64,
    /// Smallest and largest value.
    pub range: [f64; 2],
    /// The range in words.
    expected: &'static str,
}

/// In the order in which they are listed.
const BUILTINS: [Builtin; 6] =
    [cornell::SCENE, furnace::SCENE, interior::SCENE, thin_wall::SCENE, instances::SCENE, caustic_glass::SCENE];

/// The built-in scenes.
///
/// ```
/// assert!(scene::builtins().iter().any(|b| b.name == "cornell"));
/// ```
pub fn builtins() -> &'static [Builtin] {
    &BUILTINS
}

/// Builds the scene called `name`, which may end in `:NUMBER`.
pub(crate) fn load(name: &str) -> Result<Loaded, SceneError> {
    let (plain, number) = name.split_once(':').map_or((name, None), |(plain, number)| (plain, Some(number)));
    let found = BUILTINS.iter().find(|b| b.name == plain && (number.is_none() || b.parameter.is_some()));
    let Some(builtin) = found else {
        let known = BUILTINS.map(|b| format!("{SCHEME}{}", b.name)).join(", ");
        return Err(SceneError::UnknownBuiltin { name: name.to_owned(), known });
    };
    let parameter = builtin.parameter.map_or(Ok(0.0), |parameter| parameter.read(number))?;
    let mut builder = Builder::default();
    (builtin.build)(&mut builder, parameter);
    let info = Info { extent: extent(&builder.data), ..Info::default() };
    let view = (builtin.view)().map_err(|what| SceneError::OutOfRange {
        what: "built-in camera",
        value: what.to_owned(),
        expected: "a valid camera",
    })?;
    let name = format!("{SCHEME}{name}");
    let mut loaded = Loaded::new(name, builder, DVec3::ZERO, vec![view], Vec::new(), info)?;
    loaded.size = Some(builtin.size);
    Ok(loaded)
}

impl Parameter {
    fn read(&self, text: Option<&str>) -> Result<f64, SceneError> {
        let Some(text) = text else { return Ok(self.default) };
        let [low, high] = self.range;
        text.parse().ok().filter(|value| (low..=high).contains(value)).ok_or_else(|| SceneError::OutOfRange {
            what: self.name,
            value: one_line(text),
            expected: self.expected,
        })
    }
}

/// The box around all instances' transformed boxes.
fn extent(data: &SceneData) -> [[f64; 3]; 2] {
    let mut bounds = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    let include = |[low, high]: [Vec3; 2], p: Vec3| [low.min(p), high.max(p)];
    let boxes: Vec<[Vec3; 2]> = data
        .meshes
        .iter()
        .map(|mesh| {
            let triangles = &data.indices[mesh.first_triangle as usize..][..mesh.triangle_count as usize];
            let points = triangles.iter().flatten().map(|&i| Vec3::from_array(data.positions[i as usize]));
            points.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], include)
        })
        .collect();
    for instance in &data.instances {
        let [low, high] = boxes[instance.mesh as usize];
        for corner in 0..8_u32 {
            let p = Vec3::select(glam::BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0), high, low);
            bounds = include(bounds, instance.point(p));
        }
    }
    bounds.map(|p| p.as_dvec3().to_array())
}
