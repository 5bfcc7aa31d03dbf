//! What the points have gathered, interpolated.

use hashcache_core::counters::Counters;
use hashcache_core::exact::Quantum;
use hashcache_core::float::sqrt;
use hashcache_core::glam::Vec3;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::Estimate;

use super::geometry::{
    Spot, cube_distance, distance_squared, point_cube, point_inside, point_neighbour, point_offset, point_owner,
    point_spot,
};
use crate::key::Key;
use crate::layout::Layout;
use crate::params::Params;
use crate::table::Table;
use crate::vertex::own_value;

/// A voxel's edge, two cubes, in the 512ths that offsets are in.
const VOXEL: f32 = 1024.0;

/// Light at every vertex, in order: `answer(i, estimate)`: the mean of the points within `radius` voxels, weighted by
/// count·(radius − distance). Where no point within the radius has light, the next `coarser` levels are asked, with a
/// radius twice as large each; failing them, the vertex answers for itself, with 0 samples.
///
/// # Units
/// `radius` in voxels, two cubes wide; 0 to 1, outside of which it is cut (the 27 voxels hold no more; NaN counts as 1).
///
/// # Source
/// Delaere 2021, `WorldSpaceShepardInterpolationSingleLevel`; Shepard 1968.
pub fn estimate_vertices<L: Layout>(
    table: &Table<'_, L>,
    params: &Params,
    vertices: &[VertexRecord],
    radius: f32,
    coarser: u32,
    counters: &mut Counters,
    mut answer: impl FnMut(usize, Estimate),
) {
    let radius = if radius < 1.0 { radius.max(0.0) } else { 1.0 } * VOXEL;
    for (i, vertex) in vertices.iter().enumerate() {
        if !vertex.is_valid() {
            answer(i, own_value(vertex, counters));
            continue;
        }
        counters.lookups += 1;
        let mut spot = point_spot(params, vertex.position_footprint);
        let mut found = None;
        for up in 0..=coarser {
            let Some(at) = spot else { break };
            found = interpolate(table, params.quantum(), at, radius, counters);
            if found.is_some() {
                counters.coarser += u64::from(up > 0);
                break;
            }
            spot = at.coarser();
        }
        match found {
            Some(_) => counters.hits += 1,
            None => counters.fallbacks += 1,
        }
        answer(i, found.unwrap_or_else(|| own_value(vertex, counters)));
    }
}

/// The weighted mean around a spot; `None` where no point within the radius has light.
fn interpolate<L: Layout>(
    table: &Table<'_, L>,
    quantum: Quantum,
    spot: Spot,
    radius: f32,
    counters: &mut Counters,
) -> Option<Estimate> {
    let (cube, at) = (point_cube(spot), point_inside(spot));
    let reach = (radius * radius) as u32;
    let (mut light, mut weights, mut samples) = ([0.0_f64; 6], 0.0_f64, 0_u32);
    for index in 0..216 {
        let delta = point_neighbour(cube, index);
        if cube_distance(at, delta) >= reach {
            continue;
        }
        let [x, y, z] = cube.cell;
        let other = Key { cell: [x + delta[0], y + delta[1], z + delta[2]], attributes: cube.attributes };
        // Most cubes are empty space: the table is asked before the point is placed.
        counters.probes += 1;
        let Some(slot) = table.find_named(&point_owner(other)) else { continue };
        let sums = table.sums(slot);
        let near = radius - sqrt(distance_squared(point_offset(at, delta, other)) as f32);
        if near <= 0.0 || sums.count == 0 {
            continue;
        }
        weights += f64::from(near) * f64::from(sums.count);
        samples = samples.saturating_add(sums.count);
        for (to, sum) in light.iter_mut().zip(sums.light) {
            *to += f64::from(near) * sum as f64;
        }
    }
    if weights <= 0.0 {
        return None;
    }
    let mean = light.map(|sum| (sum / weights) as f32 * quantum.quantum());
    let [a, b, c, d, e, f] = mean;
    Some(Estimate { direct: Vec3::new(a, b, c), further: Vec3::new(d, e, f), samples, variance: 0.0 })
}
