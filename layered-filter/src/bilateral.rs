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
use crate::weights::{LuminanceWeight, WeightSettings, Weights};

/// Taps of a pixel beside its own. Laine & Karras 2011b use as many.
pub const TAPS: usize = 24;

/// Taps of each pass beside a [wide one](CrossBilateral::with_wide_pass), and of that itself: the first ones of the pattern,
/// themselves a spiral. Two passes of twelve reach as many pixels as one of 144 and cost what one of 24 does.
pub const TAPS_OF_TWO: usize = 12;

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
/// ([`CrossBilateral::with_radius_by_samples`]). With a [wide pass](CrossBilateral::with_wide_pass) there is one before the
/// others that looks farther and heeds what is significant. 1,696 bytes; [`Pod`], so that it is a kernel's parameter as it stands.
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
    /// The wide pass; its radius is 0 where there is none.
    wide: Weights,
    wide_radius: f32,
    wide_samples: f32,
    reserved: [u32; 2],
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
        let wide = weights;
        let mut pattern = [[0; TAPS]; TURNS];
        for (turn, taps) in pattern.iter_mut().enumerate() {
            for (k, tap) in taps.iter_mut().enumerate() {
                *tap = spiral(turn, k);
            }
        }
        let (wide_radius, wide_samples) = (0.0, 0.0);
        Ok(Self {
            weights,
            pattern,
            radius,
            samples: 0.0,
            passes,
            seed,
            wide,
            wide_radius,
            wide_samples,
            reserved: [0; 2],
        })
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

    /// The same with a pass before the others, of `radius` pixels (1 to [`MAX_RADIUS`]) or √(`samples`/c) where that is less (0:
    /// always `radius`), that compares pixels by [`LuminanceWeight::Significance`] of `deviations`; all else as in
    /// `weights`. For images whose variances are known: those of a cache that tells them.
    ///
    /// A cache's noise has the scale of its cells, which many pixels share: a mean over close neighbours leaves it as it
    /// is. So the taps of this pass are far apart, beyond a cell as a rule; the passes after it smooth what so few taps
    /// leave behind. All passes have [`TAPS_OF_TWO`] taps then.
    ///
    /// # Errors
    /// [`ParamError`] with the name of what is out of range.
    ///
    /// # Source
    /// Differences of light over their variance: Rousselle et al. 2012, section 4 (there between patches).
    pub fn with_wide_pass(
        mut self,
        weights: &WeightSettings,
        radius: f32,
        samples: f32,
        deviations: f32,
    ) -> Result<Self, ParamError> {
        ParamError::check_range("wide radius", f64::from(radius), 1.0, f64::from(MAX_RADIUS))?;
        ParamError::check_range("wide samples", f64::from(samples), 0.0, 1e9)?;
        let luminance = LuminanceWeight::Significance { scale: deviations };
        self.wide = Weights::new(&WeightSettings { luminance, ..*weights })?;
        (self.wide_radius, self.wide_samples) = (radius, samples);
        Ok(self)
    }

    /// Whether pass `pass` is the wide one.
    #[inline]
    const fn is_wide(&self, pass: u32) -> bool {
        pass == 0 && self.wide_radius > 0.0
    }

    /// Taps of a pass.
    #[inline]
    const fn tap_count(&self) -> usize {
        if self.wide_radius > 0.0 { TAPS_OF_TWO } else { TAPS }
    }

    /// The weights of the passes but the wide one.
    pub const fn weights(&self) -> &Weights {
        &self.weights
    }

    /// Radius in pass `pass` around a pixel with `support` samples behind its light (0: unknown), in pixels.
    #[inline]
    pub fn radius(&self, pass: u32, support: f32) -> f32 {
        let (radius, samples) =
            if self.is_wide(pass) { (self.wide_radius, self.wide_samples) } else { (self.radius, self.samples) };
        // False for NaN.
        if samples > 0.0 && support > 0.0 {
            // Not `clamp`: an infinite support gives √0.
            float::sqrt(samples / support).max(1.0).min(radius)
        } else {
            radius
        }
    }

    /// Offsets of the taps of pixel `(x, y)` in pass `pass` with `radius`; (0, 0) stands for none.
    #[inline]
    pub fn taps(&self, pass: u32, x: u32, y: u32, radius: f32) -> impl Iterator<Item = (i32, i32)> {
        let scale = self.scale(radius);
        self.pattern_of(pass, x, y).iter().map(move |tap| offset(*tap, scale))
    }

    #[inline]
    fn pattern_of(&self, pass: u32, x: u32, y: u32) -> &[u32] {
        let hash = pcg3d([x, y, self.seed.wrapping_add(pass)])[0];
        &self.pattern[hash as usize % TURNS][..self.tap_count()]
    }

    /// A radius in fixed point, such that the taps in use fill its disc.
    #[inline]
    const fn scale(&self, radius: f32) -> i32 {
        /// √(24/12).
        const FEWER: f32 = core::f32::consts::SQRT_2;
        let radius = if self.wide_radius > 0.0 { radius * FEWER } else { radius };
        (radius * (1 << RADIUS_BITS) as f32) as i32
    }
}

const _: () = assert!(TAPS == 2 * TAPS_OF_TWO, "the factor of `scale`");

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
        self.passes + u32::from(self.wide_radius > 0.0)
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
        let weights = if self.is_wide(pass) { &self.wide } else { &self.weights };
        let around = weights.luminance_of(luminance, own[3]);
        let mut mean = Mean::new(weights, guide, own, around);
        let radius = self.radius(pass, guide.support[0]);
        let scale = self.scale(radius);
        // No tap is farther, rounding included.
        let inner = view.is_inner(x, y, radius as u32 + 2);
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
