//! glTF files, images and environment maps as scene data for hashcache.
//!
//! ```
//! let loaded = scene::load("builtin:cornell", &scene::LoadOptions::default())?;
//! assert_eq!(loaded.info.triangles, 36);
//! let [width, height] = loaded.size.unwrap_or([512, 512]);
//! let camera = loaded.view(None)?.camera(loaded.origin, width, height)?;
//! assert_eq!(camera.pixels(), 512 * 512);
//! # Ok::<(), scene::SceneError>(())
//! ```
//!
//! # Concepts
//! - [`load`] takes a `.gltf` or `.glb` path, or `builtin:NAME` (see [`builtins`]), and gives a [`Loaded`] scene: lists for
//!   the integrator, cameras, figures, and a [`Warning`] for each kind of thing that the file holds and that is not shown.
//! - **Origin.** Geometry is placed relative to [`Loaded::origin`], which is subtracted in f64, so a scene far from zero
//!   keeps its precision. Cameras ([`View`]) keep the file's coordinates; [`View::camera`] makes them relative.
//! - **Baked and instanced.** Meshes placed once are written in world space and become one mesh; those placed more often
//!   are stored once and placed by instances.
//! - **Surfaces.** Every material is a two-sided Lambertian with the diffuse base colour (factor × texture, 8-bit texels
//!   decoded from sRGB before filtering). Emission is emissive factor × strength, from the front (counter-clockwise) side
//!   unless the material is double-sided. Emitting primitives are shaded by the triangles' own normals.
//! - **Cameras** are pinholes with the file's vertical field of view; the picture's size gives the aspect ratio.
//!   A [`CameraPath`] is a move of one, read from a file of its own.
//!
//! # What is read
//! glTF 2.0 and GLB: nodes (matrix or translation, rotation, scale), meshes of triangles, strips and fans, `POSITION`,
//! `NORMAL`, the `TEXCOORD_n` that the base colour texture reads, PNG and JPEG images (files, buffer views, `data:`),
//! perspective cameras, `KHR_materials_emissive_strength`, `KHR_materials_specular` (a factor of 0 is Lambertian),
//! `KHR_mesh_quantization`. Files that the scene names lie in its folder or below; absolute paths, `..` and other URI
//! schemes are refused. Sparse accessors, mesh compression and unknown required extensions are refused by name.
//!
//! # Untrusted files
//! Every size, offset and index is checked before it is used, nothing is allocated for announced counts that the file
//! does not hold, nodes must form trees, and numbers that are not finite are errors. [`LoadOptions`] bounds memory.
//!
//! # Memory
//! 12 bytes a vertex, 60 a triangle (12 corners, 48 shading), 4 a texel; while loading also the file's own bytes and 4–12
//! bytes a vertex and 12 a triangle of the largest primitive. A million triangles over half a million vertices: 66 MB.
//!
//! # Determinism
//! The same file gives the same lists, bit for bit.
//!
//! # Limits today
//! No specular reflection, transmission, normal maps, alpha, emissive textures, vertex colours, punctual lights, skins,
//! morph targets or animations: each is named in a warning.
//!
//! # Sources
//! Khronos, glTF 2.0 specification (2.0.1). [`CameraPath`]: Catmull & Rom 1974, Barry & Goldman 1988. The Cornell box: Goral et al. 1984, in RGB as in Mitsuba 3.

mod builder;
mod builtin;
pub mod environment;
mod error;
mod import;
mod info;
mod parallel;
mod path;
mod progress;
mod texture;
mod view;
mod warning;

use std::path::Path;

use glam::DVec3;
use pt_integrator::scene::SceneData;

pub use builtin::{Builtin, builtins};
pub use error::SceneError;
pub use glam;
pub use info::{Extension, Info};
pub use path::{CameraKey, CameraPath};
pub use progress::Progress;
pub use view::View;
pub use warning::Warning;

use builder::Builder;

/// What a built-in scene's source begins with.
const SCHEME: &str = "builtin:";

/// Bounds on what a file may ask for. The defaults fit a machine with 32 GB.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadOptions {
    /// Most triangles stored, and a third of the most vertices: 2²⁷ by default, 8 GB and at most 4.8 GB of vertices. Any
    /// value keeps indices within 32 bits.
    pub max_triangles: u32,
    /// Most texels of all textures together, and of an environment: 2²⁸ by default, 1 GiB of texture texels.
    pub max_texels: u32,
    /// Most bytes of a file, of all buffers together, and of all image files together: 4 GiB by default.
    pub max_bytes: u64,
    /// Threads that decode images; 0, the default, is all that the machine has. The result does not depend on it.
    pub threads: usize,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self { max_triangles: 1 << 27, max_texels: 1 << 28, max_bytes: 4 << 30, threads: 0 }
    }
}

