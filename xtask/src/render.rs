//! `cargo xtask render`: the README's first command.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use serde_json::Value;

use crate::step::{self, Step};

/// Samples a pixel of the reference that the preview is compared with. Path tracing of this scene at 512×512 has a
/// relMSE below 0.14 / samples, so the reference adds about 0.002 to what is printed.
const REFERENCE_SPP: &str = "64";

/// Builds, renders a preview and a reference, and prints time, rays and error.
pub fn steps() -> Vec<Step> {
    vec![
        Step::cargo(&["build", "--release", "-p", "hashcache-cli"], "hashcache does not build."),
        Step::new("render builtin:cornell", "The lines above say what went wrong.", report),
    ]
}

fn report() -> Result<(), String> {
    let out = step::root().join("out");
    fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let preview = out.join("cornell.exr");
    let reference = out.join("cornell-reference.exr");
    let start = Instant::now();
    let stats = render(&out, "cornell", &["-o", &text(&out.join("cornell.png")), "-o", &text(&preview)])?;
    let seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    render(
        &out,
        "cornell-reference",
        &["--cache", "none", "--filter", "none", "--spp", REFERENCE_SPP, "-o", &text(&reference)],
    )?;
    let reference_seconds = start.elapsed().as_secs_f64();
    let comparison = hashcache(&["compare", &text(&preview), &text(&reference), "--json"])?;
    let comparison: Value = serde_json::from_str(&comparison).map_err(|error| format!("hashcache compare: {error}"))?;
    let rays = |kind: &str| stats["rays"][kind].as_u64().unwrap_or(0) as f64 / 1e6;
    println!("picture    {}", out.join("cornell.png").display());
    println!("files      {} and cornell.json beside it", preview.display());
    println!(
        "time       {seconds:.2} s in all, render {:.2} s, {:.2} CPU-seconds",
        number(&stats["time_s"]["render"]),
        number(&stats["cpu_s"]["render"])
    );
    println!("rays       {:.2} M closest hit, {:.2} M shadow", rays("closest"), rays("shadow_traced"));
    println!(
        "relMSE     {:.5} ({:.5} without its worst 0.1 % of pixels) against path tracing at {REFERENCE_SPP} samples a pixel ({reference_seconds:.1} s)",
        number(&comparison["relmse"]),
        number(&comparison["relmse_trimmed"])
    );
    Ok(())
}

fn render(out: &Path, name: &str, arguments: &[&str]) -> Result<Value, String> {
    let stats = out.join(format!("{name}.json"));
    let stats_text = text(&stats);
    let mut all = vec!["render", "builtin:cornell", "--stats", &stats_text];
    all.extend(arguments);
    hashcache(&all)?;
    let json = fs::read_to_string(&stats).map_err(|error| format!("{}: {error}", stats.display()))?;
    serde_json::from_str(&json).map_err(|error| format!("{}: {error}", stats.display()))
}

fn hashcache(arguments: &[&str]) -> Result<String, String> {
    let binary = step::target().join("release").join(format!("hashcache{}", std::env::consts::EXE_SUFFIX));
    step::output(Command::new(binary).args(arguments).current_dir(step::root()))
}

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}
