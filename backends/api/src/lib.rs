//! Buffers, kernels and launches: the interface between hashcache's algorithms and the machines that run them.
//!
//! An algorithm is a [`Kernel`]: a name, a list of bindings, a Rust body over a range of items and, where a GPU
//! runs it, a WGSL body. A [`Backend`] owns buffers and launches kernels; it knows no algorithm.
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;

mod backend;
mod buffer;
pub mod check;
mod error;
mod kernel;
mod launch;
pub mod primitive;
mod rays;
mod status;
#[cfg(feature = "alloc")]
mod table;

#[cfg(feature = "alloc")]
pub use backend::Backend;
pub use backend::{Items, Ticket};
pub use buffer::{Binding, BufferDesc, BufferId};
pub use error::Error;
pub use kernel::{Access, BindingDecl, Kernel, Wgsl};
pub use launch::{Launch, Slot};
pub use primitive::Primitive;
pub use rays::{HitRecord, RayRecord, TraceRays};
pub use status::Status;
#[cfg(feature = "alloc")]
pub use table::BufferTable;
