//! The options that set how a scene is rendered. Names, values and defaults come from the library.

use std::ffi::OsString;

use clap::Args;
use clap::builder::PossibleValuesParser;
use hashcache::choice::{BackendKind, CacheKind, Choice, FilterKind, IntegratorKind, VisibilityKind};
use hashcache::{Settings, SettingsError};

use crate::failure::Failure;

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

/// What the options say.
pub struct Given {
    /// The settings, not yet checked together.
    pub settings: Settings,
    /// The names of those that an option gives.
    pub keys: Vec<String>,
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
        let Given { settings, .. } = self.given()?;
        settings.validate().map_err(|error| Failure::usage(error.to_string()))?;
        Ok(settings)
    }

    /// The same without the check, and which settings the options name.
    pub fn given(&self) -> Result<Given, Failure> {
        let mut settings = Settings::default();
        let mut keys = Vec::new();
        for (option, key, value) in self.options() {
            let Some(value) = value else { continue };
            settings.set(key, value).map_err(|error| option_failure(option, error))?;
            keys.push(key.to_owned());
        }
        if let Some(path) = &self.env {
            settings.env = Some(path.into());
            keys.push("env".to_owned());
        }
        for pair in &self.set {
            let Some((key, value)) = pair.split_once('=') else {
                return Err(Failure::usage(format!("--set {pair}: KEY=VALUE expected, as in --set spp=4")));
            };
            settings.set(key, value).map_err(|error| Failure::usage(format!("--set {error}")))?;
            if keys.iter().any(|earlier| earlier == key) {
                return Err(Failure::usage(format!("--set {pair}: {key} is given twice; leave one out")));
            }
            keys.push(key.to_owned());
        }
        Ok(Given { settings, keys })
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
