//! From a scene's name to a picture.

use std::path::Path;

use backend_api::Error as BackendError;
use hashcache_core::stages::CastsRays;
use pt_integrator::packed::PackedScene;
use pt_integrator::scene::{Camera, Environment};
use scene::{LoadOptions, Loaded, View};

use crate::clock::{self, Elapsed};
use crate::error::Error;
use crate::image_file::Image;
use crate::needs::{Needs, needs};
use crate::pipeline::{self, Frame};
use crate::plan::FramePlan;
use crate::settings::Settings;
use crate::stats::Stats;

/// The picture's size where neither the settings nor the scene name one.
const DEFAULT_SIZE: (u32, u32) = (512, 512);

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is being done.
    pub stage: &'static str,
    /// Samples a pixel that are done.
    pub done: u32,
    /// Samples a pixel in all.
    pub total: u32,
}

/// A finished picture and its figures.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Linear radiance.
    pub image: Image,
    /// How it came about.
    pub stats: Stats,
}

/// A scene, loaded and packed, with what it is to be rendered with.
///
/// ```
/// use hashcache::{Preview, Settings};
/// let mut settings = Settings::default();
/// settings.size = Some((32, 32));
/// let preview = Preview::open("builtin:cornell", &settings)?;
/// let rendered = preview.render(&mut |_| ())?;
/// assert_eq!(rendered.image.pixels.len(), 32 * 32);
/// # Ok::<(), hashcache::Error>(())
/// ```
#[derive(Debug)]
pub struct Preview {
    loaded: Loaded,
    packed: PackedScene,
    settings: Settings,
    camera: Camera,
    plan: FramePlan,
    load: Elapsed,
    warnings: Vec<String>,
}

impl Preview {
    /// Loads a scene (a `.gltf` or `.glb` file or `builtin:NAME`) and checks it against the settings.
    ///
    /// # Errors
    /// Whatever is wrong with the settings, the scene, its camera or its environment.
    pub fn open(scene: &str, settings: &Settings) -> Result<Self, Error> {
        settings.validate()?;
        let (opened, load) = clock::measure(|| load(scene, settings));
        let (loaded, packed, mut warnings) = opened?;
        let camera = camera(&loaded, settings)?;
        let needs = needs(&loaded.data);
        if !needs.has_light() {
            warnings
                .push(format!("{scene}: nothing gives light, so the picture is black; give an environment by --env"));
        }
        let plan = FramePlan::new(needs, settings);
        Ok(Self { loaded, packed, settings: settings.clone(), camera, plan, load, warnings })
    }

    /// The same scene with another seed.
    #[must_use]
    pub fn with_seed(mut self, seed: u32) -> Self {
        self.settings.seed = seed;
        self
    }

    /// The stages of a frame and why each is there.
    pub fn plan(&self) -> &FramePlan {
        &self.plan
    }

    /// What the scene needs.
    pub fn needs(&self) -> &Needs {
        &self.plan.needs
    }

    /// Figures of the loaded scene.
    pub fn info(&self) -> &scene::Info {
        &self.loaded.info
    }

    /// What the file holds beyond what is shown, a line each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Columns and rows of the picture.
    pub fn size(&self) -> (u32, u32) {
        (self.camera.width, self.camera.height)
    }

    /// Renders on the backend that the settings name.
    ///
    /// # Errors
    /// Those of the backend, with its name.
    #[cfg(feature = "cpu")]
    pub fn render(&self, progress: &mut dyn FnMut(Progress)) -> Result<Rendered, Error> {
        use crate::choice::Launcher;
        let threads = self.settings.threads as usize;
        let mut backend = match self.settings.launcher {
            Launcher::Serial => backend_cpu::CpuBackend::serial(),
            Launcher::Rayon => {
                backend_cpu::CpuBackend::rayon(threads).map_err(|error| Error::Backend { backend: "rayon", error })?
            }
        };
        self.render_on(&mut backend, progress)
    }

