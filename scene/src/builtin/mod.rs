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

const BUILTINS: [Builtin; 6] = [
    Builtin {
        name: "cornell",
        description: "the Cornell box in RGB: one area light, two blocks, coloured walls; 512x512",
        parameter: None,
        build: |builder, _| cornell::build(builder),
        view: cornell::view,
        size: [512, 512],
    },
    Builtin {
        name: "furnace",
        description: "inside a closed grey box that glows: with N bounces every pixel is exactly 2 - 1/2^N; 256x256",
        parameter: None,
        build: |builder, _| furnace::build(builder),
        view: furnace::view,
        size: [256, 256],
    },
    Builtin {
        name: "interior",
        description: "a furnished room whose lamps are hidden and shine at the ceiling, with a polished floor, a mirror and glass: nearly all light is indirect; 640x360",
        parameter: None,
        build: |builder, _| interior::build(builder),
        view: interior::view,
        size: [640, 360],
    },
    Builtin {
        name: "thin-wall",
        description: "two rooms and a wall between them, 0.02 m or as thin as builtin:thin-wall:METRES says; the right one is black; 512x256",
        parameter: Some(thin_wall::THICKNESS),
        build: thin_wall::build,
        view: thin_wall::view,
        size: [512, 256],
    },
    Builtin {
        name: "instances",
        description: "a million triangles: three shrubs of five thousand, placed 256 times under a lamp and a sky; 640x360",
        parameter: None,
        build: |builder, _| instances::build(builder),
        view: instances::view,
        size: [640, 360],
    },
    Builtin {
        name: "caustic-glass",
        description: "a clear ball and an amber ring of glass, and the light that they gather on a floor; 512x384",
        parameter: None,
        build: |builder, _| caustic_glass::build(builder),
        view: caustic_glass::view,
        size: [512, 384],
    },
];

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
