//! Runs hashcache kernels on a GPU through wgpu.
//!
//! [`WgpuBackend`] implements [`backend_api::Backend`]: buffers on the device, recorded dispatches, a status word for
//! each of them, read-back by ticket, and the primitives. It shares the caller's [`wgpu::Device`] and [`wgpu::Queue`]
//! ([`WgpuBackend::new`]) or opens its own ([`WgpuBackend::open`]). It knows no algorithm.
//!
//! ```
//! use backend_api::{Backend, BufferDesc, Error, Primitive};
//! use backend_wgpu::{AdapterChoice, WgpuBackend};
//!
//! let mut backend = match WgpuBackend::open(AdapterChoice::Fastest) {
//!     Err(Error::NoAdapter) => return Ok(()), // no GPU here
//!     other => other?,
//! };
//! let flags = backend.create(&BufferDesc { name: "flags", size: 16 })?;
//! let indices = backend.create(&BufferDesc { name: "indices", size: 16 })?;
//! let kept = backend.create(&BufferDesc { name: "kept", size: 4 })?;
//! backend.write(flags, 0, bytemuck::cast_slice(&[1_u32, 0, 0, 1]))?;
//! backend.primitive(Primitive::Compact { flags, indices, kept, count: 4 })?;
//! backend.submit()?;
//! let ticket = backend.read(indices, 0, 8)?;
//! let bytes = backend.redeem(ticket, true)?.expect("waited for");
//! assert_eq!(bytemuck::pod_collect_to_vec::<u8, u32>(&bytes), [0, 3]);
//! # Ok::<(), Error>(())
//! ```
//!
//! # What a kernel's WGSL finds
//! The backend puts `wgsl/launch.wgsl` and `wgsl/prelude.wgsl` ([`PRELUDE`]) before a kernel's modules:
//! - `hc_launch`, uniform binding 13: `hc_launch.count` is the number of items, from the host or from a buffer
//! - `hc_item(gid, groups)`: the invocation's item, from `global_invocation_id` and `num_workgroups`; one whose item is
//!   not below `hc_launch.count` has nothing to do. Every invocation of an entry point calls it: item 0 reports that
//!   the dispatch ran. Workgroups are one-dimensional; beyond 65 535 of them the launch is folded into rows
//! - `hc_raise(flags)`: raises flags in the dispatch's status word, storage binding 15
//!
//! The modules declare `@group(0) @binding(k)` for the kernel's buffer `k` (`var<storage, read>` for
//! [`backend_api::Access::In`], `read_write` for the others) and the parameters as uniform binding 14.
//!
//! # Item counts from a buffer
//! [`backend_api::Items::FromBuffer`] becomes an indirect dispatch: a kernel of one invocation reads the word, bounds
//! it, and writes the number of items and of workgroups before the dispatch starts. The host waits for nothing.
//!
//! # Errors
//! Errors of the device are caught by error scopes at each call and come back as [`backend_api::Error`];
//! [`WgpuBackend::message`] holds the device's own words. A dispatch that did not run leaves its status word at
//! "not run", and a read-back from a lost device is an error, so neither can pass for zeros.
//!
//! # Memory
//! Beside the buffers created: 256 bytes a recorded dispatch (512 with parameters), 4 bytes a status word, a staging
//! copy of each range asked for, and scratch for the primitives, kept between calls: `count` words plus 1/512 for a
//! compaction, 4 × `count` words for a sort, 5 × `count` for a reduction by key.
//!
//! # Limits today
//! Kernels that cast rays, and kernels without WGSL, are [`backend_api::Error::Unsupported`]. The tables of a kernel
//! end at the device's largest binding ([`backend_api::Backend::max_binding_size`], 128 MiB by default).

mod backend;
mod open;
mod pipeline;
mod primitives;
mod readback;
mod recording;
mod scope;

pub use backend::WgpuBackend;
pub use open::AdapterChoice;
pub use pipeline::PRELUDE;
