//! A cross-bilateral filter with few taps: the paper's denoiser.

use bytemuck::{Pod, Zeroable};
use hashcache_core::error::ParamError;
use hashcache_core::float;
use hashcache_core::hash::pcg3d;

use crate::denoiser::{Denoiser, Mean};
use crate::image::{Light, View, is_hole, luminance_of};
use crate::weights::{WeightSettings, Weights};

/// Taps of a pixel beside its own. Laine & Karras 2011b use as many.
pub const TAPS: usize = 24;

/// Turned copies of the pattern, of which a hash picks one for each pixel: enough that noise takes the place of stripes.
pub const TURNS: usize = 16;

/// The largest radius in pixels; farther taps leave the caches of processors without finding like surfaces.
pub const MAX_RADIUS: f32 = 256.0;

/// A cross-bilateral filter: one mean over [`TAPS`] pixels in a sparse disc around each pixel, weighted by guides and
/// luminance.
///
/// Taps stand on a golden-angle spiral, k-th at radius·√((k+½)/24), turned by one of [`TURNS`] angles that a hash of
/// pixel, pass and seed picks. 1,616 bytes; [`Pod`], so that it is a kernel's parameter as it stands.
///
/// # Source
/// Roth et al. 2020, section 3.4; the sparse turned pattern after Laine & Karras 2011b, section 5.4; the spiral after
/// Vogel 1979 (Deviation: neither paper gives its pattern).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CrossBilateral {
    weights: Weights,
    pattern: [[u32; TAPS]; TURNS],
    passes: u32,
    seed: u32,
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
        let mut pattern = [[0; TAPS]; TURNS];
        for (turn, taps) in pattern.iter_mut().enumerate() {
            for (k, tap) in taps.iter_mut().enumerate() {
                *tap = spiral(radius, turn, k);
            }
        }
        Ok(Self { weights, pattern, passes, seed, reserved: [0; 2] })
    }

    /// The weights.
    pub const fn weights(&self) -> &Weights {
        &self.weights
    }

    /// Offsets of the taps of pixel `(x, y)` in pass `pass`; (0, 0) stands for none.
    #[inline]
    pub fn taps(&self, pass: u32, x: u32, y: u32) -> impl Iterator<Item = (i32, i32)> {
        let hash = pcg3d([x, y, self.seed.wrapping_add(pass)])[0];
        let offsets = |tap: &u32| (i32::from(*tap as i16), (*tap as i32) >> 16);
        self.pattern[hash as usize % TURNS].iter().map(offsets)
    }
}

/// The k-th tap of a turned pattern: x in the low 16 bits, y in the high ones.
fn spiral(radius: f32, turn: usize, k: usize) -> u32 {
    /// π·(3 − √5) radians.
    const GOLDEN_ANGLE: f32 = 2.399_963_1;
    let angle = k as f32 * GOLDEN_ANGLE + turn as f32 * (core::f32::consts::TAU / TURNS as f32);
    let (sin, cos) = float::sin_cos(angle);
    let r = radius * float::sqrt((k as f32 + 0.5) / TAPS as f32);
    let (dx, dy) = (float::round(r * cos) as i32, float::round(r * sin) as i32);
    (dx as u32 & 0xffff) | ((dy as u32) << 16)
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
        let mut mean = Mean::around(own);
        for (dx, dy) in self.taps(pass, x, y) {
            let Some(q) = view.neighbour(x, y, dx, dy) else { continue };
            let light = &input[q];
            if q == p || is_hole(light) {
                continue;
            }
            let weight = self.weights.guides(guide, &guides[q]);
            if weight > 0.0 {
                let weight = weight * around.weight(luminance_of(light));
                if weight > 0.0 {
                    mean.add(weight, light);
                }
            }
        }
        mean.finish().unwrap_or(*own)
    }
}
