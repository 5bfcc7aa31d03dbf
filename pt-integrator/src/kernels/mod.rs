//! Path tracing as kernels: from pixels to records or film, from film to an image.
//!
//! | kernel | parameters | bindings |
//! |---|---|---|
//! | [`TRACE_FILM`], [`TRACE_MOMENTS`], [`TRACE_PAIRS`] | [`TraceParams`] | triangles, scene, texels, film (out), counters |
//! | [`trace_records`] | [`TraceParams`] | triangles, scene, texels, records (out), counters |
//! | [`trace_visible`] | [`VisibleParams`] | triangles, scene, texels, records (out), counters |
//! | [`ANSWER_TRACED`] | none | records, estimates (out) |
//! | [`FIRST_VERTICES`] | [`FirstParams`] | kept records, records (out) |
//! | [`RESOLVE`], [`RESOLVE_MOMENTS`] | none | film, radiance (out) |
//!
//! Item i of a batch is pixel `first_pixel + i` of the picture, counted by rows from the upper left; element i of
//! every per-item binding belongs to it ([`TRACE_PAIRS`]: to the pixel that the element names; [`trace_records`] of s vertices and [`trace_visible`] of s layers: an element of s
//! records). Triangles, scene and
//! texels are the buffers of [`crate::packed`]; counters are the words of [`RayCounts`](crate::path::RayCounts).

mod answer;
mod first;
mod params;
mod resolve;
mod shared;
mod trace;
mod visible;

pub use answer::ANSWER_TRACED;
pub use first::{FIRST_VERTICES, FirstParams};
pub use params::TraceParams;
pub use resolve::{RESOLVE, RESOLVE_MOMENTS};
pub use trace::{TRACE_FILM, TRACE_MOMENTS, TRACE_PAIRS, TRACE_RECORDS, trace_records};
pub use visible::{TRACE_VISIBLE, VisibleParams, trace_visible};