/// A loaded scene.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Loaded {
    /// The scene's source, for messages.
    pub name: String,
    /// The integrator's lists, relative to [`Loaded::origin`]; [`SceneData::validate`] has accepted them. Its cameras are
    /// [`Loaded::cameras`] in [`Loaded::size`], or 512×512.
    pub data: SceneData,
    /// Subtracted from the file's coordinates, in metres: file = origin + scene.
    pub origin: DVec3,
    /// Perspective cameras of the default scene, depth first. There may be none.
    pub cameras: Vec<View>,
    /// The picture's natural width and height, where the scene has one (built-in scenes do).
    pub size: Option<[u32; 2]>,
    /// What the file holds beyond what is shown.
    pub warnings: Vec<Warning>,
    /// Figures.
    pub info: Info,
}

/// Loads a scene: the path of a `.gltf` or `.glb` file, or `builtin:NAME`.
///
/// # Errors
/// [`SceneError`], whose `Display` is one line with file, place and advice. A scene without cameras is no error here;
/// [`Loaded::view`] says so when one is needed.
pub fn load(source: &str, options: &LoadOptions) -> Result<Loaded, SceneError> {
    load_with_progress(source, options, &progress::nobody)
}

/// Like [`load`], and tells `progress` how far it is: from any of its threads, one call at a time.
///
/// # Errors
/// As for [`load`].
///
/// ```
/// let tell = |p: scene::Progress| println!("{} {}/{}", p.what, p.done, p.total);
/// assert!(scene::load_with_progress("nothing.glb", &scene::LoadOptions::default(), &tell).is_err());
/// ```
pub fn load_with_progress(
    source: &str,
    options: &LoadOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Loaded, SceneError> {
    if let Some(name) = source.strip_prefix(SCHEME) {
        return builtin::load(name);
    }
    let path = Path::new(source);
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("gltf") || extension.eq_ignore_ascii_case("glb") {
        import::load(path, options, progress)
    } else {
        Err(SceneError::UnknownFormat { source_name: error::one_line(source) })
    }
}

impl Loaded {
    /// The camera with this name or, failing that, this index; the first one for `None`.
    ///
    /// # Errors
    /// [`SceneError::NoCamera`] or [`SceneError::UnknownCamera`].
    pub fn view(&self, which: Option<&str>) -> Result<&View, SceneError> {
        let scene = || error::one_line(&self.name);
        let Some(first) = self.cameras.first() else { return Err(self.no_camera()) };
        let Some(which) = which else { return Ok(first) };
        let by_name = self.cameras.iter().find(|v| v.name == which);
        let by_index = || which.parse::<usize>().ok().and_then(|i| self.cameras.get(i));
        by_name.or_else(by_index).ok_or_else(|| {
            let known: Vec<_> = self.cameras.iter().enumerate().map(|(i, v)| format!("{i} {:?}", v.name)).collect();
            SceneError::UnknownCamera { scene: scene(), name: which.to_owned(), known: known.join(", ") }
        })
    }

    /// A camera file beside the scene is named, not taken: a folder may hold several views.
    fn no_camera(&self) -> SceneError {
        let source = Path::new(&self.name);
        let own = source.with_extension("camera.json");
        let files = [own, source.with_file_name("camera.json")];
        let beside = files.iter().find(|file| !self.name.starts_with(SCHEME) && View::from_file(file).is_ok());
        SceneError::NoCamera {
            scene: error::one_line(&self.name),
            beside: beside.map(|file| error::one_line(&file.to_string_lossy())),
        }
    }

    /// Counts and checks what has been built.
    fn new(
        name: String,
        builder: Builder,
        origin: DVec3,
        cameras: Vec<View>,
        warnings: Vec<Warning>,
        mut info: Info,
    ) -> Result<Self, SceneError> {
        info.count(&builder);
        info.cameras = cameras.len();
        let mut data = builder.data;
        data.cameras = cameras.iter().map(|v| v.camera(origin, 512, 512)).collect::<Result<_, _>>()?;
        data.validate().map_err(|e| error::At { file: &name }.malformed("the scene", e.to_string()))?;
        Ok(Self { name, data, origin, cameras, size: None, warnings, info })
    }
}
