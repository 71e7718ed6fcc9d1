//! Eight floats at once, with the same bits on every processor.
//!
//! Kernels are written once over [`F32x8`]. [`Portable`] is plain code for any machine; [`Avx2`]
//! is the same arithmetic in registers, and may only be used inside functions compiled for AVX2.
//! No operation is fused, so both round alike.
#![expect(
    unsafe_code,
    reason = "vector instructions; each block states why it is sound"
)]

/// Eight lanes of `f32`. Comparisons give a bit for each lane and are false for NaN.
pub(super) trait F32x8: Copy {
    fn splat(value: f32) -> Self;
    fn load(lanes: &[f32; 8]) -> Self;
    fn store(self) -> [f32; 8];
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    /// The smaller; `other` where either is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger; `other` where either is NaN.
    fn max(self, other: Self) -> Self;
    fn lt(self, other: Self) -> u32;
    fn le(self, other: Self) -> u32;
}

/// Plain code.
#[derive(Clone, Copy)]
pub(super) struct Portable([f32; 8]);

impl Portable {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Portable(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f32, f32) -> bool) -> u32 {
        (0..8).fold(0, |bits, i| bits | u32::from(f(self.0[i], other.0[i])) << i)
    }
}

impl F32x8 for Portable {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Portable([value; 8])
    }
    #[inline(always)]
    fn load(lanes: &[f32; 8]) -> Self {
        Portable(*lanes)
    }
    #[inline(always)]
    fn store(self) -> [f32; 8] {
        self.0
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        self.compare(other, |a, b| a < b)
    }
    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        self.compare(other, |a, b| a <= b)
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use avx2::Avx2;

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::F32x8;
    use std::arch::x86_64::*;

    /// A 256-bit register. Values exist only inside functions that are compiled for AVX2 and
    /// called after the processor was found to have it: every block below relies on that.
    #[derive(Clone, Copy)]
    pub(in super::super) struct Avx2(__m256);

    impl F32x8 for Avx2 {
        #[inline(always)]
        fn splat(value: f32) -> Self {
            // SAFETY: AVX is present where an `Avx2` is made; see the type.
            Avx2(unsafe { _mm256_set1_ps(value) })
        }
        #[inline(always)]
        fn load(lanes: &[f32; 8]) -> Self {
            // SAFETY: AVX is present; the pointer covers eight floats and needs no alignment.
            Avx2(unsafe { _mm256_loadu_ps(lanes.as_ptr()) })
        }
        #[inline(always)]
        fn store(self) -> [f32; 8] {
            let mut lanes = [0.0; 8];
            // SAFETY: AVX is present; the pointer covers eight floats and needs no alignment.
            unsafe { _mm256_storeu_ps(lanes.as_mut_ptr(), self.0) };
            lanes
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: AVX is present where an `Avx2` exists.
            Avx2(unsafe { _mm256_sub_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: AVX is present where an `Avx2` exists.
            Avx2(unsafe { _mm256_mul_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            // SAFETY: AVX is present where an `Avx2` exists.
            Avx2(unsafe { _mm256_min_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            // SAFETY: AVX is present where an `Avx2` exists.
            Avx2(unsafe { _mm256_max_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn lt(self, other: Self) -> u32 {
            // SAFETY: AVX is present where an `Avx2` exists.
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)) as u32 }
        }
        #[inline(always)]
        fn le(self, other: Self) -> u32 {
            // SAFETY: AVX is present where an `Avx2` exists.
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) as u32 }
        }
    }

    #[cfg(test)]
    mod tests {
        use super::super::Portable;
        use super::*;

        /// Every operation on every pair of hostile values, NaN and signed zero among them.
        #[inline(always)]
        fn results<V: F32x8>(a: &[f32; 8], b: &[f32; 8]) -> ([[u32; 8]; 4], [u32; 2]) {
            let (a, b) = (V::load(a), V::load(b));
            let bits = |v: V| {
                v.store()
                    .map(|x| if x.is_nan() { 0x7fc0_0000 } else { x.to_bits() })
            };
            (
                [a.sub(b), a.mul(b), a.min(b), a.max(b)].map(bits),
                [a.lt(b), a.le(b)],
            )
        }

        #[target_feature(enable = "avx2")]
        fn with_avx2(a: &[f32; 8], b: &[f32; 8]) -> ([[u32; 8]; 4], [u32; 2]) {
            results::<Avx2>(a, b)
        }

        #[test]
        fn avx2_equals_portable_bit_for_bit() {
            if !is_x86_feature_detected!("avx2") {
                return;
            }
            let values = [
                0.0,
                -0.0,
                1.0,
                -1.5,
                1e-45,
                -1e-38,
                3.4e38,
                f32::INFINITY,
                f32::NEG_INFINITY,
                f32::NAN,
                0.1,
                7.0,
            ];
            for shift in 0..values.len() {
                let a = std::array::from_fn(|i| values[i % values.len()]);
                let b = std::array::from_fn(|i| values[(i + shift) % values.len()]);
                for (a, b) in [(a, b), (b, a)] {
                    // SAFETY: AVX2 was detected above.
                    let vector = unsafe { with_avx2(&a, &b) };
                    assert_eq!(vector, results::<Portable>(&a, &b));
                }
            }
        }
    }
}
