//! From a scene's name to a picture.

use std::path::Path;

use glam::Vec3;
use hashcache_core::geometry::Geometry;
use hashcache_core::stages::CastsRays;
use pt_integrator::packed::PackedScene;
use pt_integrator::scene::{Camera, Environment};
use scene::{LoadOptions, Loaded, View};

use crate::choice::Choice as _;
use crate::clock::{self, Elapsed};
use crate::emission;
use crate::error::Error;
use crate::image_file::Image;
use crate::needs::{Needs, needs};
use crate::pipeline::measure;
use crate::plan::FramePlan;
use crate::session::Session;
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
        Self::open_with(scene, settings, camera, &|_| ())
    }

    /// The same, from a view of the caller's if there is one, and tells `progress` how far loading is: from any of its
    /// threads, one call at a time.
    ///
    /// # Errors
    /// As [`Preview::open`] and [`Preview::open_at`].
    pub fn open_with_progress(
        scene: &str,
        settings: &Settings,
        view: Option<&View>,
        progress: &(dyn Fn(scene::Progress) + Sync),
    ) -> Result<Self, Error> {
        match view {
            None => Self::open_with(scene, settings, camera, progress),
            Some(view) => Self::open_with(scene, settings, |loaded, set| at_size(loaded, set, view), progress),
        }
    }

    /// The same from a view of the caller's, whatever camera the settings name; the scene needs none.
    ///
    /// ```
    /// use hashcache::{Preview, Settings, scene::CameraPath};
    /// # let folder = tempfile::tempdir()?;
    /// # let file = folder.path().join("path.json");
    /// # let key = r#"{"time":0,"position":[0,0,2],"target":[0,0,0],"up":[0,1,0],"fov_y_deg":60}"#;
    /// # std::fs::write(&file, format!(r#"{{"keys":[{key}],"frames":3}}"#))?;
    /// let path = CameraPath::from_file(&file)?;
    /// let (view, _light) = path.frame(0).expect("a path has a frame");
    /// let preview = Preview::open_at("builtin:cornell", &Settings::default(), &view)?;
    /// assert_eq!(preview.camera(), &preview.camera_at(&view)?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Whatever is wrong with the settings, the scene, the view or the environment.
    pub fn open_at(scene: &str, settings: &Settings, view: &View) -> Result<Self, Error> {
        Self::open_with(scene, settings, |loaded, settings| at_size(loaded, settings, view), &|_| ())
    }

    fn open_with(
        scene: &str,
        settings: &Settings,
        camera: impl FnOnce(&Loaded, &Settings) -> Result<Camera, Error>,
        progress: &(dyn Fn(scene::Progress) + Sync),
    ) -> Result<Self, Error> {
        settings.validate()?;
        let (opened, load) = clock::measure(|| load(scene, settings, progress));
        let (loaded, mut packed, mut warnings) = opened?;
        let camera = camera(&loaded, settings)?;
        let needs = needs(&loaded.data, &packed);
        packed.force_needs(settings.needs_force.loop_bits());
        if !needs.has_light() {
            warnings
                .push(format!("{scene}: nothing gives light, so the picture is black; give an environment by --env"));
        }
        let plan = FramePlan::new(needs, settings, camera.pixels());
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

    /// The plan with what left-out features save of tracing time, by measurement on a backend: some hundred thousand samples,
    /// with and without each.
    ///
    /// # Errors
    /// Those of the backend, with its name.
    pub fn measured_plan<B: CastsRays>(&self, backend: &mut B) -> Result<FramePlan, Error> {
        let mut plan = self.plan.clone();
        measure::savings(backend, self, &mut plan.saved).map_err(|error| error.told(backend.name()))?;
        Ok(plan)
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
        self.render_on(&mut self.backend()?, progress)
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
        progress(Progress { stage: "build", done: 0, total: self.settings.spp });
        let mut session = self.session(backend)?;
        let image = session.frame(&self.camera, progress)?.image;
        Ok(Rendered { image, stats: session.stats()? })
    }

    /// The backend that the settings name.
    ///
    /// # Errors
    /// Those of the backend, with its name.
    #[cfg(feature = "cpu")]
    pub fn backend(&self) -> Result<backend_cpu::CpuBackend, Error> {
        use crate::choice::Launcher;
        match self.settings.launcher {
            Launcher::Serial => Ok(backend_cpu::CpuBackend::serial()),
            Launcher::Rayon => backend_cpu::CpuBackend::rayon(self.settings.threads as usize)
                .map_err(|error| Error::Backend { backend: "rayon", error }),
        }
    }

    /// Frames that share buffers and cache on a backend.
    ///
    /// # Errors
    /// Those of the backend, with its name.
    pub fn session<'a, B: CastsRays>(&'a self, backend: &'a mut B) -> Result<Session<'a, B>, Error> {
        Session::new(self, backend)
    }

    /// The camera that the settings name.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// A camera for the picture's size from a view in the scene file's coordinates.
    ///
    /// # Errors
    /// [`Error::Scene`] for a view too far away to be expressed.
    pub fn camera_at(&self, view: &View) -> Result<Camera, Error> {
        Ok(view.camera(self.loaded.origin, self.camera.width, self.camera.height)?)
    }

    /// The settings in force.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The same scene under other settings; it is read again only if they name another environment.
    ///
    /// # Errors
    /// As [`Preview::open`].
    pub fn with_settings(self, settings: &Settings) -> Result<Self, Error> {
        let numbers = |s: &Settings| [s.env_scale, s.env_rotation].map(f32::to_bits);
        let same_light = self.settings.env == settings.env && numbers(&self.settings) == numbers(settings);
        if !same_light || self.settings.needs_force != settings.needs_force {
            return Self::open(&self.loaded.name, settings);
        }
        settings.validate()?;
        let camera = camera(&self.loaded, settings)?;
        let plan = FramePlan::new(self.plan.needs.clone(), settings, camera.pixels());
        Ok(Self { settings: settings.clone(), camera, plan, ..self })
    }

    pub(crate) fn geometry(&self) -> Geometry<'_> {
        self.loaded.data.geometry()
    }

    /// Half the diagonal of the box about all placed triangles; 0.5 for a scene without any.
    pub(crate) fn radius(&self) -> f32 {
        let geometry = self.geometry();
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for instance in geometry.instances {
            let mesh = geometry.meshes[instance.mesh as usize];
            let run = mesh.first_triangle as usize..(mesh.first_triangle + mesh.triangle_count) as usize;
            for &vertex in geometry.indices[run].as_flattened() {
                let p = instance.point(geometry.positions[vertex as usize].into());
                (low, high) = (low.min(p), high.max(p));
            }
        }
        if low.cmple(high).all() { 0.5 * (high - low).length() } else { 0.5 }
    }

    pub(crate) fn packed(&self) -> &PackedScene {
        &self.packed
    }

    /// The packed scene with all lights scaled, or what is wrong with the factor.
    pub(crate) fn packed_with_light(&self, factor: f32) -> Result<PackedScene, String> {
        if !(factor >= 0.0 && factor.is_finite()) {
            return Err(format!("a factor of {factor}; it must be a number of at least 0"));
        }
        let data = emission::scaled(&self.loaded.data, factor);
        let mut packed = PackedScene::new(&data).map_err(|error| error.to_string())?;
        packed.force_needs(self.settings.needs_force.loop_bits());
        Ok(packed)
    }

    /// The figures that are known before anything is rendered: scene, settings, needs, plan, savings, loading time.
    pub fn outlook(&self) -> Stats {
        self.stats(self.settings.backend.name())
    }

    /// Figures that hold before the first frame.
    pub(crate) fn stats(&self, backend: &'static str) -> Stats {
        let mut stats = Stats {
            scene: self.loaded.name.clone(),
            backend: backend.to_owned(),
            settings: self.settings.to_json(),
            needs: self.plan.needs.clone(),
            plan: self.plan.stages.clone(),
            saved: self.plan.saved.clone(),
            warnings: self.warnings.clone(),
            ..Stats::default()
        };
        stats.settings.insert("size".into(), format!("{}x{}", self.camera.width, self.camera.height).into());
        stats.time_s.load = self.load.wall_s;
        stats.cpu_s.load = self.load.cpu_s;
        stats
    }

    /// [`emission::largest`] of the scene.
    pub(crate) fn max_radiance(&self) -> f32 {
        emission::largest(&self.loaded.data, self.radius())
    }
}

