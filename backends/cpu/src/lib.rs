//! Serial and rayon launchers of hashcache kernels, and ray casting on the CPU.
//!
//! ```
//! use std::sync::atomic::Ordering;
//!
//! use backend_api::{Access, Backend, Binding, BindingDecl, BufferDesc, Items, Kernel, Launch};
//! use backend_cpu::CpuBackend;
//!
//! /// `bins[values[i] mod bins]` grows by 1.
//! static HISTOGRAM: Kernel = Kernel {
//!     name: "toy.histogram",
//!     bindings: &[
//!         BindingDecl { name: "values", access: Access::In, stride: 4 },
//!         BindingDecl { name: "bins", access: Access::AtomicU32, stride: 4 },
//!     ],
//!     params_size: 0,
//!     body: |launch: &mut Launch<'_>| {
//!         let (values, bins) = (launch.input::<u32>(0), launch.atomic_u32(1));
//!         for i in launch.items() {
//!             bins[values[i as usize] as usize % bins.len()].fetch_add(1, Ordering::Relaxed);
//!         }
//!     },
//!     wgsl: None,
//!     casts_rays: false,
//! };
//!
//! # fn main() -> Result<(), backend_api::Error> {
//! for mut backend in [CpuBackend::serial(), CpuBackend::rayon(2)?] {
//!     let values: Vec<u32> = (0..10_000).map(|i| i * i).collect();
//!     let input = backend.create(&BufferDesc { name: "values", size: 40_000 })?;
//!     let bins = backend.create(&BufferDesc { name: "bins", size: 16 })?;
//!     backend.write(input, 0, bytemuck::cast_slice(&values))?;
//!     let whole = |buffer, size| Binding { buffer, offset: 0, size };
//!     backend.dispatch(&HISTOGRAM, &[], &[whole(input, 40_000), whole(bins, 16)], Items::Count(10_000))?;
//!     backend.submit()?;
//!     let ticket = backend.read(bins, 0, 16)?;
//!     let counts = backend.redeem(ticket, true)?.unwrap();
//!     assert_eq!(bytemuck::pod_collect_to_vec::<u8, u32>(&counts), [5000, 5000, 0, 0]); // squares mod 4
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Concepts
//! - [`CpuBackend`] runs a dispatch as launches: ranges of items, one after the other on the calling thread
//!   ([`CpuBackend::serial`]) or stolen by idle threads of a pool of its own ([`CpuBackend::rayon`]). Launches have 256
//!   to 16,384 items, enough of them a thread that light items make up for heavy ones.
//! - A launch gets the bytes of each binding as its access mode says: shared, its own items' elements, or atomics.
//!   Buffers start on 64-byte borders, so a cell of 64 bytes lies in one cache line.
//! - [`rays`] casts rays against triangles; a kernel that declares `casts_rays` meets it through its launch, once
//!   geometry was given by [`hashcache_core::stages::CastsRays::set_geometry`].
//!
//! # Features
//! None.
//!
//! # Memory
//! A buffer takes its size, rounded up to 64 bytes. A dispatch takes under 200 bytes until it is submitted, beside its
//! parameters, and on a pool under 200 bytes a launch while it runs. Sorting `n` pairs takes 16·n bytes for
//! its time.
//!
//! # Determinism
//! Both launchers give equal bits, for any number of threads, for every kernel whose body keeps the rules of
//! [`backend_api::Launch`].
//!
//! # Limits
//! Targets need 64-bit atomics. Reads and writes copy: there is no way to borrow a buffer. A body that panics unwinds
//! out of [`backend_api::Backend::submit`]; what was recorded behind it does not run, and
//! [`backend_api::Backend::statuses`] says so.
//!
//! # Sources
//! The pool is rayon's.

mod backend;
mod launch;
mod primitives;
mod storage;

pub mod rays;

pub use backend::CpuBackend;
