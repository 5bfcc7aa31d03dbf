//! Filters for noisy or cached illumination: pixels that show like surfaces share their light, bounce by bounce, and
//! what is filtered is light without albedo, so that textures stay sharp.
//!
//! ```
//! use bytemuck::Zeroable;
//! use hashcache_core::{glam::Vec3, pack::octahedral_encode, record::VertexRecord, traits::Estimate};
//! use layered_filter::{
//!     ATrous, Direct, GatherParams, GuideScale, LayerPixel, PreparedGuide, Taps, View, WeightSettings, filter,
//! };
//!
//! // Two pixels of a floor with another albedo each, lit alike but for noise.
//! let params = GatherParams::new(0.001, Direct::Estimate, 1, 1)?;
//! let mut pixels = [LayerPixel::zeroed(); 2];
//! for (pixel, (albedo, light)) in pixels.iter_mut().zip([(0.8, 0.75), (0.2, 1.25)]) {
//!     let vertex = VertexRecord {
//!         position_footprint: [0.0, 0.0, 0.0, 0.002],
//!         throughput: [albedo; 4],
//!         normal: octahedral_encode(Vec3::Y),
//!         flags: VertexRecord::VALID | VertexRecord::VISIBLE_ONLY,
//!         ..VertexRecord::zeroed()
//!     };
//!     let further = Vec3::splat(light);
//!     pixel.add(&params, &vertex, &Estimate { direct: Vec3::ZERO, further, samples: 1, variance: 0.0 });
//! }
//! let scale = GuideScale::new(10.0)?;
//! let guides = pixels.each_ref().map(|pixel| PreparedGuide::of_pixel(&scale, pixel));
//! let mut image = pixels.each_ref().map(LayerPixel::further_light);
//! let denoiser = ATrous::new(&WeightSettings::surface(0.001), Taps::Nine, 1)?;
//! filter(&denoiser, &View::new(2, 1, &guides).unwrap(), &mut image, &mut [[0.0; 4]; 2]);
//!
//! // A neighbour counts half: (0.75 + 1.25/2) / 1.5. The floor's tiles are as they were.
//! assert!((image[0][0] - 0.9167).abs() < 1e-4 && (image[1][0] - 1.0833).abs() < 1e-4);
//! assert!((pixels[0].mean_throughput().x * image[0][0] - 0.7333).abs() < 1e-4);
//! # Ok::<(), hashcache_core::error::ParamError>(())
//! ```
//!
//! # Concepts
//! - **Sums** ([`LayerPixel`]): what a pixel's samples told, added up: illumination times throughput, throughput, guides,
//!   counts. The ratio of the first two is the pixel's *illumination*, light without albedo.
//! - **Noise** ([`NoisePixel`]): the standard error of a pixel before the filter, from the same sums.
//! - **Guides** ([`GuideRecord`], [`PreparedGuide`]): the vertex that a pixel shows in one layer: normal, place, lengths,
//!   albedo, shininess.
//! - **Weights** ([`WeightSettings`]): how much one pixel's light says about another's, a product of terms that fall with the
//!   difference of their guides. [`WeightSettings::PAPER`] are those of the paper's equations 2 to 6,
//!   [`WeightSettings::surface`] those with the least error on a cache's light.
//! - **Denoiser**: a trait; one call is one pixel of one pass, a pure function. [`CrossBilateral`] has 24 taps in a turned
//!   sparse disc whose radius may follow the number of samples behind a pixel; [`ATrous`] is an edge-avoiding wavelet.
//! - **Wide pass** ([`CrossBilateral::with_wide_pass`]): what a cache answers is noisy at the scale of its cells, many
//!   pixels wide. Where it tells the variance of its answers, a pass of half the taps first mixes pixels far apart that
//!   differ by no more than their noise, and leaves differences that are significant alone.
//! - **Holes**: vertices that a cache had no answer for. They are filled from like neighbours and counted ([`mod@fill`]).
//! - **Layers** ([`layers`]): the deepest bounce is filtered first, carried to the vertex in front, and so on. A mirror's
//!   picture is so filtered by what is seen in it. [`compose_screen`] is the same with the first vertex's guides only.
//! - **Fronts** ([`mod@front`]): vertices that a pixel looks through. Light that passes a rough lobe is filtered once more
//!   with its front's guides; what passes a mirror or clear glass is not. `FilterStages` composes so: records hold
//!   throughput from the camera, so layers only add up.
//!
//! Start at [`layers`] for plain functions over slices, `FilterStages` for launchers; implement [`Denoiser`] to bring a
//! filter of your own. `examples/mirror.rs` sends a renderer's own layers through the filter.
//!
//! # Features
//! - `alloc`: nothing here yet; passed on to the core.
//! - `kernels`: the `kernels` module and `FilterStages`; on targets with 64-bit atomics. Implies `alloc`.
//!
//! Without features nothing allocates and all images are the caller's slices.
//!
//! # Memory
//! | per pixel | bytes |
//! |---|---|
//! | [`LayerPixel`], one a layer | 128 |
//! | [`FrontPixel`], one a layer that light passes and is filtered at | 48 |
//! | [`Behind`], with several layers | 32 |
//! | [`PreparedGuide`], one a layer | 64 |
//! | [`Light`], two an image for passes to read and write in turn | 16 |
//! | [`NoisePixel`], where errors are asked for | 8 |
//!
//! `FilterStages` holds 256 bytes a pixel, 272 with direct light apart: 1920×1080 pixels are 531 MB or 564 MB. Four
//! layers behind mirrors and glass are 672 bytes, 848 where some lobes are rough.
//!
//! # Determinism
//! A pixel depends on its own sums in their order and on the pass before; any split into rows or threads gives the same
//! bits. + − × ÷ √ and integers only, and libm where guides are made, so the bits are the same on every processor.
//!
//! # Limits today
//! - Guides are means over a pixel's samples: a pixel that shows two surfaces resembles neither and mixes with few.
//! - Each pass takes its values for independent, so the variance that it passes on is too small where noise is shared:
//!   after a first pass, and between pixels that read one cache cell. So only a first pass may rely on it: the wide one.
//! - The wide pass keeps differences of light that are significant. What is not, it blurs: a faint shadow in a cache's first
//!   frames comes out with the frames after.
//! - Whether a sample goes on by reflection or by refraction is noise that no layer filters: it is in the throughput.
//! - Sums are f32: 10⁵ samples are exact to about 10⁻⁵.
//! - Light above 2¹⁰⁰ counts as none. No WGSL twins yet.
//!
//! # Sources
//! Keys of `REFERENCES.md`: Roth et al. 2020, section 3.4 (layers, weights); Laine & Karras 2011b (sparse taps); Vogel 1979
//! (their spiral); Rousselle et al. 2012 (differences over their variance); Dammertz et al. 2010 and Schied et al. 2017 (wavelet, variance).
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod atrous;
pub mod bilateral;
pub mod denoiser;
pub mod fill;
pub mod front;
pub mod guide;
pub mod image;
#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
pub mod kernels;
pub mod lab;
pub mod layers;
pub mod log;
mod mean;
pub mod noise;
pub mod pixel;
#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
mod stages;
pub mod weights;

pub use atrous::{ATrous, Taps};
pub use bilateral::CrossBilateral;
pub use denoiser::{Denoiser, filter, filter_pixels};
pub use front::{Behind, Carry, FrontPixel};
pub use guide::{GuideRecord, GuideScale, PreparedGuide};
pub use image::{HOLE, Light, View};
pub use layers::{Layer, Scratch, compose_layers, compose_screen};
pub use noise::NoisePixel;
pub use pixel::{Direct, GatherParams, LayerPixel};
#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
pub use stages::{Composition, Filter, FilterSettings, FilterStages, MAX_LAYERS};
pub use weights::{LuminanceWeight, WeightSettings, Weights};
