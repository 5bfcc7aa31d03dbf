//! A cross-bilateral filter with few taps: the paper's denoiser.

use bytemuck::{Pod, Zeroable};
use hashcache_core::error::ParamError;
use hashcache_core::float;
use hashcache_core::glam::Vec4;
use hashcache_core::hash::pcg3d;

use crate::denoiser::Denoiser;
#[cfg(doc)]
use crate::guide::PreparedGuide;
use crate::image::{Light, View, is_hole, luminance_of};
use crate::mean::{Mean, add_at};
use crate::weights::{WeightSettings, Weights};

/// Taps of a pixel beside its own. Laine & Karras 2011b use as many.
pub const TAPS: usize = 24;

/// Turned copies of the pattern, of which a hash picks one for each pixel: enough that noise takes the place of stripes.
pub const TURNS: usize = 16;

/// A tap's coordinates on the unit disc are multiples of 2⁻¹⁵, radii multiples of 2⁻⁷ pixels: their products are exact in
/// 32 bits, so offsets are integers without a float between.
const UNIT: f32 = 32_767.0;
const RADIUS_BITS: u32 = 7;
const PRODUCT_BITS: u32 = 15 + RADIUS_BITS;

/// The largest radius in pixels; farther taps leave the caches of processors without finding like surfaces.
pub const MAX_RADIUS: f32 = 256.0;

/// A cross-bilateral filter: one mean over [`TAPS`] pixels in a sparse disc around each pixel, weighted by guides and
/// luminance.
///
/// Taps stand on a golden-angle spiral, k-th at r·√((k+0.7)/24), turned by one of [`TURNS`] angles that a hash of
/// pixel, pass and seed picks. The radius r is fixed, or follows the number of samples behind a pixel's light
/// ([`CrossBilateral::with_radius_by_samples`]). 1,632 bytes; [`Pod`], so that it is a kernel's parameter as it stands.
///
/// # Source
/// Roth et al. 2020, section 3.4; the sparse turned pattern after Laine & Karras 2011b, section 5.4; the spiral after
/// Vogel 1979 (Deviation: neither paper gives its pattern).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CrossBilateral {
    weights: Weights,
    pattern: [[u32; TAPS]; TURNS],
    radius: f32,
    samples: f32,
    passes: u32,
    seed: u32,
}

impl CrossBilateral {
    /// A filter of `passes` passes (1 to 8), each with taps up to `radius` pixels away (1 to [`MAX_RADIUS`]).
    ///
    /// # Errors
    /// [`ParamError`] with the name of what is out of range.
    pub fn new(weights: &WeightSettings, radius: f32, passes: u32, seed: u32) -> Result<Self, ParamError> {
        ParamError::check_range("radius", f64::from(radius), 1.0, f64::from(MAX_RADIUS))?;
        ParamError::check_range("passes", f64::from(passes), 1.0, 8.0)?;
        let weights = Weights::new(weights)?;
        let mut pattern = [[0; TAPS]; TURNS];
        for (turn, taps) in pattern.iter_mut().enumerate() {
            for (k, tap) in taps.iter_mut().enumerate() {
                *tap = spiral(turn, k);
            }
        }
        Ok(Self { weights, pattern, radius, samples: 0.0, passes, seed })
    }

    /// The same with a radius of √(`samples`/c) pixels, at least 1 and at most the radius given, where c is the number of
    /// samples behind the pixel's light ([`PreparedGuide::support`]): the area of the disc makes up for what the cache
    /// lacks, and a cache that is full is left alone. 0 keeps the radius fixed, and so does an unknown c.
    ///
    /// # Errors
    /// [`ParamError`] when `samples` is not between 0 and 10⁹.
    pub fn with_radius_by_samples(mut self, samples: f32) -> Result<Self, ParamError> {
        ParamError::check_range("samples", f64::from(samples), 0.0, 1e9)?;
        self.samples = samples;
        Ok(self)
    }

