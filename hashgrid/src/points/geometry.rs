//! Where the points are, in integers.

use hashcache_core::hash::pcg4d;
use hashcache_core::level::MAX_LEVEL;

use super::POINT_BIN;
use crate::key::{Key, coarser, finer, fixed, footprint_level, lowest_level, origin_shift};
use crate::params::{CELL_BITS, Params};

/// A place among the cubes of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spot {
    /// Level of the cubes, whose edge is [`Params::cell_size`].
    pub level: u32,
    /// Coordinates in 256ths of a cube, from the world's origin, rounded down.
    pub fixed: [i32; 3],
}

/// A point as seen from a spot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Point {
    /// The key that its light is kept under.
    pub owner: Key,
    /// From the spot to the point, in 512ths of an edge of the spot's cubes.
    pub offset: [i32; 3],
}

/// The spot of a place, on the level of its footprint; `None` as for [`crate::key::key`].
///
/// # Units
/// `place`: position and footprint in metres.
#[inline]
pub fn point_spot(params: &Params, place: [f32; 4]) -> Option<Spot> {
    let [x, y, z, footprint] = place.map(f32::to_bits);
    let magnitude = |v: u32| v & 0x7fff_ffff;
    let largest = magnitude(x).max(magnitude(y)).max(magnitude(z));
    let lowest = lowest_level(largest, params.base_exponent());
    if largest.max(magnitude(footprint)) >= 0x7f80_0000 || lowest > MAX_LEVEL as i32 {
        return None;
    }
    let [level, _] = footprint_level(params.footprint_in_cells(footprint), lowest);
    let scale = CELL_BITS as i32 - params.base_exponent() - level;
    Some(Spot { level: level as u32, fixed: [fixed(x, scale), fixed(y, scale), fixed(z, scale)] })
}

impl Spot {
    /// The spot among the cubes of the next level; `None` on the coarsest.
    #[must_use]
    pub fn coarser(self) -> Option<Self> {
        (self.level < MAX_LEVEL).then(|| Self { level: self.level + 1, fixed: self.fixed.map(|v| v >> 1) })
    }
}

/// The cube that holds a spot.
#[inline]
pub const fn point_cube(spot: Spot) -> Key {
    let ([x, y, z], shift) = (spot.fixed, origin_shift(spot.level));
    let cell = [(x + shift) >> CELL_BITS, (y + shift) >> CELL_BITS, (z + shift) >> CELL_BITS];
    Key { cell, attributes: spot.level | (POINT_BIN << 8) }
}

/// Which octant of a cube its point lies in: a bit each for the upper half in x, y, z.
#[inline]
pub const fn point_pick(cube: Key) -> u32 {
    let [x, y, z] = cube.cell;
    pcg4d([x as u32, y as u32, z as u32, cube.attributes])[0] >> 29
}

/// The coarsest cube whose point is that of `cube`: seven of eight cubes are their own.
#[inline]
pub const fn point_owner(cube: Key) -> Key {
    let mut own = cube;
    while let Some(above) = coarser(&own) {
        let [x, y, z] = own.cell;
        let octant = (x & 1) | ((y & 1) << 1) | ((z & 1) << 2);
        if point_pick(above) != octant as u32 {
            break;
        }
        own = above;
    }
    own
}

/// Where the point of a cube lies in it, in 256ths of its edge: the picks of eight levels below it, or where the levels
/// end before, a hash of the last cube. The same point in another of its cubes is at the same place of the world up to
/// two 256ths of the larger cube.
#[inline]
#[must_use]
pub const fn point_place(cube: Key) -> [i32; 3] {
    let (mut inner, mut place) = (cube, [0; 3]);
    let mut bits = CELL_BITS;
    while bits > 0 {
        let octant = point_pick(inner);
        let Some(below) = finer(&inner, octant) else { break };
        bits -= 1;
        place[0] |= ((octant & 1) << bits) as i32;
        place[1] |= (((octant >> 1) & 1) << bits) as i32;
        place[2] |= (((octant >> 2) & 1) << bits) as i32;
        inner = below;
    }
    let [x, y, z] = inner.cell;
    let rest = pcg4d([x as u32, y as u32, z as u32, inner.attributes]);
    let unused = CELL_BITS - bits;
    place[0] |= ((rest[1] >> 24) >> unused) as i32;
    place[1] |= ((rest[2] >> 24) >> unused) as i32;
    place[2] |= ((rest[3] >> 24) >> unused) as i32;
    place
}

/// From a spot to the point of a cube, in 512ths: `at` is the spot [inside](point_inside) its own cube, `delta` the way
/// from that one to `cube`.
#[inline]
#[must_use]
pub const fn point_offset(at: [i32; 3], delta: [i32; 3], cube: Key) -> [i32; 3] {
    let ([x, y, z], [a, b, c], [u, v, w]) = (delta, at, point_place(cube));
    [512 * x + 2 * u + 1 - a, 512 * y + 2 * v + 1 - b, 512 * z + 2 * w + 1 - c]
}

/// The square of an offset, below 2²⁶ for the points that [`point_nearest`] looks at.
#[inline]
pub const fn distance_squared(offset: [i32; 3]) -> u32 {
    let [x, y, z] = offset;
    (x * x + y * y + z * z) as u32
}

/// How far a spot is from a cube at least, squared, in 512ths; arguments as of [`point_offset`].
#[inline]
pub const fn cube_distance(at: [i32; 3], delta: [i32; 3]) -> u32 {
    let ([x, y, z], [a, b, c]) = (delta, at);
    distance_squared([beyond(a, x), beyond(b, y), beyond(c, z)])
}

