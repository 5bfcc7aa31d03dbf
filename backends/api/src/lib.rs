//! Buffers, kernels and launches: the interface between hashcache's algorithms and the machines that run them.
//!
//! ```
//! use core::sync::atomic::{AtomicU32, Ordering};
//! use backend_api::{Access, BindingDecl, Kernel, Launch, Slot};
//!
//! /// `sums[i] = terms[i] + terms[i + 1]`, around the end.
//! static ADD: Kernel = Kernel {
//!     name: "toy.add",
//!     bindings: &[
//!         BindingDecl { name: "terms", access: Access::In, stride: 4 },
//!         BindingDecl { name: "sums", access: Access::OutPerItem, stride: 4 },
//!     ],
//!     params_size: 0,
//!     body: |launch: &mut Launch<'_>| {
//!         let terms = launch.input::<u32>(0);
//!         for (i, sum) in launch.items().zip(launch.output::<u32>(1)) {
//!             *sum = terms[i as usize] + terms[(i as usize + 1) % terms.len()];
//!         }
//!     },
//!     wgsl: None,
//!     casts_rays: false,
//! };
//! const _: () = assert!(ADD.is_well_formed());
//!
//! // What a backend does for one launch: items 1 and 2 of a dispatch.
//! let (terms, mut sums) = ([1, 20, 300, 4000], [0, 0]);
//! let slots = &mut [Slot::In(bytemuck::cast_slice(&terms)), Slot::Out(bytemuck::cast_slice_mut(&mut sums))];
//! let status = AtomicU32::new(0);
//! (ADD.body)(&mut Launch { first: 1, count: 2, params: &[], slots, status: &status, rays: None });
//! assert_eq!(sums, [320, 4300]);
//! ```
//!
//! # Concepts
//! - A [`Kernel`] is an algorithm's step as data: a name, a list of bindings, a Rust body over a range of items and,
//!   where a GPU runs it, a WGSL body. It knows no thread, no device, no allocator.
//! - [`Access`] says how items touch a buffer: read it, own an element each, or share words by atomics. That is enough
//!   for a launch to be safe on one thread, on many and on a GPU.
//! - A [`Launch`] is a range of items of one dispatch, as the Rust body sees it.
//! - A `Backend` owns buffers and launches kernels; it knows no algorithm. Dispatches are recorded, then submitted
//!   together; reads are claimed by ticket, since browsers cannot block.
//! - What kernels cannot say is a closed set of [`Primitive`]s.
//! - A [`Status`] word a dispatch tells what went wrong in it, and that it ran at all.
//! - [`check`] holds the rules for arguments, so that mistakes give the same [`Error`] on every backend.
//!
//! # Features
//! - `alloc`: `Backend`, `BufferTable` and `primitive::model`. Without it kernels can still be declared and launched
//!   by hand, as above.
//!
//! Targets without 64-bit atomics have no `Slot::AtomicU64`; everything else is the same there.
//!
//! # Memory
//! None of its own but `BufferTable`'s: what a backend keeps for a buffer and eight bytes a place.
//!
//! # Determinism
//! A body must give the same result however its dispatch is cut into launches. Integer results are then equal on every
//! backend and for any number of threads; float results are, where items write only their own elements.
//!
//! # Limits
//! At most five storage buffers a kernel, 2³² − 1 items a dispatch, and no textures.
//!
//! # Sources
//! The access modes and limits are those of WebGPU's default device (W3C, *WebGPU*, section 3.6.2).
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
