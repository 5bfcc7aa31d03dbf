//! Which cells a triangle overlaps.
//!
//! A triangle and a box are apart if and only if a plane parts them that is parallel to a side of the box, to the
//! triangle, or to an edge of each (Akenine-Möller 2001). Every such condition is linear in the cell's coordinates, so
//! for a row of cells along x it leaves an interval of x (after Schwarz & Seidel 2010, who use it per column): a row
//! costs one evaluation of each condition, whatever its length, and no row is visited that has no cell.
//!
//! A cell is widened by [`Grid::margin`] on all sides. All is done in double precision, whose rounding is
//! thousands of times smaller than the margin. Conditions test both sides of a triangle where its projection is too
//! thin to know its winding, so a triangle may be a segment or a point.

use glam::Vec3;

use super::grid::Grid;

/// Cells `low..high` an axis, to which voxelisation is limited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First cell.
    pub low: [u32; 3],
    /// Cell behind the last.
    pub high: [u32; 3],
}

/// A bound `at + slope·j` of one coordinate, linear in another.
#[derive(Clone, Copy, Debug, Default)]
struct Line {
    at: f64,
    slope: f64,
}

/// Bounds of one coordinate from the projection of the triangle onto a coordinate plane: every lower one must be met,
/// and every upper one.
#[derive(Clone, Copy, Debug, Default)]
struct Bounds {
    lower: [Line; 6],
    upper: [Line; 6],
    lowers: usize,
    uppers: usize,
}

impl Bounds {
    /// The interval of the first coordinate for the cell `j` of the second.
    #[inline]
    fn at(&self, j: f64, low: f64, high: f64) -> (f64, f64) {
        let lower = self.lower[..self.lowers].iter().fold(low, |bound, line| bound.max(line.at + line.slope * j));
        let upper = self.upper[..self.uppers].iter().fold(high, |bound, line| bound.min(line.at + line.slope * j));
        (lower, upper)
    }

    /// `a·p + b·q + c ≥ 0` for cells with the index `(p, q)`.
    fn add(&mut self, a: f64, b: f64, c: f64) {
        if a > 0.0 {
            self.lower[self.lowers] = Line { at: -c / a, slope: -b / a };
            self.lowers += 1;
        } else if a < 0.0 {
            self.upper[self.uppers] = Line { at: -c / a, slope: -b / a };
            self.uppers += 1;
        }
        // Else the condition is on q alone, and the projection onto another plane or the box of corners has it.
    }

    /// The conditions of a triangle's projection onto the axes `p` and `q`.
    fn new(corners: &[[f64; 3]; 3], p: usize, q: usize, half: f64) -> Self {
        let mut bounds = Self::default();
        for k in 0..3 {
            let (u, v, w) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
            // m·(x − u) is 0 on the edge from u to v.
            let (mp, mq) = (u[q] - v[q], v[p] - u[p]);
            let opposite = mp * (w[p] - u[p]) + mq * (w[q] - u[q]);
            let reach = half * (mp.abs() + mq.abs());
            // Of the cell's centre (p + ½, q + ½).
            let constant = mp * (0.5 - u[p]) + mq * (0.5 - u[q]);
            let doubt = THIN * (mp.abs() + mq.abs()) * ((w[p] - u[p]).abs() + (w[q] - u[q]).abs());
            if opposite >= -doubt {
                bounds.add(mp, mq, constant + reach - opposite.min(0.0));
            }
            if opposite <= doubt {
                bounds.add(-mp, -mq, -constant + reach + opposite.max(0.0));
            }
        }
        bounds
    }
}

/// Relative to the product of its sides, a projected triangle's area below which both sides of each edge are tested.
const THIN: f64 = 1e-12;

/// Relative error of a triangle's normal times its edges, generously.
const NORMAL_ERROR: f64 = 1e-14;

/// The condition that a cell touches the triangle's plane, as bounds of x, linear in y and z.
#[derive(Clone, Copy, Debug)]
struct Plane {
    at: f64,
    slope: [f64; 2],
    /// Half the distance of the two bounds; infinite when the plane is parallel to x.
    reach: f64,
}

impl Plane {
    fn new(corners: &[[f64; 3]; 3], half: f64) -> Self {
        let a = corners[0];
        let [u, v] = edges(corners);
        let n = cross(corners);
        let length = |v: [f64; 3]| v[0].abs() + v[1].abs() + v[2].abs();
        // The normal of a sliver is mostly rounding error; its plane is then no condition, and the edges suffice.
        let error = NORMAL_ERROR * length(u) * length(v) * (length(u) + length(v));
        let reach = (half * length(n) + error) / n[0].abs();
        if n[0] == 0.0 || !reach.is_finite() {
            return Self { at: 0.0, slope: [0.0; 2], reach: f64::INFINITY };
        }
        let centre = |axis: usize| 0.5 - a[axis];
        let at = -(n[0] * centre(0) + n[1] * centre(1) + n[2] * centre(2)) / n[0];
        Self { at, slope: [-n[1] / n[0], -n[2] / n[0]], reach }
    }
}

/// From the first corner to the two others.
fn edges(corners: &[[f64; 3]; 3]) -> [[f64; 3]; 2] {
    let [a, b, c] = *corners;
    [b, c].map(|v| [v[0] - a[0], v[1] - a[1], v[2] - a[2]])
}

