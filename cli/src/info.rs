//! `hashcache info` and `hashcache plan`: what is known before rendering.

use hashcache::Preview;
use hashcache::scene::{self, LoadOptions, Loaded};

use crate::args::{Info, Plan};
use crate::failure::Failure;

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

/// The stages for a scene under the settings given.
pub fn plan(args: &Plan) -> Result<String, Failure> {
    let preview = Preview::open(&args.scene, &args.settings.settings()?)?;
    let (width, height) = preview.size();
    let head = format!("{}: {width}x{height}, ", args.scene.escape_debug());
    Ok(head + &preview.plan().to_string())
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
        ("materials", info.materials.to_string()),
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
    let needs = hashcache::needs(&loaded.data);
    let punctual = match loaded.info.punctual_lights {
        0 => String::new(),
        count => format!(", {count} punctual lights that are ignored"),
    };
    format!("{} emissive triangles, environment: {}{punctual}", needs.emissive_triangles, needs.environment)
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
