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
//! - **Surfaces** are glTF's metallic-roughness materials with the extensions below. What has no effect is left out: a
//!   metal has no inside, a texture of a factor 0 is not even decoded, and a surface with metallic 0, specular factor 0 and
//!   no transmission is a Lambertian one, whatever its roughness. Reflection is two-sided. Emission is emissive factor ×
//!   strength × texture, from the front (counter-clockwise) side unless the material is double-sided; emitters without a
//!   texture are shaded by their triangles' own normals. A texture that is black everywhere emits nothing.
//! - **Textures** hold 8 bits a channel. Colours (base colour, emission, specular colour) are decoded from sRGB before they
//!   are filtered, all others are linear. Textures of one image share its texels. A material reads two sets of
//!   coordinates; the base colour's is the first.
//! - **Holes.** Alpha masks are the ray caster's ([`pt_integrator::scene::OpacityData`]). A mask without holes is left out.
//!   Blended surfaces that are not opaque everywhere become, with a warning, thin sheets with sharp highlights where they
//!   are dielectrics without textures or coats, masks at 0.5 elsewhere.
//! - **Cameras** are pinholes with the file's vertical field of view; the picture's size gives the aspect ratio.
//!   A [`CameraPath`] is a move of one, read from a file of its own.
//!
//! # What is read
//! glTF 2.0 and GLB: nodes (matrix or translation, rotation, scale), meshes of triangles, strips and fans, `POSITION`,
//! `NORMAL`, any two `TEXCOORD_n` a material, PNG and JPEG images (files, buffer views, `data:`), all of the core's material
//! but occlusion, perspective cameras, and
//!
//! | extension | what is read |
//! |---|---|
//! | `KHR_lights_punctual` | points, spots, directions; 1 cd = 1 W/sr, 1 lx = 1 W/m²; range |
//! | `KHR_materials_clearcoat` | factor, roughness, normal map, textures |
//! | `KHR_materials_emissive_strength` | all |
//! | `KHR_materials_ior` | 0 stands for an infinite one, as 10⁴; all others are clamped to 1..10⁴ |
//! | `KHR_materials_specular` | factor, colour, textures |
//! | `KHR_materials_transmission` | factor, texture; thin-walled without a volume |
//! | `KHR_materials_unlit` | all |
//! | `KHR_materials_volume` | thickness above 0: a refracting solid; attenuation. The thickness itself is the mesh's |
//! | `KHR_mesh_quantization`, `KHR_texture_transform` | all |
//!
//! Files that the scene names lie in its folder or below; absolute paths, `..` and other URI schemes are refused. Sparse
//! accessors, mesh compression, images in KTX2, WebP, AVIF, DDS or Basis Universal and unknown required extensions are
//! refused by name.
//!
//! # Untrusted files
//! Every size, offset and index is checked before it is used, nothing is allocated for announced counts that the file
//! does not hold, nodes must form trees, and numbers that are not finite are errors. [`LoadOptions`] bounds memory.
//!
//! # Memory
//! 12 bytes a vertex, 60 a triangle (12 corners, 48 shading), 4 a texel; 24 more a triangle in a scene with second texture
//! coordinates, 28 in one with masks, and 1 a texel of a mask. While loading also the file's own bytes, its images' as far
//! as they are not decoded yet, on each thread what a decoder holds of one image (JPEG: 6 bytes a texel, 12 where it is
//! progressive; PNG: a few rows, 2–8 bytes a texel where it is interlaced), and 4–20 bytes a vertex and 12 a triangle of
//! the largest primitive. A million triangles over half a million vertices: 66 MB; sixteen images of 2048 × 2048: 268 MB.
//!
//! # Determinism
//! The same file gives the same lists, bit for bit, for any number of threads; of several errors, the same one.
//!
//! # Limits today
//! Each of these is named in a warning: blended alpha, vertex colours, occlusion and thickness textures, `TANGENT` (normal
//! maps stand in the frame of their texture coordinates), nearest filtering, a material's third set of coordinates, more
//! than 8 bits a channel, points and lines, orthographic cameras, skins, morph targets, animations, other extensions.
//!
//! # Sources
//! Khronos, glTF 2.0 specification (2.0.1) and the extensions named above. [`CameraPath`]: Catmull & Rom 1974, Barry &
//! Goldman 1988. The Cornell box: Goral et al. 1984, in RGB as in Mitsuba 3.

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
pub use info::{Extension, Info, Surfaces};
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