/// The normal of a triangle, as long as twice its area.
pub(crate) fn cross(corners: &[[f64; 3]; 3]) -> [f64; 3] {
    let [u, v] = edges(corners);
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// A triangle made ready for rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows {
    x: [f64; 2],
    y: [f64; 2],
    z: [i32; 2],
    plane: Plane,
    xy: Bounds,
    xz: Bounds,
    yz: Bounds,
}

impl Rows {
    /// `None` when the triangle is not finite or has no cell in the window.
    pub(crate) fn new(grid: &Grid, window: &Window, triangle: &[Vec3; 3]) -> Option<Self> {
        if !triangle.iter().all(|corner| corner.is_finite()) {
            return None;
        }
        let corners = triangle.map(|corner| grid.exact(corner));
        let margin = grid.margin();
        let mut range = [[0_i32; 2]; 3];
        for (axis, range) in range.iter_mut().enumerate() {
            let at = corners.map(|corner| corner[axis]);
            let (low, high) = (at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2]));
            let window = [window.low[axis] as i32, window.high[axis] as i32 - 1];
            let near = |v: f64| v.clamp(-1.0, f64::from(window[1]) + 1.0);
            // Closed cells: one that only touches belongs to it.
            let first = ceil(near(low - 1.0 - margin)).max(window[0]);
            let last = floor(near(high + margin)).min(window[1]);
            if first > last {
                return None;
            }
            *range = [first, last];
        }
        let half = 0.5 + margin;
        let [x, y, z] = range;
        Some(Self {
            x: x.map(f64::from),
            y: y.map(f64::from),
            z,
            plane: Plane::new(&corners, half),
            xy: Bounds::new(&corners, 0, 1, half),
            xz: Bounds::new(&corners, 0, 2, half),
            yz: Bounds::new(&corners, 1, 2, half),
        })
    }

    /// Calls `each(block, occupancy)` once for every block with cells that the triangle overlaps; blocks are counted
    /// from the cube's corner.
    #[inline]
    pub(crate) fn blocks(&self, mut each: impl FnMut([u32; 3], u32)) {
        for kb in self.z[0] >> 1..=self.z[1] >> 1 {
            let layers = [2 * kb, 2 * kb + 1].map(|k| self.layer(k));
            let first = layers[0].rows[0].min(layers[1].rows[0]);
            let last = layers[0].rows[1].max(layers[1].rows[1]);
            for jb in first >> 2..=last >> 2 {
                self.strip(&layers, jb, |ib, bits| each([ib as u32, jb as u32, kb as u32], bits));
            }
        }
    }

    /// The rows of layer `k`.
    #[inline]
    fn layer(&self, k: i32) -> Layer {
        if k < self.z[0] || k > self.z[1] {
            return Layer { rows: [i32::MAX, i32::MIN], ..Layer::default() };
        }
        let z = f64::from(k);
        let (low, high) = self.yz.at(z, self.y[0], self.y[1]);
        let x = self.xz.at(z, self.x[0], self.x[1]);
        let rows = if low <= high { [ceil(low), floor(high)] } else { [i32::MAX, i32::MIN] };
        let rows = if rows[0] <= rows[1] { rows } else { [i32::MAX, i32::MIN] };
        Layer { rows, x, plane: self.plane.at + self.plane.slope[1] * z }
    }

    /// The blocks of the rows `4·jb..4·jb+4` of two layers.
    #[inline]
    fn strip(&self, layers: &[Layer; 2], jb: i32, mut each: impl FnMut(i32, u32)) {
        // First cell and the cell behind the last of each of the block's eight rows.
        let mut spans = [[0_i32; 2]; 8];
        let (mut first, mut last) = (i32::MAX, i32::MIN);
        for j in 4 * jb..4 * jb + 4 {
            let y = f64::from(j);
            let (xy_low, xy_high) = self.xy.at(y, self.x[0], self.x[1]);
            for (k, layer) in layers.iter().enumerate() {
                if j < layer.rows[0] || j > layer.rows[1] {
                    continue;
                }
                let plane = layer.plane + self.plane.slope[0] * y;
                let low = xy_low.max(layer.x.0).max(plane - self.plane.reach);
                let high = xy_high.min(layer.x.1).min(plane + self.plane.reach);
                if low > high {
                    continue;
                }
                let span = [ceil(low), floor(high) + 1];
                if span[0] < span[1] {
                    spans[(j & 3) as usize + 4 * k] = span;
                    first = first.min(span[0]);
                    last = last.max(span[1]);
                }
            }
        }
        if first >= last {
            return;
        }
        for ib in first >> 2..=(last - 1) >> 2 {
            let mut bits = 0_u32;
            for (row, span) in spans.iter().enumerate() {
                let low = (span[0] - 4 * ib).clamp(0, 4);
                let high = (span[1] - 4 * ib).clamp(0, 4);
                let run = (1_u32 << high).wrapping_sub(1) & !((1_u32 << low).wrapping_sub(1));
                bits |= run << (4 * row);
            }
            if bits != 0 {
                each(ib, bits);
            }
        }
    }
}

/// Largest integer that is not above `v`.
#[inline]
fn floor(v: f64) -> i32 {
    let whole = v as i32;
    whole - i32::from(f64::from(whole) > v)
}

/// Smallest integer that is not below `v`.
#[inline]
fn ceil(v: f64) -> i32 {
    let whole = v as i32;
    whole + i32::from(f64::from(whole) < v)
}

/// What a layer of cells, one in z, leaves of y and x.
#[derive(Clone, Copy, Debug, Default)]
struct Layer {
    rows: [i32; 2],
    x: (f64, f64),
    plane: f64,
}
