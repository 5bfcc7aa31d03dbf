//! What the command line takes. Names, values and defaults of settings come from the library.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand};
use hashcache::choice::{BackendKind, CacheKind, Choice, FilterKind, IntegratorKind, VisibilityKind};
use hashcache::{Settings, SettingsError};

use crate::failure::Failure;

/// Global-illumination previews of glTF scenes, with their error
#[derive(Parser)]
#[command(name = "hashcache", version, disable_help_subcommand = true)]
#[command(
    after_help = "Exit status: 0 done; 2 the command line is wrong; 1 anything else, with one line that says what."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Subcommand)]
pub enum Command {
    /// Render one image
    Render(Render),
    /// Show what a scene needs, the stages chosen for it, and why each is there
    Plan(Plan),
    /// Show triangles, extent, materials, lights, cameras, and what was ignored in the file
    Info(Info),
    /// Measure the difference of an image from a reference
    Compare(Compare),
}

/// `hashcache render`
#[derive(Args)]
pub struct Render {
    /// A .gltf or .glb file, or builtin:NAME (`hashcache info builtin:` lists them)
    pub scene: String,
    /// Write the image here, linear as .exr or .hdr, for a screen as .png; may be repeated
    /// [default: SCENE's name with .png in this folder, never over a file; nothing if --stats is given]
    #[arg(short, long = "output", value_name = "FILE")]
    pub outputs: Vec<PathBuf>,
    /// Write settings, plan, times, rays and cache figures here as JSON
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
    /// Show no progress, warnings or summary
    #[arg(short, long)]
    pub quiet: bool,
    #[command(flatten)]
    pub settings: SettingsArgs,
}

/// `hashcache plan`
#[derive(Args)]
pub struct Plan {
    /// A .gltf or .glb file, or builtin:NAME (`hashcache info builtin:` lists them)
    pub scene: String,
    #[command(flatten)]
    pub settings: SettingsArgs,
}

/// `hashcache info`
#[derive(Args)]
pub struct Info {
    /// A .gltf or .glb file, builtin:NAME, or builtin: alone for the list of names
    pub scene: String,
}

/// `hashcache compare`
#[derive(Args)]
pub struct Compare {
    /// The image: .exr, .hdr or .png (decoded to linear)
    pub image: PathBuf,
    /// What it should be, of the same size
    pub reference: PathBuf,
    /// Print one JSON object; numbers that do not exist (PSNR of equal images) are null
    #[arg(long)]
    pub json: bool,
}

/// Options that set how a scene is rendered.
#[derive(Args)]
#[command(next_help_heading = "Settings")]
pub struct SettingsArgs {
    #[arg(long, value_name = "NAME", value_parser = names::<BackendKind>(), help = help("backend", "Where kernels run"))]
    backend: Option<String>,
    #[arg(long, value_name = "NAME", value_parser = names::<IntegratorKind>(), help = help("integrator", "How light is transported"))]
    integrator: Option<String>,
    #[arg(long, value_name = "NAME", value_parser = names::<CacheKind>(), help = help("cache", "Where light is shared between paths"))]
    cache: Option<String>,
    #[arg(long, value_name = "NAME", value_parser = names::<VisibilityKind>(), help = help("visibility", "How shadow rays are answered"))]
    visibility: Option<String>,
    #[arg(long, value_name = "NAME", value_parser = names::<FilterKind>(), help = help("filter", "How the image is filtered"))]
    filter: Option<String>,
    #[arg(long, value_name = "N", allow_negative_numbers = true, help = help("spp", "Samples a pixel"))]
    spp: Option<String>,
    #[arg(
        long,
        value_name = "WxH",
        allow_hyphen_values = true,
        help = "Columns and rows of the image [default: the camera's, else 512x512]"
    )]
    size: Option<String>,
    #[arg(
        long,
        value_name = "NAME|INDEX|FILE.json",
        allow_negative_numbers = true,
        help = "A camera of the scene, or a camera file [default: the scene's first]"
    )]
    camera: Option<String>,
    /// An environment map in place of the scene's, .hdr or .exr
    #[arg(long, value_name = "FILE")]
    env: Option<OsString>,
    #[arg(long, value_name = "X", allow_negative_numbers = true, help = help("env_scale", "Factor on the environment's radiance"))]
    env_scale: Option<String>,
    #[arg(long, value_name = "N", allow_negative_numbers = true, help = help("max_bounces", "Surface scatterings at most; 0: only emission seen directly"))]
    max_bounces: Option<String>,
    #[arg(long, value_name = "N", allow_negative_numbers = true, help = help("seed", "Of every random decision"))]
    seed: Option<String>,
    #[arg(long, value_name = "N", allow_negative_numbers = true, help = help("threads", "Threads; 0: one a core. The image does not depend on it"))]
    threads: Option<String>,
    #[arg(long = "set", value_name = "KEY=VALUE", help = format!("Any setting by its name: {}", Settings::keys().join(", ")))]
    set: Vec<String>,
}