fn load(
    scene: &str,
    settings: &Settings,
    progress: &(dyn Fn(scene::Progress) + Sync),
) -> Result<(Loaded, PackedScene, Vec<String>), Error> {
    let mut options = LoadOptions::default();
    options.threads = settings.threads as usize;
    let mut loaded = scene::load_with_progress(scene, &options, progress)?;
    let mut warnings: Vec<String> = loaded.warnings.iter().map(|warning| format!("{scene}: {warning}")).collect();
    if let Some(path) = &settings.env {
        let (image, of_image) = scene::environment::load(path, settings.env_scale, &options)?;
        warnings.extend(of_image.iter().map(|warning| format!("{}: {warning}", path.display())));
        loaded.data.environment = Some(Environment::Image(image));
    } else if let Some(environment) = &mut loaded.data.environment {
        emission::scale_environment(environment, settings.env_scale);
    } else if settings.env_scale.to_bits() != 1.0_f32.to_bits() {
        let reason = "there is no environment for env_scale to scale; give one by --env".to_owned();
        return Err(Error::BadScene { scene: scene.to_owned(), reason });
    }
    if settings.env_rotation != 0.0 {
        if loaded.data.environment.is_none() {
            let reason = "there is no environment for env.rotation to turn; give one by --env".to_owned();
            return Err(Error::BadScene { scene: scene.to_owned(), reason });
        }
        loaded.data.environment_rotation += settings.env_rotation.to_radians();
    }
    let packed = PackedScene::new(&loaded.data)
        .map_err(|error| Error::BadScene { scene: scene.to_owned(), reason: error.to_string() })?;
    Ok((loaded, packed, warnings))
}

/// The camera that the settings name: a camera file, or one of the scene's by name or index; by default its first.
fn camera(loaded: &Loaded, settings: &Settings) -> Result<Camera, Error> {
    let is_file = |name: &str| Path::new(name).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
    let view = match settings.camera.as_deref() {
        Some(name) if is_file(name) => View::from_file(Path::new(name))?,
        which => loaded.view(which)?.clone(),
    };
    at_size(loaded, settings, &view)
}

/// A view's camera in the size that the settings or the scene name.
fn at_size(loaded: &Loaded, settings: &Settings, view: &View) -> Result<Camera, Error> {
    let (width, height) = settings.size.or(loaded.size.map(|[w, h]| (w, h))).unwrap_or(DEFAULT_SIZE);
    Ok(view.camera(loaded.origin, width, height)?)
}