    /// Renders on a backend of the caller's.
    ///
    /// # Errors
    /// Those of the backend, with its name.
    pub fn render_on<B: CastsRays>(
        &self,
        backend: &mut B,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Rendered, Error> {
        let name = backend.name();
        let frame = Frame {
            scene: &self.packed,
            geometry: self.loaded.data.geometry(),
            camera: &self.camera,
            settings: &self.settings,
            plan: &self.plan,
            max_radiance: self.max_radiance(),
        };
        let traced = pipeline::render(backend, &frame, progress).map_err(|error| match error {
            pipeline::Error::Backend(BackendError::OutOfMemory { size }) => {
                Error::OutOfMemory { what: "the frame", bytes: size }
            }
            pipeline::Error::Backend(error) => Error::Backend { backend: name, error },
            pipeline::Error::Grid(error) => Error::Grid(error.to_string()),
        })?;
        let mut stats = Stats {
            scene: self.loaded.name.clone(),
            backend: name.to_owned(),
            settings: self.settings.to_json(),
            needs: self.plan.needs.clone(),
            plan: self.plan.stages.clone(),
            peak_rss_bytes: clock::peak_rss_bytes(),
            samples_per_pixel: self.settings.spp,
            frames: 1,
            warnings: self.warnings.clone(),
            ..traced.stats
        };
        stats.settings.insert("size".into(), format!("{}x{}", self.camera.width, self.camera.height).into());
        stats.time_s.load = self.load.wall_s;
        stats.cpu_s.load = self.load.cpu_s;
        Ok(Rendered { image: traced.image, stats })
    }

    /// The largest radiance that anything emits.
    fn max_radiance(&self) -> f32 {
        let data = &self.loaded.data;
        let materials = data.materials.iter().flat_map(|material| material.emission[..3].iter());
        let environment: Box<dyn Iterator<Item = &f32>> = match &data.environment {
            None => Box::new(std::iter::empty()),
            Some(Environment::Constant(color)) => Box::new(color.iter()),
            Some(Environment::Image(image)) => Box::new(image.texels.iter().flat_map(|texel| texel[..3].iter())),
        };
        materials.chain(environment).fold(0.0, |largest, &x| largest.max(x))
    }
}

fn load(scene: &str, settings: &Settings) -> Result<(Loaded, PackedScene, Vec<String>), Error> {
    let options = LoadOptions::default();
    let mut loaded = scene::load(scene, &options)?;
    let mut warnings: Vec<String> = loaded.warnings.iter().map(|warning| format!("{scene}: {warning}")).collect();
    if let Some(path) = &settings.env {
        let (image, of_image) = scene::environment::load(path, settings.env_scale, &options)?;
        warnings.extend(of_image.iter().map(|warning| format!("{}: {warning}", path.display())));
        loaded.data.environment = Some(Environment::Image(image));
    } else if let Some(environment) = &mut loaded.data.environment {
        scale_environment(environment, settings.env_scale);
    } else if settings.env_scale.to_bits() != 1.0_f32.to_bits() {
        let reason = "there is no environment for env_scale to scale; give one by --env".to_owned();
        return Err(Error::BadScene { scene: scene.to_owned(), reason });
    }
    let packed = PackedScene::new(&loaded.data)
        .map_err(|error| Error::BadScene { scene: scene.to_owned(), reason: error.to_string() })?;
    Ok((loaded, packed, warnings))
}

fn scale_environment(environment: &mut Environment, scale: f32) {
    match environment {
        Environment::Constant(color) => color.iter_mut().for_each(|x| *x *= scale),
        Environment::Image(image) => image.texels.iter_mut().flatten().for_each(|x| *x *= scale),
    }
}

/// The camera that the settings name: a camera file, or one of the scene's by name or index; by default its first.
fn camera(loaded: &Loaded, settings: &Settings) -> Result<Camera, Error> {
    let (width, height) = settings.size.or(loaded.size.map(|[w, h]| (w, h))).unwrap_or(DEFAULT_SIZE);
    let is_file = |name: &str| Path::new(name).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
    let view = match settings.camera.as_deref() {
        Some(name) if is_file(name) => View::from_file(Path::new(name))?,
        which => loaded.view(which)?.clone(),
    };
    Ok(view.camera(loaded.origin, width, height)?)
}
