//! Multi-scale structural similarity.

use crate::{Error, ImageView, srgb_encode};

/// The smallest width and height that [`ms_ssim`] takes: the 11-pixel window must fit after four halvings.
pub const MS_SSIM_MIN_SIDE: usize = WINDOW << (SCALES - 1);

/// Scales, and the exponent of each scale's term (Wang et al. 2003, section 3.2; they sum to 1).
const SCALES: usize = 5;
const WEIGHTS: [f64; SCALES] = [0.0448, 0.2856, 0.3001, 0.2363, 0.1333];

/// Weights of R, G and B in the luma of encoded values (Rec. 601), which SSIM was tuned on.
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];

/// Width in pixels and standard deviation of the Gaussian window.
const WINDOW: usize = 11;
const SIGMA: f64 = 1.5;

/// (K₁·L)² and (K₂·L)² with K₁ = 0.01, K₂ = 0.03 and the range L = 1: they keep the quotients of flat areas at 1.
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// MS-SSIM of what a screen shows: five scales, on the luma of the clipped, sRGB-encoded images.
///
/// Between scales both images are averaged over 2×2 pixels; an odd last row or column is dropped. The window is
/// evaluated only where it lies inside the image. A scale's negative mean counts as 0.
///
/// # Errors
/// [`Error::SizesDiffer`]; [`Error::TooSmall`] below 176×176 pixels ([`MS_SSIM_MIN_SIDE`]).
///
/// # Units
/// None: 1 for images that look the same on a screen, 0 for nothing in common.
///
/// # Source
/// Wang et al. 2003, equation 7.
///
/// ```
/// # use image_metrics::{ImageView, ms_ssim};
/// let stripes: Vec<[f32; 3]> = (0..176 * 176).map(|i| [(i % 2) as f32; 3]).collect();
/// let grey = vec![[0.2; 3]; 176 * 176];
/// let (stripes, grey) = (ImageView::new(176, 176, &stripes)?, ImageView::new(176, 176, &grey)?);
/// assert_eq!(ms_ssim(stripes, stripes)?, 1.0);
/// assert!(ms_ssim(stripes, grey)? < 0.8);
/// # Ok::<(), image_metrics::Error>(())
/// ```
pub fn ms_ssim(image: ImageView, reference: ImageView) -> Result<f64, Error> {
    image.same_size(&reference)?;
    let size = [image.width(), image.height()];
    if size.iter().any(|&side| side < MS_SSIM_MIN_SIDE) {
        return Err(Error::TooSmall { size, least: MS_SSIM_MIN_SIDE });
    }
    let (mut a, mut b) = (Plane::luma(image), Plane::luma(reference));
    let mut product = 1.0;
    for (scale, weight) in WEIGHTS.iter().enumerate() {
        let last = scale == SCALES - 1;
        let term = if last { similarity(&a, &b).whole } else { similarity(&a, &b).contrast_structure };
        product *= term.max(0.0).powf(*weight);
        if !last {
            (a, b) = (a.halved(), b.halved());
        }
    }
    Ok(product)
}

/// One channel.
struct Plane {
    width: usize,
    height: usize,
    values: Vec<f64>,
}

impl Plane {
    fn luma(image: ImageView) -> Self {
        let luma = |p: &[f32; 3]| (0..3).map(|c| LUMA[c] * srgb_encode(p[c].into())).sum();
        Self { width: image.width(), height: image.height(), values: image.pixels().iter().map(luma).collect() }
    }

    fn row(&self, y: usize) -> &[f64] {
        &self.values[y * self.width..][..self.width]
    }

    /// The mean of each 2×2 block.
    fn halved(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let mut values = Vec::with_capacity(width * height);
        for y in 0..height {
            let (upper, lower) = (self.row(2 * y), self.row(2 * y + 1));
            let pairs = upper.chunks_exact(2).zip(lower.chunks_exact(2));
            values.extend(pairs.map(|(u, l)| 0.25 * ((u[0] + u[1]) + (l[0] + l[1]))));
        }
        Self { width, height, values }
    }
}

/// Means over a plane.
struct Similarity {
    /// Luminance × contrast × structure.
    whole: f64,
    /// Contrast × structure.
    contrast_structure: f64,
}

/// First and second moments of two planes under the window: a, b, a², b², ab.
const MOMENTS: usize = 5;

/// SSIM and its contrast-structure part, averaged over all places of the window inside the planes.
///
/// The window is a product, so each row is filtered sideways once and kept while eleven rows are: memory is by rows.
fn similarity(a: &Plane, b: &Plane) -> Similarity {
    let kernel = gaussian();
    let columns = a.width + 1 - WINDOW;
    let mut rows = vec![[0.0; MOMENTS]; WINDOW * columns];
    let (mut whole, mut contrast_structure) = (0.0, 0.0);
    for y in 0..a.height {
        let slot = &mut rows[y % WINDOW * columns..][..columns];
        for ((out, wa), wb) in slot.iter_mut().zip(a.row(y).windows(WINDOW)).zip(b.row(y).windows(WINDOW)) {
            *out = [0.0; MOMENTS];
            for ((k, a), b) in kernel.iter().zip(wa).zip(wb) {
                let moments = [*a, *b, a * a, b * b, a * b];
                (0..MOMENTS).for_each(|m| out[m] += k * moments[m]);
            }
        }
        if y + 1 < WINDOW {
            continue;
        }
        for x in 0..columns {
            let mut moments = [0.0; MOMENTS];
            for (i, k) in kernel.iter().enumerate() {
                let row = &rows[(y + 1 + i) % WINDOW * columns + x];
                (0..MOMENTS).for_each(|m| moments[m] += k * row[m]);
            }
            let [ma, mb, aa, bb, ab] = moments;
            let (va, vb, cov) = (aa - ma * ma, bb - mb * mb, ab - ma * mb);
            let cs = (2.0 * cov + C2) / (va + vb + C2);
            whole += (2.0 * ma * mb + C1) / (ma * ma + mb * mb + C1) * cs;
            contrast_structure += cs;
        }
    }
    let places = (columns * (a.height + 1 - WINDOW)) as f64;
    Similarity { whole: whole / places, contrast_structure: contrast_structure / places }
}

/// The window's weights along one axis; they sum to 1.
fn gaussian() -> [f64; WINDOW] {
    let raw: [f64; WINDOW] = core::array::from_fn(|i| {
        let d = i as f64 - (WINDOW / 2) as f64;
        (-d * d / (2.0 * SIGMA * SIGMA)).exp()
    });
    let sum: f64 = raw.iter().sum();
    raw.map(|k| k / sum)
}
