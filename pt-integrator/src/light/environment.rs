//! Radiance from an equirectangular image, and directions in proportion to it.
//!
//! Between four neighbouring texel centres (a patch) the radiance is bilinear, and so is its luminance. A patch is
//! chosen by its mean luminance times its rows' mean sine, a point in it exactly in proportion to the luminance. The
//! density is then positive exactly where there is light, and known from the radiance itself without a table of cells.
//! The uppermost and lowermost patches are half as high: radiance is constant from the last centre to the pole.

use core::f32::consts::{FRAC_1_PI, PI, TAU};

use glam::{Vec2, Vec3};
use hashcache_core::float;

use super::{LightSample, luminance};

/// An environment image and the tables to sample it; `width` 0: there is none.
#[derive(Clone, Copy, Debug)]
pub struct EnvironmentView<'a> {
    /// Texels a row.
    pub width: u32,
    /// Rows; there is one row of patches more.
    pub height: u32,
    /// Radiance, rows from the top; w is unused.
    pub texels: &'a [[f32; 4]],
    /// For each row of patches, density by solid angle over luminance, times the sine of the polar angle.
    pub row_density: &'a [f32],
    /// For each row of patches, probability of it or one above.
    pub rows: &'a [f32],
    /// For each patch, probability of it or one to its left within its row.
    pub columns: &'a [f32],
    /// For each table in `columns`, then for `rows`: for each of [`guide_buckets`] equal parts of `[0, 1)` the first
    /// entry that is above the part's start. A search begins there: it ends after a step or two, where halving the
    /// table misses the cache a dozen times.
    ///
    /// # Source
    /// Chen & Asau 1974.
    pub guides: &'a [u32],
    /// Cosine and sine of the angle by which the image is turned about +y, counter-clockwise seen from above.
    pub rotation: [f32; 2],
}

/// Parts of `[0, 1)` for which [`EnvironmentView::guides`] has entries, a power of two: one for four texels of a row.
pub const fn guide_buckets(width: usize) -> usize {
    (width / 4).next_power_of_two()
}

/// What is seen in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentSample {
    /// Radiance from there.
    pub radiance: Vec3,
    /// Density by solid angle with which [`EnvironmentView::sample`] chooses the direction.
    pub pdf: f32,
}

/// A place among the texel centres.
struct Place {
    column: usize,
    row: usize,
    fraction: Vec2,
}

