//! One pipeline for every backend: runs a plan, frame after frame.

mod aov;
pub(crate) mod batches;
mod buffers;
mod cache;
mod cached;
mod check;
mod film;
mod look;
pub(crate) mod measure;

use backend_api::{Backend, Binding, Error as BackendError, Primitive};
use hashcache_core::stages::CastsRays;
use layered_filter::NoisePixel;
use pt_integrator::camera::CameraRays;
use pt_integrator::kernels::TraceParams;
use pt_integrator::packed::PackedScene;
use pt_integrator::path::{PathSettings, RayCounts};
use pt_integrator::scene::Camera;

use crate::accuracy::{CheckStats, StderrStats, standard_errors};
use crate::choice::{CacheKind, FilterKind};
use crate::error::Error as Told;
use crate::image_file::Image;
use crate::preview::{Preview, Progress};
use crate::settings::Settings;
use crate::stats::{CacheStats, Rays};

pub(crate) use buffers::{Work, read};
use buffers::{create, part, upload_all};
use cached::Cached;
use check::Check;
use film::Film;

/// Whole paths of one submission: often enough to show progress, seldom enough to cost nothing.
const PATHS_PER_SUBMIT: u64 = 1 << 21;

/// What can go wrong in a frame.
#[derive(Debug)]
pub(crate) enum Error {
    Backend(BackendError),
    Refused { what: &'static str, reason: String },
    Setting(&'static str),
}

impl From<BackendError> for Error {
    fn from(error: BackendError) -> Self {
        Self::Backend(error)
    }
}

impl Error {
    /// A part's refusal of its parameters.
    pub fn refused(what: &'static str, error: &dyn ToString) -> Self {
        Self::Refused { what, reason: error.to_string() }
    }

    /// As the caller of the library reads it.
    pub fn told(self, backend: &'static str) -> Told {
        match self {
            Self::Backend(BackendError::OutOfMemory { size }) => Told::OutOfMemory { what: "the frame", bytes: size },
            Self::Backend(error) => Told::Backend { backend, error },
            Self::Refused { what, reason } => Told::Refused { what, reason },
            Self::Setting(what) => Told::Refused { what, reason: "out of range".to_owned() },
        }
    }
}

/// A scene's buffers, a cache, and the pixels' sums.
#[derive(Debug)]
pub(crate) struct Pipeline {
    resident: Resident,
    film: Film,
    cached: Option<Cached>,
    check: Option<Check>,
    /// The camera of the last frame.
    camera: Option<Camera>,
    /// Points of a pixel's sequence that earlier frames took.
    traced: u32,
    /// Factor on all lights.
    light: f32,
}

/// What every tracing kernel reads.
#[derive(Clone, Copy, Debug)]
struct Resident {
    triangles: Binding,
    scene: Binding,
    texels: Binding,
    counters: Binding,
    pixels: u32,
}

impl Pipeline {
    /// Uploads the scene and makes the cache that the settings name.
    pub fn new<B: CastsRays>(backend: &mut B, preview: &Preview) -> Result<Self, Error> {
        backend.set_geometry(&preview.geometry())?;
        let pixels = preview.camera().pixels();
        let resident = Resident::new(backend, preview.packed(), pixels)?;
        let settings = preview.settings();
        let film = Film::new(backend, settings, pixels)?;
        let plain = settings.cache == CacheKind::None && settings.filter == FilterKind::None;
        let cached = if plain { None } else { Some(Cached::new(backend, preview, &resident)?) };
        let check = Check::new(backend, preview)?;
        Ok(Self { resident, film, cached, check, camera: None, traced: 0, light: 1.0 })
    }

    /// One frame: `spp` more samples a pixel. Sums start anew where the camera moved.
    pub fn frame<B: CastsRays>(
        &mut self,
        backend: &mut B,
        preview: &Preview,
        camera: &Camera,
        work: &mut Work,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Image, Error> {
        let moved = self.camera.as_ref() != Some(camera);
        if moved {
            if self.camera.is_some() {
                work.stage(backend, "resolve", |backend| {
                    backend.primitive(Primitive::Fill { buffer: self.film.sums().buffer, word: 0 })
                })?;
            }
            self.camera = Some(*camera);
        }
        let before = self.resident.ray_counts(backend)?;
        let pass = Pass { resident: self.resident, camera, settings: preview.settings() };
        let (image, used) = match &mut self.cached {
            None => {
                self.film.trace(backend, &pass, self.traced, work, progress)?;
                (self.film.resolve(backend, &pass, work)?, pass.settings.spp)
            }
            Some(cached) => {
                let image = cached.frame(backend, &pass, preview, moved, self.traced, work, progress)?;
                (image, cached::samples(pass.settings))
            }
        };
        self.traced = self.traced.wrapping_add(used);
        work.samples = pass.settings.spp;
        let counts = self.resident.ray_counts(backend)?;
        work.rays = Rays {
            closest: counts.closest - before.closest,
            shadow_asked: counts.shadow_asked - before.shadow_asked,
            shadow_traced: counts.shadow_traced - before.shadow_traced,
        };
        work.non_finite = counts.non_finite - before.non_finite;
        if let Some(check) = &mut self.check {
            check.frame(backend, &pass, moved, &image, work, progress)?;
        }
        Ok(image)
    }

    /// The last frame's picture by the filter's strength in other settings; `None` before a frame and without sums.
    pub fn filtered<B: CastsRays>(&mut self, backend: &mut B, settings: &Settings) -> Result<Option<Image>, Error> {
        let (Some(cached), Some(camera)) = (&mut self.cached, &self.camera) else { return Ok(None) };
        let pass = Pass { resident: self.resident, camera, settings };
        let image = cached.picture(backend, &pass, &mut Work::default())?;
        if let Some(check) = &mut self.check {
            check.compare(backend, &pass, &image)?;
        }
        Ok(Some(image))
    }

    /// Forgets cached light.
    pub fn wipe<B: CastsRays>(&mut self, backend: &mut B) -> Result<(), Error> {
        self.cached.as_mut().map_or(Ok(()), |cached| cached.wipe(backend))
    }

    /// Scales all lights and forgets what they lit, at once or from frame to frame.
    pub fn scale_light<B: CastsRays>(&mut self, backend: &mut B, preview: &Preview, factor: f32) -> Result<(), Error> {
        if factor.to_bits() == self.light.to_bits() {
            return Ok(());
        }
        let scaled = preview.packed_with_light(factor);
        let bytes = scaled.as_ref().map(PackedScene::scene_bytes).map_err(|reason| Error::refused("light", reason))?;
        backend.write(self.resident.scene.buffer, 0, bytes)?;
        self.light = factor;
        // The next frame starts new sums even if the camera rests.
        self.camera = None;
        backend.primitive(Primitive::Fill { buffer: self.film.sums().buffer, word: 0 })?;
        backend.submit()?;
        self.cached.as_mut().map_or(Ok(()), |cached| cached.relight(backend, preview.settings()))
    }

    /// Each pixel's error as far as its sums tell; `None` where none are kept.
    fn noise<B: CastsRays>(&mut self, backend: &mut B) -> Result<Option<Vec<NoisePixel>>, Error> {
        match &self.cached {
            None => self.film.noise(backend, self.resident.pixels),
            Some(cached) => cached.noise(backend, self.resident.pixels).map(Some),
        }
    }

    /// How wrong the last frame is, as far as its sums and the check tell.
    pub fn accuracy<B: CastsRays>(
        &mut self,
        backend: &mut B,
    ) -> Result<(Option<StderrStats>, Option<CheckStats>), Error> {
        let noise = self.noise(backend)?;
        Ok((noise.as_deref().map(standard_errors), self.check.as_ref().and_then(Check::figures)))
    }

    /// Pictures beside the picture; none without sums and check.
    pub fn aovs<B: CastsRays>(
        &mut self,
        backend: &mut B,
        preview: &Preview,
    ) -> Result<Vec<(&'static str, Image)>, Error> {
        let (width, height) = preview.size();
        let mut pictures = match &self.cached {
            None => Vec::new(),
            Some(cached) => aov::pictures(width, height, &cached.sums(backend)?),
        };
        pictures.extend(self.noise(backend)?.map(|noise| aov::standard_errors(width, height, &noise)));
        pictures.extend(self.check.iter().flat_map(|check| check.pictures(width, height)));
        Ok(pictures)
    }

    /// The cache's figures.
    pub fn cache_stats<B: CastsRays>(
        &mut self,
        backend: &mut B,
        preview: &Preview,
    ) -> Result<Option<CacheStats>, Error> {
        self.cached.as_mut().map_or(Ok(None), |cached| cached.stats(backend, preview.settings()))
    }
}

impl Resident {
    /// Uploads the scene: all or nothing.
    fn new<B: Backend>(backend: &mut B, packed: &PackedScene, pixels: u32) -> Result<Self, BackendError> {
        let counters = vec![0; RayCounts::WORDS * 8];
        let all = [
            ("triangles", packed.triangle_bytes()),
            ("scene", packed.scene_bytes()),
            ("texels", packed.texel_bytes()),
            ("ray counters", &counters),
        ];
        let [triangles, scene, texels, counters] = upload_all(backend, all)?;
        Ok(Self { triangles, scene, texels, counters, pixels })
    }

    /// Gives the buffers back.
    fn release<B: Backend>(self, backend: &mut B) -> Result<(), BackendError> {
        let Self { triangles, scene, texels, counters, pixels: _ } = self;
        [triangles, scene, texels, counters].iter().try_for_each(|binding| backend.destroy(binding.buffer))
    }

    fn ray_counts<B: Backend>(&self, backend: &mut B) -> Result<RayCounts, BackendError> {
        let bytes = read(backend, self.counters)?;
        let mut words = [0; RayCounts::WORDS];
        for (word, bytes) in words.iter_mut().zip(bytes.chunks_exact(8)) {
            *word = bytemuck::pod_read_unaligned(bytes);
        }
        Ok(RayCounts::from_words(words))
    }
}

/// What the passes of one frame share.
struct Pass<'a> {
    resident: Resident,
    camera: &'a Camera,
    settings: &'a Settings,
}

impl Pass<'_> {
    /// Parameters of the tracing kernels for a run of pixels and samples.
    fn trace_params(&self, first_pixel: u32, first_sample: u32, samples: u32) -> TraceParams {
        let settings = self.settings;
        TraceParams {
            camera: CameraRays::new(self.camera),
            width: self.camera.width,
            first_pixel,
            first_sample,
            samples,
            seed: settings.seed,
            max_bounces: settings.max_bounces,
            roulette_depth: settings.roulette_depth.unwrap_or(PathSettings::NO_ROULETTE),
            store_length: u32::MAX,
        }
    }

    /// A picture from texels of four floats.
    fn picture(&self, bytes: &[u8]) -> Image {
        let pixels = bytes.chunks_exact(16).map(|texel| {
            let [r, g, b, _]: [f32; 4] = bytemuck::pod_read_unaligned(texel);
            [r, g, b]
        });
        Image { width: self.camera.width, height: self.camera.height, pixels: pixels.collect() }
    }
}
