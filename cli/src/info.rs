//! `hashcache info` and `hashcache plan`: what is known before rendering.

use hashcache::scene::{self, LoadOptions, Loaded};
use hashcache::{Preview, Stats};

use crate::args::{Info, Plan};
use crate::failure::Failure;
use crate::interrupt::uninterrupted;
use crate::outputs::{inputs, stats_bytes};
use crate::place::{Place, Staged};

/// What a scene holds; all built-in scenes for `builtin:`.
pub fn scene(args: &Info) -> Result<String, Failure> {
    if args.scene == "builtin:" {
        let line = |builtin: &scene::Builtin| format!("builtin:{}  {}", builtin.name, builtin.description);
        return Ok(lines(scene::builtins().iter().map(line)));
    }
    // Not by way of a preview: a scene without a camera can be looked into.
    let loaded = scene::load(&args.scene, &LoadOptions::default()).map_err(hashcache::Error::from)?;
    Ok(lines(rows(&loaded).into_iter().map(|(name, value)| format!("{name:<12}{value}").trim_end().to_owned())))
}

/// The stages for a scene under the settings given, what it needs, and what is left out.
pub fn plan(args: &Plan) -> Result<String, Failure> {
    let settings = args.settings.settings()?;
    let place = uninterrupted(|| args.stats.as_deref().map(Place::check).transpose())?;
    if let Some(place) = &place {
        place.refuse_inputs(inputs(&args.scene, &settings))?;
    }
    let preview = Preview::open(&args.scene, &settings)?;
    let plan = if args.measure {
        let mut backend = preview.backend()?;
        preview.measured_plan(&mut backend)?
    } else {
        preview.plan().clone()
    };
    if let Some(place) = place {
        let stats = Stats { saved: plan.saved.clone(), ..preview.outlook() };
        let bytes = stats_bytes(&stats)?;
        uninterrupted(|| place.stage_bytes(&bytes).and_then(Staged::commit))?;
    }
    let (width, height) = preview.size();
    let head = format!("{}: {width}x{height}, ", args.scene.escape_debug());
    Ok(head + &plan.to_string())
}

fn lines(all: impl Iterator<Item = String>) -> String {
    all.map(|line| line + "\n").collect()
}

/// Names and values; the name is empty where the one before goes on.
fn rows(loaded: &Loaded) -> Vec<(&'static str, String)> {
    let info = &loaded.info;
    let [low, high] = info.extent;
    let sides: Vec<_> = (0..3).map(|axis| metres(high[axis] - low[axis])).collect();
    let corner = |at: [f64; 3]| format!("({})", at.map(metres).join(", "));
    let mut rows = vec![
        ("scene", loaded.name.escape_debug().to_string()),
        ("triangles", format!("{} ({} stored, {} degenerate)", info.triangles, info.stored_triangles, info.degenerate)),
        ("meshes", format!("{} in {} instances", info.meshes, info.instances)),
        ("extent", format!("{} m, {} to {}", sides.join(" x "), corner(low), corner(high))),
        ("materials", materials(info)),
        ("textures", format!("{} of {} images", info.textures, info.images)),
        ("lights", lights(loaded)),
    ];
    let cameras = loaded.cameras.iter().enumerate().map(|(index, view)| {
        let (position, degrees) = (corner(view.position.to_array()), view.fov_y.to_degrees());
        format!("{index} {:?} at {position}, vertical field of view {degrees:.2} degrees", view.name)
    });
    list(&mut rows, "cameras", cameras);
    let extensions = info.extensions.iter().map(|extension| {
        let respect = if extension.respected { "" } else { " (not all of it, see below)" };
        format!("{}{respect}", extension.name.escape_debug())
    });
    list(&mut rows, "extensions", extensions);
    list(&mut rows, "ignored", loaded.warnings.iter().map(ToString::to_string));
    rows
}

fn list(rows: &mut Vec<(&'static str, String)>, name: &'static str, values: impl Iterator<Item = String>) {
    let before = rows.len();
    rows.extend(values.enumerate().map(|(i, value)| (if i == 0 { name } else { "" }, value)));
    if rows.len() == before {
        rows.push((name, "none".to_owned()));
    }
}

fn lights(loaded: &Loaded) -> String {
    let [points, spots, directions] = loaded.info.punctual_lights;
    let punctual = some(&[(points, "points"), (spots, "spots"), (directions, "directions")]);
    let punctual = if punctual.is_empty() { String::new() } else { format!(", without extent: {punctual}") };
    let (triangles, environment) = (loaded.info.emissive_triangles, hashcache::environment(&loaded.data));
    format!("{triangles} emissive triangles, environment: {environment}{punctual}")
}

/// Those that there are, with their numbers.
fn some(counts: &[(usize, &str)]) -> String {
    let some = counts.iter().filter(|c| c.0 > 0).map(|(count, name)| format!("{count} {name}"));
    some.collect::<Vec<_>>().join(", ")
}

fn materials(info: &scene::Info) -> String {
    let of = &info.surfaces;
    let lobes = some(&[
        (of.diffuse, "diffuse"),
        (of.reflection, "reflecting"),
        (of.transmission, "transmitting"),
        (of.coat, "coated"),
        (of.solid, "solid inside"),
        (of.emission, "emitting"),
        (of.normal_map, "with normal maps"),
        (of.mask, "with holes"),
        (of.unlit, "unlit"),
    ]);
    format!("{}: {lobes}", info.materials)
}

/// Enough digits to tell a millimetre in a room, and no row of zeros for a planet.
fn metres(value: f64) -> String {
    let text = if value != 0.0 && !(1e-3..1e7).contains(&value.abs()) {
        format!("{value:.3e}")
    } else {
        format!("{value:.3}")
    };
    if text == "-0.000" { "0.000".to_owned() } else { text }
}
