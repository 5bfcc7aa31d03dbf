//! Several numbers at a time.

/// Arithmetic on `N` `f32`, rounded after every operation, so that every implementation gives the same bits.
///
/// A value of the implementing type proves that this processor can run it.
pub(super) trait Lanes<const N: usize>: Copy {
    /// `N` numbers.
    type Vector: Copy;

    /// The numbers of an array.
    fn load(self, from: &[f32; N]) -> Self::Vector;
    /// The numbers as an array.
    fn store(self, v: Self::Vector) -> [f32; N];
    /// `N` times the same number.
    fn splat(self, x: f32) -> Self::Vector;
    /// Sums.
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// Differences.
    fn sub(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// Products.
    fn mul(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// Quotients.
    fn div(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// The smaller numbers; those of `b` where a number is NaN.
    fn min(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// The larger numbers; those of `b` where a number is NaN.
    fn max(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// Bit `i` is set where `a ≤ b`.
    fn le(self, a: Self::Vector, b: Self::Vector) -> u32;
    /// Bit `i` is set where `a < b`.
    fn lt(self, a: Self::Vector, b: Self::Vector) -> u32;
}

/// Plain Rust, for any processor.
#[derive(Clone, Copy)]
pub(super) struct Portable;

#[inline(always)]
fn zip<const N: usize>(a: [f32; N], b: [f32; N], f: impl Fn(f32, f32) -> f32) -> [f32; N] {
    core::array::from_fn(
        #[inline(always)]
        |i| f(a[i], b[i]),
    )
}

#[inline(always)]
fn mask<const N: usize>(a: [f32; N], b: [f32; N], f: impl Fn(f32, f32) -> bool) -> u32 {
    let mut bits = 0;
    for i in 0..N {
        bits |= u32::from(f(a[i], b[i])) << i;
    }
    bits
}

impl<const N: usize> Lanes<N> for Portable {
    type Vector = [f32; N];

    #[inline(always)]
    fn load(self, from: &[f32; N]) -> [f32; N] {
        *from
    }

    #[inline(always)]
    fn store(self, v: [f32; N]) -> [f32; N] {
        v
    }

    #[inline(always)]
    fn splat(self, x: f32) -> [f32; N] {
        [x; N]
    }

    #[inline(always)]
    fn add(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        zip(
            a,
            b,
            #[inline(always)]
            |a, b| a + b,
        )
    }

    #[inline(always)]
    fn sub(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        zip(
            a,
            b,
            #[inline(always)]
            |a, b| a - b,
        )
    }

    #[inline(always)]
    fn mul(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        zip(
            a,
            b,
            #[inline(always)]
            |a, b| a * b,
        )
    }

    #[inline(always)]
    fn div(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        zip(
            a,
            b,
            #[inline(always)]
            |a, b| a / b,
        )
    }

    #[inline(always)]
    fn min(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        zip(
            a,
            b,
            #[inline(always)]
            |a, b| if a < b { a } else { b },
        )
    }

    #[inline(always)]
    fn max(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
        zip(
            a,
            b,
            #[inline(always)]
            |a, b| if a > b { a } else { b },
        )
    }

    #[inline(always)]
    fn le(self, a: [f32; N], b: [f32; N]) -> u32 {
        mask(
            a,
            b,
            #[inline(always)]
            |a, b| a <= b,
        )
    }

    #[inline(always)]
    fn lt(self, a: [f32; N], b: [f32; N]) -> u32 {
        mask(
            a,
            b,
            #[inline(always)]
            |a, b| a < b,
        )
    }
}
