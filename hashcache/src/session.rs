//! A scene that stays on a backend while frames are made of it.

use std::collections::BTreeMap;

use hashcache_core::stages::CastsRays;
use pt_integrator::scene::Camera;

use crate::clock::{self, Elapsed};
use crate::error::Error;
use crate::image_file::Image;
use crate::pipeline::{self, Pipeline};
use crate::preview::{Preview, Progress};
use crate::settings::Settings;
use crate::stats::{Rays, Stats};

/// One frame of a [`Session`].
#[derive(Clone, Debug)]
pub struct FrameOutput {
    /// Linear radiance.
    pub image: Image,
    /// Wall and CPU seconds of this frame.
    pub elapsed: Elapsed,
    /// The same by stage.
    pub stages: BTreeMap<&'static str, Elapsed>,
    /// Rays of this frame.
    pub rays: Rays,
}

/// A scene with its buffers and its cache on a backend. Frames share the cache; while the camera rests they share the
/// pixels' sums, too, and the picture converges.
///
/// ```
/// use hashcache::{Preview, Settings};
/// let mut settings = Settings::default();
/// settings.set("size", "32x32")?;
/// let preview = Preview::open("builtin:cornell", &settings)?;
/// let mut backend = preview.backend()?;
/// let mut session = preview.session(&mut backend)?;
/// let camera = preview.camera().clone();
/// for _ in 0..2 {
///     let frame = session.frame(&camera, &mut |_| ())?;
///     assert_eq!(frame.image.pixels.len(), 32 * 32);
/// }
/// assert_eq!(session.stats()?.frames, 2);
/// # Ok::<(), hashcache::Error>(())
/// ```
#[derive(Debug)]
pub struct Session<'a, B: CastsRays> {
    preview: &'a Preview,
    backend: &'a mut B,
    pipeline: Pipeline,
    stats: Stats,
}

impl<'a, B: CastsRays> Session<'a, B> {
    /// Uploads the scene and makes the cache.
    pub(crate) fn new(preview: &'a Preview, backend: &'a mut B) -> Result<Self, Error> {
        let name = backend.name();
        let (built, elapsed) = clock::measure(|| Pipeline::new(backend, preview));
        let pipeline = built.map_err(|error| error.told(name))?;
        let mut stats = preview.stats(name);
        (stats.time_s.build, stats.cpu_s.build) = (elapsed.wall_s, elapsed.cpu_s);
        Ok(Self { preview, backend, pipeline, stats })
    }

    /// Renders `spp` samples a pixel from a camera of the picture's size; a camera that moved starts new pixel sums.
    ///
    /// # Errors
    /// Those of the backend, with its name; [`Error::CameraSize`].
    pub fn frame(&mut self, camera: &Camera, progress: &mut dyn FnMut(Progress)) -> Result<FrameOutput, Error> {
        let (size, wanted) = ((camera.width, camera.height), self.preview.size());
        if size != wanted {
            return Err(Error::CameraSize { size, wanted });
        }
        let mut work = pipeline::Work::default();
        let (image, elapsed) =
            clock::measure(|| self.pipeline.frame(self.backend, self.preview, camera, &mut work, progress));
        let image = image.map_err(|error| error.told(self.backend.name()))?;
        self.stats.add_frame(elapsed, &work);
        Ok(FrameOutput { image, elapsed, stages: work.stages, rays: work.rays })
    }

    /// The last frame's picture with other strengths of the filter (`filter.radius` and so on; not another
    /// [`Settings::filter`]): no ray is traced. `None` before a frame, and with `cache=none` and `filter=none`, which keep
    /// nothing to filter.
    ///
    /// ```
    /// use hashcache::{Preview, Settings};
    /// let mut settings = Settings::default();
    /// settings.set("size", "32x32")?;
    /// let preview = Preview::open("builtin:cornell", &settings)?;
    /// let mut backend = preview.backend()?;
    /// let mut session = preview.session(&mut backend)?;
    /// let frame = session.frame(preview.camera(), &mut |_| ())?;
    /// assert_eq!(session.filtered(&settings)?.as_ref(), Some(&frame.image));
    /// settings.set("filter.radius", "1")?;
    /// assert_ne!(session.filtered(&settings)?, Some(frame.image));
    /// # Ok::<(), hashcache::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of the backend, with its name.
    pub fn filtered(&mut self, settings: &Settings) -> Result<Option<Image>, Error> {
        self.pipeline.filtered(self.backend, settings).map_err(|error| error.told(self.backend.name()))
    }

    /// Forgets all cached light, for lights that changed. Cells are emptied when they are next touched.
    ///
    /// # Errors
    /// Those of the backend, with its name.
    pub fn wipe(&mut self) -> Result<(), Error> {
        self.pipeline.wipe(self.backend).map_err(|error| error.told(self.backend.name()))
    }

    /// Scales all lights of the scene by a factor of at least 0 and forgets cached light and pixel sums, if the factor
    /// is not the one in force.
    ///
    /// # Errors
    /// Those of the backend, with its name.
    pub fn scale_light(&mut self, factor: f32) -> Result<(), Error> {
        let scaled = self.pipeline.scale_light(self.backend, self.preview, factor);
        scaled.map_err(|error| error.told(self.backend.name()))
    }

    /// What a denoiser or a reader of the picture wants to know about the last frame, by name, one picture each: `albedo`,
    /// `normal`, `depth`, `emission`, light without albedo by layer and source (`layer0_direct`, `layer0_cached`), and
    /// numbers of samples, of holes, and of the samples behind the cache's answers; of further layers all but the numbers
    /// (`layer1_albedo` and so on). Numbers stand in all three channels. Only vertices that scatter diffusely count.
    /// With them the standard error of each pixel's luminance before the filter, `stderr`, +∞ where it is not known; and with
    /// `check.fraction` the picture less the paths of the check, `check`, and the number of these paths, `check_samples`.
    /// With `cache=none` and `filter=none`, which keep nothing but radiance, there is only `stderr`, by `path.moments`, and
    /// the check.
    ///
    /// # Errors
    /// Those of the backend, with its name.
    pub fn aovs(&mut self) -> Result<Vec<(&'static str, Image)>, Error> {
        self.pipeline.aovs(self.backend, self.preview).map_err(|error| error.told(self.backend.name()))
    }

    /// The figures of all frames so far.
    ///
    /// # Errors
    /// Those of the backend, with its name.
    pub fn stats(&mut self) -> Result<Stats, Error> {
        let name = self.backend.name();
        let cache = self.pipeline.cache_stats(self.backend, self.preview).map_err(|error| error.told(name))?;
        let (stderr, check) = self.pipeline.accuracy(self.backend).map_err(|error| error.told(name))?;
        Ok(Stats { cache, stderr, check, peak_rss_bytes: clock::peak_rss_bytes(), ..self.stats.clone() })
    }
}
