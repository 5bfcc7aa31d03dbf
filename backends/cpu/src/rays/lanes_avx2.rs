//! Eight numbers in one AVX register.
#![expect(
    unsafe_code,
    reason = "intrinsics of a processor feature that is found at run time may only be called where it is known to exist; \
              a value of `Avx2` is that knowledge. Measured against the portable lanes in `benches/rays.rs`."
)]

use core::arch::x86_64::{
    __m128, __m256, _CMP_LE_OQ, _CMP_LT_OQ, _mm_add_ps, _mm_cmp_ps, _mm_div_ps, _mm_max_ps, _mm_min_ps,
    _mm_movemask_ps, _mm_mul_ps, _mm_set1_ps, _mm_sub_ps, _mm256_add_ps, _mm256_cmp_ps, _mm256_div_ps, _mm256_max_ps,
    _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_ps, _mm256_sub_ps,
};

use super::lanes::Lanes;

/// Proof that the processor has AVX2 and the bit operations that came with it.
#[derive(Clone, Copy)]
pub(super) struct Avx2(());

impl Avx2 {
    /// The proof, where there is one.
    #[inline]
    pub(super) fn detect() -> Option<Self> {
        use std::arch::is_x86_feature_detected;
        let all = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        all.then_some(Self(()))
    }

    /// Runs `f` compiled for AVX2.
    #[inline(always)]
    pub(super) fn run<R>(self, f: impl FnOnce() -> R) -> R {
        #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
        fn with_feature<R>(f: impl FnOnce() -> R) -> R {
            f()
        }
        let Self(()) = self;
        // SAFETY: `self` existed, so the processor has the features.
        unsafe { with_feature(f) }
    }
}

/// Forwards each method to one intrinsic.
macro_rules! lanes {
    ($n:literal, $vector:ty, $splat:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $min:ident, $max:ident,
     $compare:ident, $mask:ident) => {
        impl Lanes<$n> for Avx2 {
            type Vector = $vector;

            #[inline(always)]
            fn load(self, from: &[f32; $n]) -> $vector {
                bytemuck::cast(*from)
            }

            #[inline(always)]
            fn store(self, v: $vector) -> [f32; $n] {
                bytemuck::cast(v)
            }

            #[inline(always)]
            fn splat(self, x: f32) -> $vector {
                // SAFETY: `self` exists, so the processor has AVX2.
                unsafe { $splat(x) }
            }

            lanes!(@ $vector, add = $add, sub = $sub, mul = $mul, div = $div, min = $min, max = $max);

            #[inline(always)]
            fn le(self, a: $vector, b: $vector) -> u32 {
                // SAFETY: `self` exists, so the processor has AVX2.
                unsafe { $mask($compare::<_CMP_LE_OQ>(a, b)) as u32 }
            }

            #[inline(always)]
            fn lt(self, a: $vector, b: $vector) -> u32 {
                // SAFETY: `self` exists, so the processor has AVX2.
                unsafe { $mask($compare::<_CMP_LT_OQ>(a, b)) as u32 }
            }
        }
    };
    (@ $vector:ty, $($name:ident = $intrinsic:ident),*) => {
        $(
            #[inline(always)]
            fn $name(self, a: $vector, b: $vector) -> $vector {
                // SAFETY: `self` exists, so the processor has AVX2.
                unsafe { $intrinsic(a, b) }
            }
        )*
    };
}

lanes!(
    4,
    __m128,
    _mm_set1_ps,
    _mm_add_ps,
    _mm_sub_ps,
    _mm_mul_ps,
    _mm_div_ps,
    _mm_min_ps,
    _mm_max_ps,
    _mm_cmp_ps,
    _mm_movemask_ps
);

lanes!(
    8,
    __m256,
    _mm256_set1_ps,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_div_ps,
    _mm256_min_ps,
    _mm256_max_ps,
    _mm256_cmp_ps,
    _mm256_movemask_ps
);
