//! Path tracing: next-event estimation and scattering, weighted against each other, at every vertex.
//!
//! # Source
//! Kajiya 1986; Veach 1997 (multiple importance sampling, 9.2; Russian roulette, 10.4).

mod counts;
mod direct;
mod kept;
mod medium;
mod outcome;
mod scatters;
mod settings;
mod step;
mod trace;
mod visible;

pub use counts::RayCounts;
pub use direct::{DirectSettings, Strategy};
pub use outcome::PathOutcome;
pub use settings::{PathSettings, VertexSettings};
pub use trace::{MAX_STORED, trace_path, trace_path_vertices};
pub use visible::{MAX_LAYERS, VisibleSettings, trace_visible};
