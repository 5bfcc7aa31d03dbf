//! Materials at a point: what they do with light, by lobes.
//!
//! ```
//! use hashcache_core::glam::{Vec2, Vec3};
//! use pt_integrator::bsdf::{Bsdf, BsdfInputs, Lobe};
//!
//! // Smooth glass, seen from straight above: 4 % is reflected, 96 % goes in.
//! let glass = BsdfInputs { roughness: 0.0, specular: 1.0, transmission: 1.0, thin: false, ..BsdfInputs::lambert(Vec3::ONE) };
//! let bsdf = Bsdf::new(&glass, Vec3::Y, Vec3::Y, true);
//! let reflected = bsdf.sample(Lobe::Reflection, Vec2::ZERO).unwrap();
//! assert!((reflected.weight.x - 0.04).abs() < 1e-6 && reflected.incoming == Vec3::Y);
//! let passed = bsdf.sample(Lobe::Transmission, Vec2::ZERO).unwrap();
//! assert!((passed.weight.x * passed.eta * passed.eta - 0.96).abs() < 1e-6 && passed.incoming == Vec3::NEG_Y);
//! ```
//!
//! # Model
//! With n·v for the cosine between normal and view, n·l for that of the light, h for the microfacet:
//!
//! | lobe | f |
//! |---|---|
//! | diffuse | base/π · (1 − metallic)(1 − transmission) · (1 − F(n·v))(1 − F(n·l)) |
//! | reflection | F(v·h)·D·G₂ / (4 n·v n·l), F the mix of dielectric and metal, GGX with α = roughness² |
//! | transmission | base · (1 − metallic)·transmission · (1 − F(v·h)), refracted by microfacets of the same α; straight through, with the microfacets' blur, when thin |
//! | coat | c·F₁.₅(v·h)·D·G₂ / (4 n·v n·l), with its own normal and α |
//!
//! What lies under the coat is multiplied by (1 − c·F₁.₅(n·v))(1 − c·F₁.₅(n·l)); a solid has its coat on the outside.
//! F is exact; a lobe whose α is below 2⁻¹⁰ is a delta lobe.
//!
//! A diffuse lobe without reflection above it is Lambert's, with the same bits: its throughput is the base color, and
//! its weight 1.
//!
//! # Energy
//! No surface reflects and passes more light than it gets. Light that microfacets reflect among themselves, that the
//! interface throws back on the diffuse lobe, or that the coat throws back, is lost. Seen from above: 8 % for white metal
//! of roughness 0.5 and 69 % of roughness 1; a tenth for a white dielectric. The tests print tables.
//!
//! # Sources
//! glTF 2.0, appendix B; glTF material extensions; Walter et al. 2007; Heitz 2014; Dupuy & Benyoub 2023; Eto &
//! Tokuyoshi 2023; Schlick 1994.
//!
//! # Deviation
//! From appendix B: the diffuse lobe is separable, so that a cache may hold its light without knowing the viewer;
//! dielectrics reflect exactly rather than by Schlick's approximation.

mod eval;
mod fresnel;
mod inputs;
mod lobe;
mod microfacet;
mod pick;
mod resolve;
mod sample;

pub use fresnel::{fresnel_dielectric, schlick_weight};
pub(crate) use fresnel::{kept_index, relative_index};
pub use inputs::BsdfInputs;
pub use lobe::{BsdfSample, Lobe, LobePick};
pub use resolve::{Bsdf, SMALLEST_ALPHA};
