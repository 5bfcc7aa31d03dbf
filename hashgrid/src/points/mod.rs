//! Implicit progressive points: light kept at random points of space that nobody stores.
//!
//! Space is cut into *cubes* of one size a level. Every cube has one point in it, at a place that follows from hashes
//! alone, and the points of a level are among those of every finer level: going nearer adds points and moves none. A
//! vertex gives its light to one of the three points nearest to it, by chance, nearer ones more often ([`point_nearest`],
//! [`point_choose`]); what the points have gathered is interpolated at any place ([`estimate_vertices`]). The points' light
//! stands in an ordinary [`Table`] under the cube's key: a frame's, claimed and deposited as in [`crate::vertex`],
//! [merged](crate::merge) into a lasting one with the weight of at most a count ([`crate::temporal::FixedCount`]; the
//! other rules serve moving scenes).
//!
//! ```
//! use hashcache_core::{counters::Counters, record::VertexRecord};
//! use hashgrid::layout::{Layout, Minimal};
//! use hashgrid::{Params, Settings, Table, Word, points};
//!
//! let params = Params::new(&Settings::default())?;
//! let storage = [const { Word::new(0) }; 64 * Minimal::WORDS];
//! let table = Table::<Minimal>::with_layout(&storage, &params)?;
//! table.clear();
//! let mut vertices = [VertexRecord { flags: VertexRecord::VALID, ..bytemuck::Zeroable::zeroed() }; 4];
//! for (i, vertex) in vertices.iter_mut().enumerate() {
//!     vertex.position_footprint = [0.001 * i as f32, 0.0, 0.0, 0.001];
//!     vertex.further = [0.5; 4];
//! }
//! let mut counters = Counters::default();
//! points::claim_vertices(&table, &params, &vertices);
//! points::deposit_vertices(&table, &params, &vertices, &mut counters);
//! points::estimate_vertices(&table, &params, &vertices, 1.0, 0, &mut counters, |_, estimate| {
//!     assert!((estimate.further.x - 0.5).abs() < 1e-6 && estimate.samples > 0);
//! });
//! # Ok::<(), hashcache_core::error::ParamError>(())
//! ```
//!
//! `examples/points.rs` is ambient occlusion by these points in one short program, `ambient_occlusion.rs` of the `hashcache`
//! crate the same in a scene from a file.
//!
//! # How the points nest
//! Each cube *picks* one of its eight octants by a hash. A cube's point lies in the octant it picked, and is the point
//! of that octant, too, which is a cube of the next finer level: so it lies in the octant that this one picked, and so
//! on. Uniform picks make uniform points, eight in a voxel of 2×2×2 cubes, one in each. The point belongs to the
//! coarsest cube whose point it is, its *owner*; light is kept under the owner's key and stays there when the level
//! changes.
//!
//! # Source
//! Delaere 2021, "Implicit point generation", "Updating data structures", "Visualization".
//!
//! # Deviation
//! Cubes are floors in two's complement and not truncated towards zero, which would mirror space about the origin. Points
//! are nested by picks instead of drawn anew on each level. The history's weight is bounded; the article's factor of
//! 0.9 scales new counts and bounds nothing. The three nearest are compared and drawn in integers.
//!
//! # Limits today
//! Points know no normal: what is nearer to a wall than the radius may take light from behind it. The way to the points
//! has WGSL bodies; deposits and interpolation are for the host.

mod geometry;
mod shepard;

pub use geometry::{
    Point, Spot, cube_distance, distance_squared, point_choose, point_cube, point_draw, point_inside, point_nearest,
    point_neighbour, point_offset, point_owner, point_pick, point_place, point_spot,
};
pub use shepard::estimate_vertices;

use hashcache_core::counters::Counters;
use hashcache_core::record::VertexRecord;

use crate::key::Key;
use crate::layout::{Keep, Layout};
use crate::names::Naming;
use crate::params::Params;
use crate::table::{Claim, Table};
use crate::vertex::deposit_under;

/// What stands for the normal's bin in the keys of points: none of a normal, so that points and cells may share a table.
pub const POINT_BIN: u32 = 2047;

/// The key of the point that a vertex at this place gives its light to; `None` when a coordinate or the footprint is NaN
/// or infinite, or beyond what [`crate::key::key`] accepts.
///
/// # Units
/// `place`: position and footprint in metres, as [`VertexRecord::position_footprint`].
#[must_use]
pub fn chosen(params: &Params, place: &[f32; 4]) -> Option<Key> {
    let spot = point_spot(params, *place)?;
    let points = point_nearest(spot);
    let index = point_choose(points.map(|point| distance_squared(point.offset)), point_draw(spot, params.seed()));
    Some(points[index as usize].owner)
}

fn chosen_by(params: &Params, vertex: &VertexRecord) -> Option<Key> {
    if vertex.is_recordable() { chosen(params, &vertex.position_footprint) } else { None }
}

/// Claims a cell for the point that each vertex gives its light to. True when some point was refused. Any number of
/// threads may claim parts of the same vertices.
pub fn claim_vertices<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord]) -> bool {
    let keys = vertices.iter().filter_map(|vertex| chosen_by(params, vertex));
    keys.fold(false, |refused, key| refused | (table.claim(&key) == Claim::Refused))
}

/// Names what was claimed; does nothing in layouts without keys. See [`crate::names`].
pub fn name_vertices<L: Layout>(table: &Table<'_, L>, params: &Params, vertices: &[VertexRecord], step: Naming) {
    if L::Kept::WORDS == 0 {
        return;
    }
    for key in vertices.iter().filter_map(|vertex| chosen_by(params, vertex)) {
        table.name(&key, step);
    }
}

/// Gives each vertex's light to the point that was claimed for it; what finds none is counted. Any number of threads may
/// deposit parts of the same vertices.
pub fn deposit_vertices<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    counters: &mut Counters,
) {
    for vertex in vertices.iter().filter(|vertex| vertex.is_recordable()) {
        deposit_under(table, params, chosen_by(params, vertex).as_ref(), vertex, counters);
    }
}
