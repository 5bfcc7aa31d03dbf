//! Path tracing that records its vertices: camera, samplers, BSDFs, lights.
//!
//! ```
//! use hashcache_core::geometry::{Hit, Ray};
//! use hashcache_core::glam::{Vec2, Vec3};
//! use hashcache_core::traits::RayCaster;
//! use pt_integrator::packed::PackedScene;
//! use pt_integrator::path::{PathSettings, RayCounts, trace_path};
//! use pt_integrator::sampler::{Sobol, pixel_seed};
//! use pt_integrator::scene::{Environment, SceneData};
//!
//! /// Any ray caster will do; this one has nothing to meet.
//! struct Nothing;
//! impl RayCaster for Nothing {
//!     fn closest(&self, _: &Ray) -> Option<Hit> { None }
//!     fn occluded(&self, _: &Ray) -> bool { false }
//! }
//! let scene = SceneData { environment: Some(Environment::Constant([0.5, 1.0, 2.0])), ..SceneData::default() };
//! let packed = PackedScene::new(&scene)?;
//! let ray = Ray { origin: Vec3::ZERO, t_min: 0.0, direction: Vec3::Y, t_max: f32::MAX };
//! let (mut sampler, mut counts) = (Sobol::new(0, pixel_seed(0, 1)), RayCounts::default());
//! let path = trace_path(&packed.view(), &Nothing, &mut sampler, &ray, &PathSettings::default(), &mut counts);
//! assert_eq!(path.radiance(), Vec3::new(0.5, 1.0, 2.0));
//! # Ok::<(), pt_integrator::scene::SceneError>(())
//! ```
//!
//! # Concepts
//! - A [`scene::SceneData`] is what a loader builds. [`packed::PackedScene`] turns it into three buffers, with the
//!   tables of its emitters; a [`view::SceneView`] borrows them. Nothing is copied or allocated while tracing.
//! - [`path::trace_path`] traces one path with any ray caster and sampler and returns a [`path::PathOutcome`]: the
//!   first vertex that scatters diffusely, and the path's light split into `emitted`, `direct` and `further`, so that
//!   radiance = emitted + throughput·(direct + further). `direct` and `further` hold no albedo of the vertex.
//! - [`path::trace_path_vertices`] keeps up to eight vertices of a path, each with the light that the rest of the path
//!   brings to it: more for a cache from the same rays. [`path::trace_visible`] finds what a pixel shows, behind mirrors
//!   and glass too, with direct light only: what a pixel asks a cache with, in layers.
//! - A surface has up to four lobes ([`bsdf`]): diffuse, reflection, transmission, clear coat. At each vertex one is
//!   chosen by its expected share of light and followed alone. Only the diffuse lobe's light is for caches; all others
//!   lead on, whatever their roughness.
//! - Every vertex samples one emitter (next event) and one direction (scattering); both are weighted by the power
//!   heuristic. ([`path::DirectSettings`] has other numbers.) Triangles and punctual lights are chosen by power through
//!   an alias table, points on triangles by area, directions to an environment image in proportion to its bilinear
//!   luminance. A constant environment is found by scattering alone, which is in proportion to it; a punctual light by
//!   next event alone.
//! - Surfaces reflect on both sides; the side is that of the shading normal. Emitters shine from the triangle's front,
//!   or from both sides when their material says so. Without an emission texture they shade with the triangle's own
//!   normal; with one, a triangle's power is estimated from the texels it shows, and black ones are no emitters.
//! - Textures are bilinear, decoded before filtering, transformed, from one of two sets of coordinates. Normal maps
//!   stand on the triangle's own tangents; a normal that would face away is turned until it faces the viewer.
//! - Solids absorb by Beer's law along the path. Shadow rays do not pass glass: light through it is found by following
//!   lobes, which rough glass makes easy and small lamps behind smooth glass hard.
//! - [`scene::Needs`] says which features a scene uses; the loop is compiled once for each set that Lambertian scenes
//!   may have, and once for all others. What is compiled in changes no bit of a picture.
//! - [`kernels`](self#features) wrap the functions for a backend: pixels → film, pixels → records, pixels → vertices
//!   that ask, film → image.
//!
//! # Features
//! None by default: tracing over borrowed slices. `alloc`: scenes and packing. `kernels`: kernels for
//! `hashcache-backend-api`, and WGSL.
//!
//! # Memory
//! 80 bytes a triangle (24 more with second texture coordinates), 112 an instance, 160 a material, 48 a texture, 4 a
//! texel, 88 an emitting triangle (92 in a scene with emission textures), 72 a punctual light, 21 a texel of an
//! environment image; 32 bytes a pixel of film. Packing takes 8 bytes a texel of one emission texture at a time. A
//! million triangles at 1920×1080: 80 MB and 66 MB.
//!
//! # Determinism
//! A path depends on (seed, pixel, sample) and the scene only. A pixel's film depends on the order of its own samples
//! only. The same bits for any number of threads and any cut into launches.
//!
//! # Limits today
//! Paths start at the camera only, so light that a mirror or glass gathers on a surface (caustics) is found by chance,
//! and that of punctual lights not at all. Of solids within solids only the one entered last absorbs. At most 2³¹
//! pixels, 2³² triangles, and what the backend binds. Surfaces that are nearer to each other than 2⁻¹⁸ of their
//! coordinates are not told apart. Numbers are of 24 bits: of more than 2²⁴ emitting triangles some are never chosen by
//! next event. The kernels have host bodies only.
//!
//! # Sources
//! Keys of `REFERENCES.md`: Kajiya 1986, Veach 1997 (light transport), Burley 2020, Laine & Karras 2011,
//! Ahmed 2024, Jarzynski & Olano 2020 (samplers), Duff et al. 2017 (basis), Shirley & Chiu 1997, Heitz 2019, Vose 1991,
//! Pharr et al. 2023, Chao 1982 (sampling), Chen & Asau 1974, Crow 1984, Talbot et al. 2005, Möller & Trumbore 1997,
//! glTF light extension (emitters), glTF 2.0 (textures, normal maps), Roth et al. 2020 (several vertices of a path,
//! layers), Wächter & Binder 2019 (ray origins), Kahan 1965 (film); those of materials stand in [`bsdf`].
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;

pub mod bsdf;
pub mod camera;
pub mod film;
#[cfg(feature = "kernels")]
pub mod kernels;
pub mod light;
pub mod packed;
pub mod path;
pub mod ray;
pub mod sampler;
pub mod sampling;
pub mod scene;
pub mod surface;
pub mod texture;
pub mod view;
#[cfg(feature = "kernels")]
pub mod wgsl;

pub use hashcache_core::glam;
