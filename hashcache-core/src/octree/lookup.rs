//! Lookups: what an octree's cells say about a path vertex.

use glam::Vec3;

use super::block::cell_bit;
use super::cell::{CellRecord, Side};
use super::cells::ReadCells;
use super::merge::{BATCH, side_of};
use super::params::{JITTER_BITS, Light, OctreeParams};
use super::scatter::{Scatter, luminance};
use super::view::Octree;
use crate::counters::Counters;
use crate::hash::pcg3d;
use crate::jitter::{draw, tangent_offset};
use crate::level::level_from_footprint;
use crate::pack::octahedral_decode_int;
use crate::record::VertexRecord;
use crate::traits::Estimate;

/// Salt of the draws of a lookup.
pub const SALT_LOOKUP: u32 = 0x7f4a_7c15;

/// What a lookup asks for, and where.
#[derive(Clone, Copy)]
struct Question {
    position: Vec3,
    /// Offset in the tangent plane, in 256ths of a cell of any level.
    offset: Vec3,
    /// The level nearest the footprint.
    nearest: u32,
    /// Where to begin.
    first: u32,
}

impl Question {
    const NONE: Self = Self { position: Vec3::ZERO, offset: Vec3::ZERO, nearest: 0, first: 0 };

    #[inline]
    fn new(octree: &Octree<'_>, params: &OctreeParams, factor: f32, vertex: &VertexRecord) -> Self {
        let [x, y, z, footprint] = vertex.position_footprint;
        let [a, b, c] = pcg3d([vertex.seed, params.seed(), SALT_LOOKUP]);
        let (u, v) = (draw(a >> 16, params.jitter()), draw(b >> 16, params.jitter()));
        let offset = tangent_offset(octahedral_decode_int(vertex.normal), u, v);
        let nearest = level_with(footprint * factor, params.level_jitter(), c).min(octree.grid().levels - 1);
        Self {
            position: Vec3::new(x, y, z),
            offset: Vec3::from_array(offset.map(|v| v as f32)),
            nearest,
            first: nearest.saturating_sub(params.finer()),
        }
    }

    /// The cell of a level at the jittered position, whether it is stored or not.
    #[inline]
    fn jittered(&self, octree: &Octree<'_>, level: u32) -> Option<[u32; 3]> {
        let step = octree.grid().cell_size(level) * (1.0 / (1 << JITTER_BITS) as f32);
        cell_at(octree, self.position + self.offset * step, level)
    }

    /// The cell of a level at the vertex itself.
    #[inline]
    fn plain(&self, octree: &Octree<'_>, level: u32) -> Option<[u32; 3]> {
        cell_at(octree, self.position, level)
    }
}

#[inline]
fn cell_at(octree: &Octree<'_>, p: Vec3, level: u32) -> Option<[u32; 3]> {
    Some(octree.coordinates(p)?.map(|c| c >> level))
}

/// ⌊log₂ `size` + `share`·u⌋ for a u in 0..1 from `random`; the logarithm is taken as linear between powers of two.
#[inline]
fn level_with(size: f32, share: u32, random: u32) -> u32 {
    let bits = size.to_bits();
    // From infinity on, what is added would make a NaN of it.
    if bits >= 0x7f80_0000 {
        return level_from_footprint(size, 1.0);
    }
    // At most 2¹⁶·(2¹⁶ − 1)/2⁹ = 2²³.
    let added = ((u64::from(share) * u64::from(random >> 16)) >> 9) as u32;
    level_from_footprint(f32::from_bits(bits + added), 1.0)
}

