//! Path tracing: next-event estimation and scattering, weighted against each other, at every vertex.
//!
//! # Source
//! Kajiya 1986; Veach 1997 (multiple importance sampling, 9.2; Russian roulette, 10.4).

mod counts;
mod outcome;
mod settings;
mod trace;
mod visible;

pub use counts::RayCounts;
pub use outcome::PathOutcome;
pub use settings::{PathSettings, VertexSettings};
pub use trace::{MAX_STORED, trace_path, trace_path_for, trace_path_vertices};
pub use visible::{DirectSettings, Strategy, trace_visible};