/// The values of a choice, the default first.
fn names<C: Choice>() -> PossibleValuesParser {
    PossibleValuesParser::new(C::names())
}

/// A help text with the default that the library has.
fn help(key: &str, text: &str) -> String {
    let default = Settings::default().to_json().remove(key).unwrap_or_default();
    match default.as_str() {
        Some(name) => format!("{text} [default: {name}]"),
        None => format!("{text} [default: {default}]"),
    }
}

impl SettingsArgs {
    /// The settings that the options ask for, checked together.
    pub fn settings(&self) -> Result<Settings, Failure> {
        let mut settings = Settings::default();
        let mut given = Vec::new();
        for (option, key, value) in self.options() {
            let Some(value) = value else { continue };
            settings.set(key, value).map_err(|error| option_failure(option, error))?;
            given.push(key.to_owned());
        }
        if let Some(path) = &self.env {
            settings.env = Some(path.into());
            given.push("env".to_owned());
        }
        for pair in &self.set {
            let Some((key, value)) = pair.split_once('=') else {
                return Err(Failure::usage(format!("--set {pair}: KEY=VALUE expected, as in --set spp=4")));
            };
            settings.set(key, value).map_err(|error| Failure::usage(format!("--set {error}")))?;
            if given.iter().any(|earlier| earlier == key) {
                return Err(Failure::usage(format!("--set {pair}: {key} is given twice; leave one out")));
            }
            given.push(key.to_owned());
        }
        settings.validate().map_err(|error| Failure::usage(error.to_string()))?;
        Ok(settings)
    }

    /// Option, setting and value.
    fn options(&self) -> [(&'static str, &'static str, Option<&str>); 12] {
        [
            ("--backend", "backend", self.backend.as_deref()),
            ("--integrator", "integrator", self.integrator.as_deref()),
            ("--cache", "cache", self.cache.as_deref()),
            ("--visibility", "visibility", self.visibility.as_deref()),
            ("--filter", "filter", self.filter.as_deref()),
            ("--spp", "spp", self.spp.as_deref()),
            ("--size", "size", self.size.as_deref()),
            ("--camera", "camera", self.camera.as_deref()),
            ("--env-scale", "env_scale", self.env_scale.as_deref()),
            ("--max-bounces", "max_bounces", self.max_bounces.as_deref()),
            ("--seed", "seed", self.seed.as_deref()),
            ("--threads", "threads", self.threads.as_deref()),
        ]
    }
}

/// A refused value, with the option as the user wrote it.
fn option_failure(option: &str, error: SettingsError) -> Failure {
    Failure::usage(match error {
        SettingsError::BadValue { value, expected, .. } => {
            format!("{option} {value}: not possible; it takes {expected}")
        }
        other => other.to_string(),
    })
}