/// Illumination at every vertex, in order: `answer(i, estimate)`.
///
/// The level's cells are nearest to the footprint times the settings' cell size, as a ratio; the cell is the one that
/// holds the vertex after it was moved at random in its tangent plane, or the vertex itself where there is none or it is
/// empty; the side is the one that the vertex's normal points to. While the side has too few samples, the next coarser
/// level is asked the same. Without shrinkage the most samples found win. With shrinkage k, each level's mean of n samples
/// weighs n against k of the level above, from the coarsest one read down: the estimate of a mean by its few samples and
/// what is known about its surroundings (James & Stein 1961), without a border where the level changes.
///
/// The mean comes as [`Estimate::further`], whatever light it is; [`Estimate::direct`] is 0. [`Estimate::variance`] is that
/// of the mean's luminance: the variance of single samples, as the coarsest level read tells it (the others' fewer
/// samples say more about luck), over the samples that the levels' weights make use of. Layouts that keep no scatter
/// take samples for as noisy as those of path traced light are as a rule: a standard deviation of twice the mean. A vertex for which no
/// samples were found is a *hole*: it gets the light of its own that the cache would have recorded (0 for
/// [`VertexRecord::VISIBLE_ONLY`]), with 0 samples, NaN and infinite channels replaced by 0; counted as a fallback.
/// A vertex without [`VertexRecord::VALID`] gets 0, uncounted.
pub fn estimate_vertices<C: CellRecord>(
    octree: &Octree<'_>,
    cells: &(impl ReadCells<C> + ?Sized),
    params: &OctreeParams,
    vertices: &[VertexRecord],
    counters: &mut Counters,
    mut answer: impl FnMut(usize, Estimate),
) {
    let factor = octree.grid().recip_cell * params.cell_factor();
    for (b, batch) in vertices.chunks(BATCH).enumerate() {
        let mut asked = [Question::NONE; BATCH];
        let mut blends = [const { Blend::NONE }; BATCH];
        let mut open = [0; BATCH];
        let mut count = 0;
        for (i, vertex) in batch.iter().enumerate().filter(|(_, vertex)| vertex.is_valid()) {
            asked[i] = Question::new(octree, params, factor, vertex);
            open[count] = i;
            count += 1;
        }
        counters.lookups += count as u64;
        let mut step = 0;
        while count > 0 {
            count = ask_level(octree, cells, params, batch, &asked, step, &mut open[..count], &mut blends, counters);
            step += 1;
        }
        for (i, vertex) in batch.iter().enumerate() {
            let estimate = if vertex.is_valid() {
                conclude(params, vertex, &asked[i], &blends[i], counters)
            } else {
                Estimate { direct: Vec3::ZERO, further: Vec3::ZERO, samples: 0, variance: 0.0 }
            };
            answer(b * BATCH + i, estimate);
        }
    }
}

/// Asks the level `step` above each open question's first one. Returns how many questions stay open; their indices come
/// first in `open`.
#[expect(clippy::too_many_arguments, reason = "one call, all of them borrowed from the caller")]
fn ask_level<C: CellRecord>(
    octree: &Octree<'_>,
    cells: &(impl ReadCells<C> + ?Sized),
    params: &OctreeParams,
    batch: &[VertexRecord],
    asked: &[Question; BATCH],
    step: u32,
    open: &mut [usize],
    blends: &mut [Blend; BATCH],
    counters: &mut Counters,
) -> usize {
    // Finding and reading are loops of their own: only so close together do their misses overlap.
    let mut places = [None; BATCH];
    for (place, &i) in places.iter_mut().zip(open.iter()) {
        let level = asked[i].first + step;
        let cell = asked[i].jittered(octree, level);
        *place = cell.and_then(|cell| Some((octree.place(level, cell)?, cell_bit(cell))));
    }
    let mut indices = [None; BATCH];
    for (index, place) in indices.iter_mut().zip(places) {
        *index = place.and_then(|(place, bit)| octree.entry(place).index(bit));
    }
    let mut here = [Found::default(); BATCH];
    for ((to, index), &i) in here.iter_mut().zip(indices).zip(open.iter()) {
        if let Some(cell) = index {
            *to = side_in(params, &cells.get(cell), batch[i].normal);
            counters.probes += 1;
        }
    }
    let top = octree.grid().levels - 1;
    let mut kept = 0;
    for k in 0..open.len() {
        let i = open[k];
        let (question, level) = (&asked[i], asked[i].first + step);
        let mut side = here[k];
        if side.side.count == 0 {
            let cell = question.plain(octree, level).and_then(|cell| octree.cell(level, cell));
            if let Some(cell) = cell {
                counters.probes += 1;
                side = side_in(params, &cells.get(cell), batch[i].normal);
            }
        }
        blends[i].add(params.shrinkage(), &side, level);
        let last = (question.nearest + params.max_climb()).min(top);
        if blends[i].most < params.min_samples() && level < last {
            open[kept] = i;
            kept += 1;
        }
    }
    kept
}