impl EnvironmentView<'_> {
    /// No image.
    pub const NONE: Self = Self {
        width: 0,
        height: 0,
        texels: &[],
        row_density: &[],
        rows: &[],
        columns: &[],
        guides: &[],
        rotation: [1.0, 0.0],
    };

    /// Radiance and density in a direction of unit length. Directions that are not finite see nothing.
    #[inline]
    pub fn evaluate(&self, direction: Vec3) -> EnvironmentSample {
        if self.width == 0 || !direction.is_finite() {
            return EnvironmentSample { radiance: Vec3::ZERO, pdf: 0.0 };
        }
        let direction = self.turned(direction, -1.0);
        let sine = float::sqrt(direction.x * direction.x + direction.z * direction.z);
        // The arc tangent keeps the polar angle exact near the poles, where the arc cosine loses half of the bits.
        let v = float::atan2(sine, direction.y) * FRAC_1_PI;
        let u = 0.5 + float::atan2(direction.x, -direction.z) * (1.0 / TAU);
        let place = self.place(Vec2::new(u, v));
        let radiance = self.radiance(&place);
        EnvironmentSample { radiance, pdf: self.density(&place, radiance, sine) }
    }

    /// A direction in proportion to the radiance (and the sine's mean over a row of patches), its density times
    /// `probability`, the chance that the environment was chosen at all.
    #[inline]
    pub fn sample(&self, u: Vec2, probability: f32) -> Option<LightSample> {
        let width = self.width as usize;
        let buckets = guide_buckets(width);
        let guide = |table: usize| self.guides.get(table * buckets..(table + 1) * buckets);
        let (row, y) = choose(self.rows, guide(self.rows.len())?, u.y);
        let (column, x) = choose(self.columns.get(row * width..(row + 1) * width)?, guide(row)?, u.x);
        let [a, b, c, d] = self.corners(column, row).map(luminance);
        let bottom_half = row == self.height as usize;
        let y = linear(y, a + b, c + d);
        let x = linear(x, a + (c - a) * y, b + (d - b) * y);
        // In the half patches at the poles the corners of a column are equal, so y is uniform.
        let v = if row == 0 {
            0.5 * y
        } else if bottom_half {
            row as f32 - 0.5 + 0.5 * y
        } else {
            row as f32 - 0.5 + y
        } / self.height as f32;
        let place = Place { column, row, fraction: Vec2::new(x, y) };
        let azimuth = ((column as f32 + 0.5 + x) / self.width as f32 - 0.5) * TAU;
        let (sine, cosine) = float::sin_cos(v * PI);
        let (sine_azimuth, cosine_azimuth) = float::sin_cos(azimuth);
        let radiance = self.radiance(&place);
        let pdf = self.density(&place, radiance, sine) * probability;
        let direction = self.turned(Vec3::new(sine * sine_azimuth, cosine, -sine * cosine_azimuth), 1.0);
        (pdf > 0.0 && pdf <= f32::MAX).then_some(LightSample {
            direction,
            target: None,
            radiance,
            pdf,
            is_delta: false,
        })
    }

    /// A direction turned with the image (`sense` 1) or back into it (−1).
    #[inline]
    fn turned(&self, direction: Vec3, sense: f32) -> Vec3 {
        let [cosine, sine] = self.rotation;
        if sine == 0.0 && cosine > 0.0 {
            return direction;
        }
        let (x, z, sine) = (direction.x, direction.z, sine * sense);
        Vec3::new(cosine * x + sine * z, direction.y, cosine * z - sine * x)
    }

    #[inline]
    fn place(&self, at: Vec2) -> Place {
        let x = at.x * self.width as f32 - 0.5;
        let y = at.y * self.height as f32 + 0.5;
        let (column, row) = (float::floor(x), float::floor(y));
        let last = self.width as usize - 1;
        let fraction = Vec2::new(x - column, y - row);
        let column = if column < 0.0 { last } else { (column as usize).min(last) };
        Place { column, row: (row as usize).min(self.height as usize), fraction }
    }

    /// Radiance at the corners of a patch: upper left, upper right, lower left, lower right.
    #[inline]
    fn corners(&self, column: usize, row: usize) -> [Vec3; 4] {
        let (width, height) = (self.width as usize, self.height as usize);
        let right = if column + 1 == width { 0 } else { column + 1 };
        let upper = row.max(1) - 1;
        let lower = row.min(height - 1);
        let texel = |x: usize, y: usize| {
            let t = self.texels[y * width + x];
            Vec3::new(t[0], t[1], t[2])
        };
        [texel(column, upper), texel(right, upper), texel(column, lower), texel(right, lower)]
    }

    #[inline]
    fn radiance(&self, place: &Place) -> Vec3 {
        let [a, b, c, d] = self.corners(place.column, place.row);
        let upper = a + (b - a) * place.fraction.x;
        let lower = c + (d - c) * place.fraction.x;
        upper + (lower - upper) * place.fraction.y
    }

    #[inline]
    fn density(&self, place: &Place, radiance: Vec3, sine: f32) -> f32 {
        if sine > 0.0 { luminance(radiance) * self.row_density[place.row] / sine } else { 0.0 }
    }
}

/// The first entry of a cumulative table that is above `u` ∈ `[0, 1)`, and where in the entry `u` lies, in `[0, 1)`.
#[inline]
fn choose(cumulative: &[f32], guide: &[u32], u: f32) -> (usize, f32) {
    // Exact: the number of buckets is a power of two.
    let bucket = ((u * guide.len() as f32) as usize).min(guide.len() - 1);
    let mut index = guide[bucket] as usize;
    // A bucket of very many entries is as rare as it is narrow.
    while cumulative[index] <= u && index + 1 < cumulative.len() {
        index += 1;
    }
    let below = if index == 0 { 0.0 } else { cumulative[index - 1] };
    let share = cumulative[index] - below;
    let inside = if share > 0.0 { (u - below) / share } else { 0.5 };
    (index, inside.clamp(0.0, 1.0 - f32::EPSILON / 2.0))
}

/// A number in `[0, 1]` with density in proportion to the line from `a` at 0 to `b` at 1 (both not negative).
///
/// # Source
/// Pharr et al. 2023, A.4.1.
#[inline]
fn linear(u: f32, a: f32, b: f32) -> f32 {
    let largest = a.max(b);
    if largest <= 0.0 {
        return u;
    }
    let (a, b) = (a / largest, b / largest);
    let root = float::sqrt(a * a + (b * b - a * a) * u);
    if a + root > 0.0 { (u * (a + b) / (a + root)).min(1.0) } else { 0.0 }
}