    /// The weights.
    pub const fn weights(&self) -> &Weights {
        &self.weights
    }

    /// Radius around a pixel with `support` samples behind its light (0: unknown), in pixels.
    #[inline]
    pub fn radius(&self, support: f32) -> f32 {
        // False for NaN.
        if self.samples > 0.0 && support > 0.0 {
            // Not `clamp`: an infinite support gives √0.
            float::sqrt(self.samples / support).max(1.0).min(self.radius)
        } else {
            self.radius
        }
    }

    /// Offsets of the taps of pixel `(x, y)` in pass `pass` with `radius`; (0, 0) stands for none.
    #[inline]
    pub fn taps(&self, pass: u32, x: u32, y: u32, radius: f32) -> impl Iterator<Item = (i32, i32)> {
        let scale = fixed(radius);
        self.pattern_of(pass, x, y).iter().map(move |tap| offset(*tap, scale))
    }

    #[inline]
    fn pattern_of(&self, pass: u32, x: u32, y: u32) -> &[u32; TAPS] {
        let hash = pcg3d([x, y, self.seed.wrapping_add(pass)])[0];
        &self.pattern[hash as usize % TURNS]
    }
}

/// A radius in fixed point.
#[inline]
fn fixed(radius: f32) -> i32 {
    (radius * (1 << RADIUS_BITS) as f32) as i32
}

/// A tap's offset in pixels, to the nearest.
#[inline]
fn offset(tap: u32, scale: i32) -> (i32, i32) {
    let nearest = |unit: i32| (unit * scale + (1 << (PRODUCT_BITS - 1))) >> PRODUCT_BITS;
    (nearest(i32::from(tap as i16)), nearest((tap as i32) >> 16))
}

/// The k-th tap of a turned pattern on the unit disc: x in the low 16 bits, y in the high ones.
fn spiral(turn: usize, k: usize) -> u32 {
    /// π·(3 − √5) radians.
    const GOLDEN_ANGLE: f32 = 2.399_963_1;
    let angle = k as f32 * GOLDEN_ANGLE + turn as f32 * (core::f32::consts::TAU / TURNS as f32);
    let (sin, cos) = float::sin_cos(angle);
    let r = UNIT * float::sqrt((k as f32 + 0.7) / TAPS as f32);
    let (x, y) = (float::round(r * cos) as i32, float::round(r * sin) as i32);
    (x as u32 & 0xffff) | ((y as u32) << 16)
}

impl Denoiser for CrossBilateral {
    fn passes(&self) -> u32 {
        self.passes
    }

    #[inline]
    fn pixel(&self, pass: u32, view: &View<'_>, input: &[Light], x: u32, y: u32) -> Light {
        let guides = view.guides();
        let p = y as usize * view.width() as usize + x as usize;
        let (own, guide) = (&input[p], &guides[p]);
        if !guide.has_vertex() {
            return *own;
        }
        let luminance = (!is_hole(own)).then(|| luminance_of(own));
        let around = self.weights.luminance_of(luminance, own[3]);
        let mut mean = Mean::new(&self.weights, guide, own, around);
        let scale = fixed(self.radius(guide.support[0]));
        // No tap is farther, rounding included.
        let inner = view.is_inner(x, y, (scale as u32 >> RADIUS_BITS) + 1);
        for four in self.pattern_of(pass, x, y).as_chunks::<4>().0 {
            let at = four.map(|tap| {
                let (dx, dy) = offset(tap, scale);
                if inner {
                    (p as isize + dy as isize * view.width() as isize + dx as isize) as usize
                } else {
                    view.neighbour(x, y, dx, dy).unwrap_or(p)
                }
            });
            // The pixel itself counts already.
            let factor = Vec4::from_array(at.map(|q| if q == p { 0.0 } else { 1.0 }));
            add_at(&mut mean, guides, input, at, factor);
        }
        mean.finish().unwrap_or(*own)
    }
}
