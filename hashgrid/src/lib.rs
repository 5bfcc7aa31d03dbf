//! A jittered spatial hash of light path vertices (path space filtering).
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod jitter;
pub mod key;
pub mod params;
pub mod table;
pub mod tag;
pub mod validate;
pub mod vertex;
mod word;

#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
pub mod kernels;
#[cfg(feature = "alloc")]
mod owned;
#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
mod stages;

pub use key::Key;
#[cfg(feature = "alloc")]
pub use owned::OwnedGrid;
pub use params::{Params, Settings};
#[cfg(all(feature = "kernels", target_has_atomic = "64"))]
pub use stages::GridStages;
pub use table::{CELL_WORDS, Cell, Claim, Table};
pub use word::Word;
