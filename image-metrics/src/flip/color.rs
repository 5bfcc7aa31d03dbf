//! Colour spaces: linear Rec. 709, opponent colours in which the eye's blur acts, and one of equal visible steps.

/// Rec. 709 to CIE XYZ, relative to the white of D65: row sums are 1, so white is (1, 1, 1).
///
/// The quotients are the exact ones of the primaries and of the white x = 0.3127, y = 0.3290; their row sums divide.
const TO_XYZ: [[f64; 3]; 3] = [
    relative([10_135_552.0, 8_788_810.0, 4_435_075.0]),
    relative([2_613_072.0, 8_788_810.0, 887_015.0]),
    relative([1_425_312.0, 8_788_810.0, 70_074_185.0]),
];

const fn relative(row: [f64; 3]) -> [f64; 3] {
    let sum = row[0] + row[1] + row[2];
    [row[0] / sum, row[1] / sum, row[2] / sum]
}

/// The inverse of a matrix, by Cramer's rule.
const fn inverse(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut out = [[0.0; 3]; 3];
    let mut row = 0;
    while row < 3 {
        let mut column = 0;
        while column < 3 {
            let (r, s, c, d) = ((column + 1) % 3, (column + 2) % 3, (row + 1) % 3, (row + 2) % 3);
            out[row][column] = m[r][c] * m[s][d] - m[r][d] * m[s][c];
            column += 1;
        }
        row += 1;
    }
    let determinant = m[0][0] * out[0][0] + m[0][1] * out[1][0] + m[0][2] * out[2][0];
    let mut i = 0;
    while i < 9 {
        out[i / 3][i % 3] /= determinant;
        i += 1;
    }
    out
}

const TO_LINEAR: [[f64; 3]; 3] = inverse(TO_XYZ);

fn transform(m: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// Y, Cx, Cz: luminance, red against green, blue against yellow, linear in light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Opponent(pub [f64; 3]);

impl Opponent {
    /// From linear Rec. 709.
    pub fn from_linear(rgb: [f64; 3]) -> Self {
        let [x, y, z] = transform(&TO_XYZ, rgb);
        Self([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)])
    }

    /// Luminance from 0 to 1 for what a screen shows.
    pub fn luminance(self) -> f64 {
        (self.0[0] + 16.0) / 116.0
    }

    /// XYZ relative to white.
    fn to_xyz(self) -> [f64; 3] {
        let y = self.luminance();
        [y + self.0[1] / 500.0, y, y - self.0[2] / 200.0]
    }
}

/// CIE L*a*b* whose a* and b* fade in the dark, as the Hunt effect has it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Hunt {
    l: f64,
    a: f64,
    b: f64,
}

impl Hunt {
    /// `HyAB`: large differences are judged better by the sum than by the Euclidean length.
    pub fn distance(&self, other: &Self) -> f64 {
        (self.l - other.l).abs() + (self.a - other.a).hypot(self.b - other.b)
    }
}

/// The largest distance of two colours of a screen: green against blue.
pub(super) const MAX_DIFFERENCE: f64 = 203.301_654_610_877_42;

/// A blurred colour, brought back to what a screen can show, in perceptual coordinates.
pub(super) fn to_hunt(color: Opponent) -> Hunt {
    let rgb = transform(&TO_LINEAR, color.to_xyz()).map(|c| c.clamp(0.0, 1.0));
    let [x, y, z] = transform(&TO_XYZ, rgb).map(compress);
    let l = 116.0 * y - 16.0;
    Hunt { l, a: 0.01 * l * (500.0 * (x - y)), b: 0.01 * l * (200.0 * (y - z)) }
}

/// The cube root, continued as a line near 0 (CIE 1976).
fn compress(t: f64) -> f64 {
    const DELTA: f64 = 6.0 / 29.0;
    if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opponent_colors_come_back() {
        for rgb in [[0.0; 3], [1.0; 3], [0.25, 0.5, 0.75], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] {
            let back = transform(&TO_LINEAR, Opponent::from_linear(rgb).to_xyz());
            assert!(rgb.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-13), "{rgb:?} {back:?}");
        }
    }

    #[test]
    fn grey_has_no_hue_and_white_is_100() {
        for grey in [0.0, 0.001, 0.2, 1.0] {
            let Hunt { l, a, b } = to_hunt(Opponent::from_linear([grey; 3]));
            assert!(a.abs() < 1e-9 && b.abs() < 1e-9 && (-1e-9..=100.0 + 1e-9).contains(&l));
        }
        assert!((to_hunt(Opponent::from_linear([1.0; 3])).l - 100.0).abs() < 1e-9);
    }
}
