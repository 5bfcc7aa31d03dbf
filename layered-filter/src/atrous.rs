//! An edge-avoiding wavelet filter: few taps a pass, a reach that doubles with every pass.

use bytemuck::{Pod, Zeroable};
use hashcache_core::error::ParamError;
use hashcache_core::glam::Vec4;

use crate::denoiser::Denoiser;
use crate::image::{Light, View, is_hole, luminance_of};
use crate::mean::{Mean, add_at};
use crate::weights::{WeightSettings, Weights};

/// The shape of one pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taps {
    /// 3×3: the binomial (1, 2, 1)/4 in each direction; reaches 2^passes − 1 pixels.
    Nine,
    /// 5×5: the B₃ spline (1, 4, 6, 4, 1)/16; reaches 2·(2^passes − 1) pixels.
    TwentyFive,
}

/// An edge-avoiding à-trous wavelet: pass k mixes taps 2^k pixels apart. [`Pod`], so that it is a kernel's parameter as it
/// stands (80 bytes).
///
/// With [`crate::LuminanceWeight::Deviation`] it is guided by the variance that the image carries along: each pass mixes
/// less, since the noise has shrunk. The variance of a pixel is smoothed over its 3×3 neighbours before it is used.
///
/// # Source
/// Dammertz et al. 2010; variance guided after Schied et al. 2017, sections 4.3 and 4.4.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ATrous {
    weights: Weights,
    passes: u32,
    reach: u32,
    reserved: [u32; 2],
}

impl ATrous {
    /// A filter of `passes` passes, 1 to 8.
    ///
    /// # Errors
    /// [`ParamError`] with the name of what is out of range.
    pub fn new(weights: &WeightSettings, taps: Taps, passes: u32) -> Result<Self, ParamError> {
        ParamError::check_range("passes", f64::from(passes), 1.0, 8.0)?;
        let reach = match taps {
            Taps::Nine => 1,
            Taps::TwentyFive => 2,
        };
        Ok(Self { weights: Weights::new(weights)?, passes, reach, reserved: [0; 2] })
    }

    /// The weights.
    pub const fn weights(&self) -> &Weights {
        &self.weights
    }
}

/// Offset and factor of a tap, in units of the middle one's.
pub(crate) type Tap = (i32, i32, f32);

/// The binomial's taps without the middle one.
const NINE: [Tap; 8] = ring::<8>(1, [1.0, 0.5, 0.0]);

/// The B₃ spline's taps without the middle one.
pub(crate) const TWENTY_FIVE: [Tap; 24] = ring::<24>(2, [1.0, 4.0 / 6.0, 1.0 / 6.0]);

/// All taps up to `reach`; a tap's factor is the product of those of its two distances.
const fn ring<const N: usize>(reach: i32, factors: [f32; 3]) -> [Tap; N] {
    let mut taps = [(0, 0, 0.0); N];
    let (mut k, mut j) = (0, -reach);
    while j <= reach {
        let mut i = -reach;
        while i <= reach {
            if i != 0 || j != 0 {
                taps[k] = (i, j, factors[i.unsigned_abs() as usize] * factors[j.unsigned_abs() as usize]);
                k += 1;
            }
            i += 1;
        }
        j += 1;
    }
    taps
}

/// The variance around a pixel: binomial mean over 3×3 pixels with a vertex; of the pixel alone where that is unknown.
#[inline]
pub(crate) fn smooth_variance(view: &View<'_>, input: &[Light], x: u32, y: u32, own: &Light) -> f32 {
    let (mut sum, mut total) = (0.0, 0.0);
    for dy in -1..=1 {
        for dx in -1..=1 {
            let Some(q) = view.neighbour(x, y, dx, dy) else { continue };
            let variance = input[q][3];
            // Neither holes nor unknown ones.
            if (0.0..=f32::MAX).contains(&variance) {
                let weight = ((2 - dx.abs()) * (2 - dy.abs())) as f32;
                sum += weight * variance;
                total += weight;
            }
        }
    }
    if total > 0.0 && own[3] <= f32::MAX { sum / total } else { own[3] }
}

impl Denoiser for ATrous {
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
        let variance = if self.weights.by_deviation() { smooth_variance(view, input, x, y, own) } else { own[3] };
        let around = self.weights.luminance_of(luminance, variance);
        let mut mean = Mean::new(&self.weights, guide, own, around);
        let taps: &[Tap] = if self.reach == 1 { &NINE } else { &TWENTY_FIVE };
        for four in taps.as_chunks::<4>().0 {
            let near = four.map(|(i, j, _)| view.neighbour(x, y, i << pass, j << pass));
            let factor = core::array::from_fn(|k| if near[k].is_some() { four[k].2 } else { 0.0 });
            add_at(&mut mean, guides, input, near.map(|q| q.unwrap_or(p)), Vec4::from_array(factor));
        }
        mean.finish().unwrap_or(*own)
    }
}