/// The answer to a question whose levels are all read.
#[inline]
fn conclude(
    params: &OctreeParams,
    vertex: &VertexRecord,
    question: &Question,
    blend: &Blend,
    counters: &mut Counters,
) -> Estimate {
    if blend.most == 0 {
        counters.fallbacks += 1;
        let further = own_light(params, vertex, counters);
        return Estimate { direct: Vec3::ZERO, further, samples: 0, variance: 0.0 };
    }
    counters.hits += 1;
    counters.coarser += u64::from(blend.level > question.nearest);
    Estimate { direct: Vec3::ZERO, further: blend.mean(), samples: blend.samples, variance: blend.variance() }
}

/// What a lookup makes of the levels it reads, finest first.
struct Blend {
    /// Weighted sum so far, the weight that is left for coarser levels, and the mean of the coarsest level read.
    sum: Vec3,
    left: f32,
    coarsest: Vec3,
    /// What the levels' shares make of the variance of a sample, and of which level that is taken.
    noise: Scatter,
    /// Most samples of a level so far.
    most: u32,
    /// Samples and level of the answer.
    samples: u32,
    level: u32,
}

impl Blend {
    const NONE: Self =
        Self { sum: Vec3::ZERO, left: 1.0, coarsest: Vec3::ZERO, noise: Scatter::NONE, most: 0, samples: 0, level: 0 };

    /// With shrinkage k, a side of n samples keeps the share n/(n+k) of what finer ones left; without, the side with the
    /// most samples has it all.
    #[inline]
    fn add(&mut self, shrinkage: f32, found: &Found, level: u32) {
        let side = &found.side;
        if side.count == 0 {
            return;
        }
        let mean = Vec3::from_array(side.mean);
        let relative = Scatter::relative(luminance(mean), found.scatter, side.count);
        if shrinkage == 0.0 {
            if side.count > self.most {
                (self.coarsest, self.samples, self.level) = (mean, side.count, level);
                self.noise = Scatter::NONE;
                self.noise.add(0.0, luminance(mean), relative, side.count);
            }
        } else {
            if self.most == 0 {
                (self.samples, self.level) = (side.count, level);
            }
            let share = side.count as f32 / (side.count as f32 + shrinkage);
            self.sum += mean * (self.left * share);
            self.noise.add(self.left * share, luminance(mean), relative, side.count);
            self.left *= 1.0 - share;
            self.coarsest = mean;
        }
        self.most = self.most.max(side.count);
    }

    #[inline]
    fn mean(&self) -> Vec3 {
        self.sum + self.coarsest * self.left
    }

    /// The variance of the mean's luminance.
    #[inline]
    fn variance(&self) -> f32 {
        self.noise.variance(self.left)
    }
}

/// A side that a lookup found.
#[derive(Clone, Copy, Default)]
struct Found {
    side: Side,
    /// Root mean square of its luminance, where the layout keeps it.
    scatter: Option<f32>,
}

/// The side of a cell that a normal points to; empty when the cell was not touched since the last wipe.
#[inline]
fn side_in<C: CellRecord>(params: &OctreeParams, cell: &C, normal: u32) -> Found {
    if cell.wiped() == params.wiped() {
        let side = side_of(octahedral_decode_int(cell.normal()), normal);
        Found { side: cell.side(side, params.quantum()), scatter: cell.root_mean_square(side) }
    } else {
        Found::default()
    }
}

/// What a vertex would have given to the cache.
fn own_light(params: &OctreeParams, vertex: &VertexRecord, counters: &mut Counters) -> Vec3 {
    if !vertex.is_recordable() {
        return Vec3::ZERO;
    }
    let mut finite = |v: [f32; 4]| {
        Vec3::from_array([v[0], v[1], v[2]].map(|c| {
            counters.non_finite += u64::from(!c.is_finite());
            if c.is_finite() { c } else { 0.0 }
        }))
    };
    let further = finite(vertex.further);
    match params.light() {
        // Two large numbers may overflow together.
        Light::All => (finite(vertex.direct) + further).min(Vec3::splat(f32::MAX)),
        Light::Further => further,
    }
}
