//! Lookups: what an octree's cells say about a path vertex.

use glam::Vec3;

use super::block::cell_bit;
use super::cell::{CellRecord, Side};
use super::cells::ReadCells;
use super::deposit::{BATCH, side_of};
use super::params::{JITTER_BITS, Light, OctreeParams};
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
/// The mean comes as [`Estimate::further`], whatever light it is; [`Estimate::direct`] is 0. A vertex for which no
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
        // Each step is a loop of its own: only so close together do its misses overlap.
        let mut questions = [None; BATCH];
        let mut cells_asked = [[u32::MAX; 3]; BATCH];
        for ((to, cell), vertex) in questions.iter_mut().zip(&mut cells_asked).zip(batch) {
            if vertex.is_valid() {
                let question = Question::new(octree, params, factor, vertex);
                *cell = question.jittered(octree, question.first).unwrap_or([u32::MAX; 3]);
                *to = Some(question);
            }
        }
        let mut entries = [None; BATCH];
        for ((entry, cell), question) in entries.iter_mut().zip(cells_asked).zip(&questions) {
            *entry = question.as_ref().and_then(|question| octree.place(question.first, cell));
        }
        let mut indices = [None; BATCH];
        for ((index, entry), cell) in indices.iter_mut().zip(entries).zip(cells_asked) {
            *index = entry.and_then(|entry| octree.entry(entry).index(cell_bit(cell)));
        }
        let mut found = [None; BATCH];
        for (to, index) in found.iter_mut().zip(indices) {
            *to = index.map(|index| cells.get(index));
        }
        for (i, ((vertex, question), first)) in batch.iter().zip(questions).zip(found).enumerate() {
            let estimate = match question {
                None => Estimate { direct: Vec3::ZERO, further: Vec3::ZERO, samples: 0 },
                Some(question) => estimate_vertex(octree, cells, params, vertex, &question, first, counters),
            };
            answer(b * BATCH + i, estimate);
        }
    }
}

#[inline]
fn estimate_vertex<C: CellRecord>(
    octree: &Octree<'_>,
    cells: &(impl ReadCells<C> + ?Sized),
    params: &OctreeParams,
    vertex: &VertexRecord,
    question: &Question,
    first: Option<C>,
    counters: &mut Counters,
) -> Estimate {
    counters.lookups += 1;
    let side = |cell: &C| side_in(params, cell, vertex.normal);
    let read = |level: u32, cell: Option<[u32; 3]>| octree.cell(level, cell?).map(|cell| cells.get(cell));
    let mut best = Blend::new(params.shrinkage());
    let last = (question.nearest + params.max_climb()).min(octree.grid().levels - 1);
    for level in question.first..=last {
        let jittered = if level == question.first { first } else { read(level, question.jittered(octree, level)) };
        counters.probes += u64::from(jittered.is_some());
        let mut here = jittered.map_or(Side::default(), |cell| side(&cell));
        if here.count == 0 {
            if let Some(cell) = read(level, question.plain(octree, level)) {
                counters.probes += 1;
                here = side(&cell);
            }
        }
        best.add(&here, level);
        if best.most >= params.min_samples() {
            break;
        }
    }
    if best.most == 0 {
        counters.fallbacks += 1;
        return Estimate { direct: Vec3::ZERO, further: own_light(params, vertex, counters), samples: 0 };
    }
    counters.hits += 1;
    counters.coarser += u64::from(best.level > question.nearest);
    Estimate { direct: Vec3::ZERO, further: best.mean(), samples: best.samples }
}

/// What a lookup makes of the levels it reads, finest first.
struct Blend {
    shrinkage: f32,
    /// Weighted sum so far, the weight that is left for coarser levels, and the mean of the coarsest level read.
    sum: Vec3,
    left: f32,
    coarsest: Vec3,
    /// Most samples of a level so far.
    most: u32,
    /// Samples and level of the answer.
    samples: u32,
    level: u32,
}

impl Blend {
    #[inline]
    const fn new(shrinkage: f32) -> Self {
        Self { shrinkage, sum: Vec3::ZERO, left: 1.0, coarsest: Vec3::ZERO, most: 0, samples: 0, level: 0 }
    }

    /// With shrinkage k, a side of n samples keeps the share n/(n+k) of what finer ones left; without, the side with the
    /// most samples has it all.
    #[inline]
    fn add(&mut self, side: &Side, level: u32) {
        if side.count == 0 {
            return;
        }
        let mean = Vec3::from_array(side.mean);
        if self.shrinkage == 0.0 {
            if side.count > self.most {
                (self.coarsest, self.samples, self.level) = (mean, side.count, level);
            }
        } else {
            if self.most == 0 {
                (self.samples, self.level) = (side.count, level);
            }
            let share = side.count as f32 / (side.count as f32 + self.shrinkage);
            self.sum += mean * (self.left * share);
            self.left *= 1.0 - share;
            self.coarsest = mean;
        }
        self.most = self.most.max(side.count);
    }

    #[inline]
    fn mean(&self) -> Vec3 {
        self.sum + self.coarsest * self.left
    }
}

/// The side of a cell that a normal points to; empty when the cell was not touched since the last wipe.
#[inline]
fn side_in<C: CellRecord>(params: &OctreeParams, cell: &C, normal: u32) -> Side {
    if cell.wiped() == params.wiped() {
        cell.side(side_of(cell.normal(), normal), params.quantum())
    } else {
        Side::default()
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