/// How far `at` is from the `delta`-th 512 steps, along one axis.
#[inline]
const fn beyond(at: i32, delta: i32) -> i32 {
    let low = 512 * delta - at;
    if low > 0 {
        low
    } else if low < -512 {
        low + 512
    } else {
        0
    }
}

/// The spot inside its own cube, in 512ths.
#[inline]
#[must_use]
pub const fn point_inside(spot: Spot) -> [i32; 3] {
    let ([x, y, z], shift) = (spot.fixed, origin_shift(spot.level));
    [2 * ((x + shift) & 255) + 1, 2 * ((y + shift) & 255) + 1, 2 * ((z + shift) & 255) + 1]
}

/// The three points nearest to a spot, nearest first, among those of the 27 voxels of 2×2×2 cubes around it.
///
/// # Source
/// Delaere 2021, `GetGeneratedSample`.
#[inline]
#[must_use]
pub const fn point_nearest(spot: Spot) -> [Point; 3] {
    let (cube, at) = (point_cube(spot), point_inside(spot));
    let mut points = [Point { owner: cube, offset: [0; 3] }; 3];
    let mut distances = [u32::MAX; 3];
    let lowest = point_neighbour(cube, 0);
    // First the 27 cubes around the spot, which leave little to do for the others.
    let mut pass = 0;
    while pass < 2 {
        let mut index = 0;
        while index < 216 {
            let delta = [lowest[0] + index % 6, lowest[1] + (index / 6) % 6, lowest[2] + index / 36];
            let [x, y, z] = [beyond(at[0], delta[0]), beyond(at[1], delta[1]), beyond(at[2], delta[2])];
            // Slabs and rows that are too far are passed by as a whole.
            if index % 36 == 0 && (z * z) as u32 >= distances[2] {
                index += 36;
                continue;
            }
            if index % 6 == 0 && (y * y + z * z) as u32 >= distances[2] {
                index += 6;
                continue;
            }
            index += 1;
            if (reach(delta) > 1) != (pass == 1) || (x * x + y * y + z * z) as u32 >= distances[2] {
                continue;
            }
            let [cx, cy, cz] = cube.cell;
            let other = Key { cell: [cx + delta[0], cy + delta[1], cz + delta[2]], attributes: cube.attributes };
            let offset = point_offset(at, delta, other);
            let distance = distance_squared(offset);
            if distance >= distances[2] {
                continue;
            }
            let place = (distance >= distances[0]) as usize + (distance >= distances[1]) as usize;
            let mut k = 2;
            while k > place {
                points[k] = points[k - 1];
                distances[k] = distances[k - 1];
                k -= 1;
            }
            points[place] = Point { owner: other, offset };
            distances[place] = distance;
        }
        pass += 1;
    }
    let [a, b, c] = points;
    [
        Point { owner: point_owner(a.owner), ..a },
        Point { owner: point_owner(b.owner), ..b },
        Point { owner: point_owner(c.owner), ..c },
    ]
}

/// The way to the `index`-th of the 6×6×6 cubes of the 27 voxels around the voxel of `cube`.
#[inline]
#[must_use]
pub const fn point_neighbour(cube: Key, index: i32) -> [i32; 3] {
    let [x, y, z] = cube.cell;
    [index % 6 - 2 - (x & 1), (index / 6) % 6 - 2 - (y & 1), index / 36 - 2 - (z & 1)]
}

/// The largest of three magnitudes.
#[inline]
const fn reach(delta: [i32; 3]) -> i32 {
    let [x, y, z] = [delta[0].abs(), delta[1].abs(), delta[2].abs()];
    let larger = if x > y { x } else { y };
    if larger > z { larger } else { z }
}

/// Which of three points at these squared distances is drawn: each with a probability in proportion to 1/distance².
/// `random`: any 32 bits. Distances count from 1; probabilities are exact to 2⁻¹².
///
/// # Source
/// Delaere 2021, `GetIndexByProbability` (which is this, without saying so).
#[inline]
pub const fn point_choose(distances: [u32; 3], random: u32) -> u32 {
    let [a, b, c] = distances;
    let a = if a > 0 { a } else { 1 };
    // The nearest comes first: 2^s times its distance just fits, so the weights have as many bits as there are.
    let scaled = a << a.leading_zeros();
    let weights =
        [(scaled / a) >> 2, (scaled / if b > 0 { b } else { 1 }) >> 2, (scaled / if c > 0 { c } else { 1 }) >> 2];
    let draw = high_product(random, weights[0] + weights[1] + weights[2]);
    (draw >= weights[0]) as u32 + (draw >= weights[0] + weights[1]) as u32
}

/// ⌊a·b/2³²⌋ from halves, as WGSL has no wider product.
#[inline]
const fn high_product(a: u32, b: u32) -> u32 {
    let ([al, ah], [bl, bh]) = ([a & 0xffff, a >> 16], [b & 0xffff, b >> 16]);
    let middle = ah * bl + ((al * bl) >> 16);
    let other = al * bh + (middle & 0xffff);
    ah * bh + (middle >> 16) + (other >> 16)
}

/// The random bits of a spot: equal places draw alike.
#[inline]
pub const fn point_draw(spot: Spot, seed: u32) -> u32 {
    let [x, y, z] = spot.fixed;
    pcg4d([x as u32, y as u32, z as u32, seed ^ (spot.level << 27)])[2]
}
