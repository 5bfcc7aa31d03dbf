//! The logarithm of the weights: 24 of them a pixel are worth a polynomial of their own.

/// ln x for x from 1 to 2¹²⁷, within 10⁻⁵ (10⁻⁶ up to 10); made for weights, where a thousandth changes nothing. Below 1 it is as good
/// down to 2⁻¹²⁶; other numbers give some number or NaN.
///
/// x = 2^e·m with m in [√½, √2); ln m = 2·artanh(z), z = (m − 1)/(m + 1), |z| ≤ 0.172, by four terms of its series
/// (the next is 2z⁹/9 < 3·10⁻⁸). + − × ÷ only: the same bits on every processor.
///
/// ```
/// # use layered_filter::log::ln;
/// assert_eq!(ln(1.0), 0.0);
/// assert!((ln(10.0) - 2.302585).abs() < 2e-6);
/// ```
#[inline]
pub fn ln(x: f32) -> f32 {
    // The bits of √½: subtracted, the exponent of m's octave stands in the upper bits.
    const ROOT_HALF: u32 = 0x3f35_04f3;
    let bits = x.to_bits();
    let e = (bits.wrapping_sub(ROOT_HALF) as i32) >> 23;
    let m = f32::from_bits(bits.wrapping_sub((e as u32) << 23));
    let z = (m - 1.0) / (m + 1.0);
    let square = z * z;
    let series = 2.0 + square * (2.0 / 3.0 + square * (2.0 / 5.0 + square * (2.0 / 7.0)));
    e as f32 * core::f32::consts::LN_2 + z * series
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_is_within_what_is_stated() {
        let mut x = 1.0_f32;
        while x < 1e38 {
            let error = (f64::from(ln(x)) - f64::from(x).ln()).abs();
            assert!(error < if x <= 10.0 { 1e-6 } else { 1e-5 }, "{x}: {error}");
            x *= 1.0003;
        }
    }

    #[test]
    fn grows() {
        let mut last = ln(1.0);
        for i in 1..100_000 {
            let next = ln(1.0 + i as f32 * 1e-3);
            assert!(next >= last - 1e-6, "{i}");
            last = next;
        }
    }
}
