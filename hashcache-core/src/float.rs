//! Every root, logarithm, exponential, angle and rounding of the workspace.
//!
//! One set of bits on every machine: the functions are those of `libm`, never the platform's. `sqrt` is the
//! processor's own where it has one (IEEE 754 leaves one right answer, so the bits are the same).
//! `clippy.toml` bans the inherent methods. All angles are in radians.
//!
//! # Source
//! musl's mathematical functions in their Rust port (`libm`).

macro_rules! unary {
    ($($(#[$doc:meta])* $name:ident = $libm:ident;)*) => {
        $(
            $(#[$doc])*
            #[inline]
            pub fn $name(x: f32) -> f32 {
                libm::$libm(x)
            }
        )*
    };
}

unary! {
    /// √x; NaN below 0. Correctly rounded.
    sqrt = sqrtf;
    /// Cube root.
    cbrt = cbrtf;
    /// Sine; NaN for an infinite `x`.
    sin = sinf;
    /// Cosine; NaN for an infinite `x`.
    cos = cosf;
    /// Tangent; NaN for an infinite `x`.
    tan = tanf;
    /// Arc sine in `[-π/2, π/2]`; NaN outside `[-1, 1]`.
    asin = asinf;
    /// Arc cosine in `[0, π]`; NaN outside `[-1, 1]`.
    acos = acosf;
    /// Arc tangent in `[-π/2, π/2]`.
    atan = atanf;
    /// e to the power of `x`.
    exp = expf;
    /// 2 to the power of `x`.
    exp2 = exp2f;
    /// e to the power of `x`, less 1, exact near 0.
    exp_m1 = expm1f;
    /// Natural logarithm; −∞ at 0, NaN below.
    ln = logf;
    /// Natural logarithm of `1 + x`, exact near 0.
    ln_1p = log1pf;
    /// Logarithm to base 2; −∞ at 0, NaN below.
    log2 = log2f;
    /// Logarithm to base 10; −∞ at 0, NaN below.
    log10 = log10f;
    /// The largest integer that is not above `x`.
    floor = floorf;
    /// The smallest integer that is not below `x`.
    ceil = ceilf;
    /// The nearest integer, halves away from 0.
    round = roundf;
    /// The integer part, towards 0.
    trunc = truncf;
    /// The absolute value.
    abs = fabsf;
}

/// Sine and cosine of one angle.
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    libm::sincosf(x)
}

/// The angle of the point `(x, y)` in `[-π, π]`; 0 for the origin.
///
/// ```
/// # use hashcache_core::float;
/// assert_eq!(float::atan2(1.0, 0.0), core::f32::consts::FRAC_PI_2);
/// ```
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// `x` to the power of `y`.
#[inline]
pub fn powf(x: f32, y: f32) -> f32 {
    libm::powf(x, y)
}

/// √(x² + y²) without overflow on the way.
#[inline]
pub fn hypot(x: f32, y: f32) -> f32 {
    libm::hypotf(x, y)
}
