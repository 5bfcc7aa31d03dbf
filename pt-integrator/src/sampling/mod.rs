//! Directions and points by probability, each beside its density.

mod basis;
mod cosine;
mod mis;
mod triangle;

pub use basis::Basis;
pub use cosine::{cosine_pdf, sample_cosine};
pub use mis::power_heuristic;
pub use triangle::sample_triangle;
