//! Several floats at once, with the same bits on every processor.
//!
//! Kernels are written once over [`Floats`]. [`Portable`] is plain code for any machine; the others are
//! the same arithmetic in registers, and may only be used inside functions compiled for their
//! instructions. Apart from [`Floats::mul_sub`] nothing is fused, so all round alike.
#![expect(
    unsafe_code,
    reason = "vector instructions; each block states why it is sound"
)]

use super::PACKET;

/// `N` lanes of `f32`. Comparisons give a bit for each lane and are false for NaN.
pub(super) trait Floats<const N: usize>: Copy {
    fn splat(value: f32) -> Self;
    fn load(lanes: &[f32; N]) -> Self;
    fn store(self) -> [f32; N];
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn sqrt(self) -> Self;
    /// `self * factor - other`, rounded once or twice: the one operation whose bits depend on the
    /// processor, for bounds that cover either.
    fn mul_sub(self, factor: Self, other: Self) -> Self;
    /// The smaller; `other` where either is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger; `other` where either is NaN.
    fn max(self, other: Self) -> Self;
    /// The least of all lanes, none of which is NaN.
    fn least(self) -> f32;
    /// The greatest of all lanes, none of which is NaN.
    fn greatest(self) -> f32;
    /// Zero in place of what is closer to zero than `threshold`.
    fn zero_below(self, threshold: f32) -> Self;
    fn lt(self, other: Self) -> u32;
    fn le(self, other: Self) -> u32;
}

/// The registers of a kernel: for one ray and eight boxes or triangles, and for a packet of rays.
pub(super) trait Machine {
    type One: Floats<8>;
    type Many: Floats<PACKET>;
}

/// Plain code.
#[derive(Clone, Copy)]
pub(super) struct Portable<const N: usize>([f32; N]);

impl<const N: usize> Portable<N> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Portable(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f32, f32) -> bool) -> u32 {
        (0..N).fold(0, |bits, i| bits | u32::from(f(self.0[i], other.0[i])) << i)
    }
}

impl<const N: usize> Floats<N> for Portable<N> {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Portable([value; N])
    }
    #[inline(always)]
    fn load(lanes: &[f32; N]) -> Self {
        Portable(*lanes)
    }
    #[inline(always)]
    fn store(self) -> [f32; N] {
        self.0
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
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
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.zip(self, |a, _| a.sqrt())
    }
    #[inline(always)]
    fn mul_sub(self, factor: Self, other: Self) -> Self {
        self.mul(factor).sub(other)
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
    fn least(self) -> f32 {
        self.0.into_iter().fold(f32::INFINITY, f32::min)
    }
    #[inline(always)]
    fn greatest(self) -> f32 {
        self.0.into_iter().fold(f32::NEG_INFINITY, f32::max)
    }
    #[inline(always)]
    fn zero_below(self, threshold: f32) -> Self {
        self.zip(self, |a, _| if a.abs() < threshold { 0.0 } else { a })
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
pub(super) use x86_64::{Avx2, Avx2Pair, Avx512};

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use super::Floats;
    use std::arch::x86_64::*;

    /// A type of lanes in one register. Values exist only inside functions that are compiled for
    /// the instructions and called after the processor was found to have them: every block relies
    /// on that.
    macro_rules! register {
        ($(#[$doc:meta])* $name:ident, $register:ty, $lanes:literal,
         $set1:ident, $load:ident, $store:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $sqrt:ident, $mul_sub:ident,
         $min:ident, $max:ident, $least:ident, $greatest:ident, |$a:ident, $b:ident| $lt:expr, $le:expr, $zero_below:expr) => {
            $(#[$doc])*
            #[derive(Clone, Copy)]
            pub(in super::super) struct $name($register);

            impl Floats<$lanes> for $name {
                #[inline(always)]
                fn splat(value: f32) -> Self {
                    // SAFETY: the instructions are present; see the macro.
                    $name(unsafe { $set1(value) })
                }
                #[inline(always)]
                fn load(lanes: &[f32; $lanes]) -> Self {
                    // SAFETY: as above; the pointer covers all lanes and needs no alignment.
                    $name(unsafe { $load(lanes.as_ptr()) })
                }
                #[inline(always)]
                fn store(self) -> [f32; $lanes] {
                    let mut lanes = [0.0; $lanes];
                    // SAFETY: as above; the pointer covers all lanes and needs no alignment.
                    unsafe { $store(lanes.as_mut_ptr(), self.0) };
                    lanes
                }
                #[inline(always)]
                fn add(self, other: Self) -> Self {
                    // SAFETY: the instructions are present; see the macro.
                    $name(unsafe { $add(self.0, other.0) })
                }
                #[inline(always)]
                fn least(self) -> f32 {
                    // SAFETY: the instructions are present; see the macro.
                    unsafe { $least(self.0) }
                }
                #[inline(always)]
                fn greatest(self) -> f32 {
                    // SAFETY: the instructions are present; see the macro.
                    unsafe { $greatest(self.0) }
                }
                #[inline(always)]
                fn zero_below(self, threshold: f32) -> Self {
                    let ($a, $b) = (self.0, Self::splat(threshold).0);
                    // SAFETY: the instructions are present; see the macro.
                    $name(unsafe { $zero_below })
                }
                #[inline(always)]
                fn sub(self, other: Self) -> Self {
                    // SAFETY: the instructions are present; see the macro.
                    $name(unsafe { $sub(self.0, other.0) })
                }
                #[inline(always)]
                fn mul(self, other: Self) -> Self {
                    // SAFETY: the instructions are present; see the macro.
                    $name(unsafe { $mul(self.0, other.0) })
                }
                #[inline(always)]
                fn div(self, other: Self) -> Self {
                    // SAFETY: the instructions are present; see the macro.
                    $name(unsafe { $div(self.0, other.0) })
                }
                #[inline(always)]
                fn sqrt(self) -> Self {
                    // SAFETY: the instructions are present; see the macro.
                    $name(unsafe { $sqrt(self.0) })
                }
                #[inline(always)]
                fn mul_sub(self, factor: Self, other: Self) -> Self {
                    // SAFETY: the instructions are present; see the macro.
                    $name(unsafe { $mul_sub(self.0, factor.0, other.0) })
                }
                #[inline(always)]
                fn min(self, other: Self) -> Self {
                    // SAFETY: the instructions are present; see the macro.
                    $name(unsafe { $min(self.0, other.0) })
                }
                #[inline(always)]
                fn max(self, other: Self) -> Self {
                    // SAFETY: the instructions are present; see the macro.
                    $name(unsafe { $max(self.0, other.0) })
                }
                #[inline(always)]
                fn lt(self, other: Self) -> u32 {
                    let ($a, $b) = (self.0, other.0);
                    // SAFETY: the instructions are present; see the macro.
                    unsafe { $lt }
                }
                #[inline(always)]
                fn le(self, other: Self) -> u32 {
                    let ($a, $b) = (self.0, other.0);
                    // SAFETY: the instructions are present; see the macro.
                    unsafe { $le }
                }
            }
        };
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn least(lanes: __m256) -> f32 {
        let lanes = _mm_min_ps(
            _mm256_castps256_ps128(lanes),
            _mm256_extractf128_ps::<1>(lanes),
        );
        let lanes = _mm_min_ps(lanes, _mm_movehl_ps(lanes, lanes));
        _mm_cvtss_f32(_mm_min_ss(lanes, _mm_shuffle_ps::<1>(lanes, lanes)))
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn greatest(lanes: __m256) -> f32 {
        let lanes = _mm_max_ps(
            _mm256_castps256_ps128(lanes),
            _mm256_extractf128_ps::<1>(lanes),
        );
        let lanes = _mm_max_ps(lanes, _mm_movehl_ps(lanes, lanes));
        _mm_cvtss_f32(_mm_max_ss(lanes, _mm_shuffle_ps::<1>(lanes, lanes)))
    }

    register!(
        /// A 256-bit register, for AVX2 and FMA.
        Avx2, __m256, 8,
        _mm256_set1_ps, _mm256_loadu_ps, _mm256_storeu_ps, _mm256_add_ps, _mm256_sub_ps, _mm256_mul_ps,
        _mm256_div_ps, _mm256_sqrt_ps, _mm256_fmsub_ps, _mm256_min_ps, _mm256_max_ps, least, greatest,
        |a, b| _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b)) as u32,
        _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32,
        {
            let size = _mm256_andnot_ps(_mm256_set1_ps(-0.0), a);
            _mm256_andnot_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(size, b), a)
        }
    );

    register!(
        /// A 512-bit register, for AVX-512 F.
        Avx512, __m512, 16,
        _mm512_set1_ps, _mm512_loadu_ps, _mm512_storeu_ps, _mm512_add_ps, _mm512_sub_ps, _mm512_mul_ps,
        _mm512_div_ps, _mm512_sqrt_ps, _mm512_fmsub_ps, _mm512_min_ps, _mm512_max_ps, _mm512_reduce_min_ps, _mm512_reduce_max_ps,
        |a, b| _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b).into(),
        _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b).into(),
        _mm512_maskz_mov_ps(!_mm512_cmp_ps_mask::<_CMP_LT_OQ>(_mm512_abs_ps(a), b), a)
    );

    /// Two 256-bit registers.
    #[derive(Clone, Copy)]
    pub(in super::super) struct Avx2Pair(Avx2, Avx2);

    impl Floats<16> for Avx2Pair {
        #[inline(always)]
        fn splat(value: f32) -> Self {
            Avx2Pair(Avx2::splat(value), Avx2::splat(value))
        }
        #[inline(always)]
        fn load(lanes: &[f32; 16]) -> Self {
            let [low, high] = lanes.as_chunks::<8>().0 else {
                unreachable!()
            };
            Avx2Pair(Avx2::load(low), Avx2::load(high))
        }
        #[inline(always)]
        fn store(self) -> [f32; 16] {
            let mut lanes = [0.0; 16];
            lanes[..8].copy_from_slice(&self.0.store());
            lanes[8..].copy_from_slice(&self.1.store());
            lanes
        }
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            Avx2Pair(self.0.add(other.0), self.1.add(other.1))
        }
        #[inline(always)]
        fn least(self) -> f32 {
            self.0.min(self.1).least()
        }
        #[inline(always)]
        fn greatest(self) -> f32 {
            self.0.max(self.1).greatest()
        }
        #[inline(always)]
        fn zero_below(self, threshold: f32) -> Self {
            Avx2Pair(self.0.zero_below(threshold), self.1.zero_below(threshold))
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            Avx2Pair(self.0.sub(other.0), self.1.sub(other.1))
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            Avx2Pair(self.0.mul(other.0), self.1.mul(other.1))
        }
        #[inline(always)]
        fn div(self, other: Self) -> Self {
            Avx2Pair(self.0.div(other.0), self.1.div(other.1))
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Avx2Pair(self.0.sqrt(), self.1.sqrt())
        }
        #[inline(always)]
        fn mul_sub(self, factor: Self, other: Self) -> Self {
            Avx2Pair(
                self.0.mul_sub(factor.0, other.0),
                self.1.mul_sub(factor.1, other.1),
            )
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Avx2Pair(self.0.min(other.0), self.1.min(other.1))
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Avx2Pair(self.0.max(other.0), self.1.max(other.1))
        }
        #[inline(always)]
        fn lt(self, other: Self) -> u32 {
            self.0.lt(other.0) | self.1.lt(other.1) << 8
        }
        #[inline(always)]
        fn le(self, other: Self) -> u32 {
            self.0.le(other.0) | self.1.le(other.1) << 8
        }
    }

    #[cfg(test)]
    mod tests {
        use super::super::Portable;
        use super::*;

        const HOSTILE: [f32; 12] = [
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

        /// Every operation whose bits are promised.
        #[inline(always)]
        fn results<V: Floats<N>, const N: usize>(
            a: &[f32; N],
            b: &[f32; N],
        ) -> ([[u32; N]; 9], [u32; 2]) {
            let (a, b) = (V::load(a), V::load(b));
            let bits = |v: V| {
                v.store()
                    .map(|x| if x.is_nan() { 0x7fc0_0000 } else { x.to_bits() })
            };
            (
                [
                    a.add(b),
                    a.sub(b),
                    a.mul(b),
                    a.div(b),
                    a.sqrt(),
                    a.min(b),
                    a.max(b),
                    a.zero_below(0.5),
                    b.zero_below(1e-40),
                ]
                .map(bits),
                [a.lt(b), a.le(b)],
            )
        }

        /// Applies `check` to lanes of every pair of hostile values.
        fn each_pair<const N: usize>(check: impl Fn(&[f32; N], &[f32; N])) {
            for shift in 0..HOSTILE.len() {
                for start in 0..HOSTILE.len() {
                    let a = std::array::from_fn(|i| HOSTILE[(i + start) % HOSTILE.len()]);
                    let b = std::array::from_fn(|i| HOSTILE[(i + start + shift) % HOSTILE.len()]);
                    check(&a, &b);
                }
            }
        }

        #[target_feature(enable = "avx2,fma")]
        fn with_avx2(a: &[f32; 8], b: &[f32; 8]) -> ([[u32; 8]; 9], [u32; 2]) {
            results::<Avx2, 8>(a, b)
        }

        #[target_feature(enable = "avx2,fma")]
        fn with_pair(a: &[f32; 16], b: &[f32; 16]) -> ([[u32; 16]; 9], [u32; 2]) {
            results::<Avx2Pair, 16>(a, b)
        }

        #[target_feature(enable = "avx512f")]
        fn with_avx512(a: &[f32; 16], b: &[f32; 16]) -> ([[u32; 16]; 9], [u32; 2]) {
            results::<Avx512, 16>(a, b)
        }

        #[test]
        fn avx2_equals_portable_bit_for_bit() {
            if !is_x86_feature_detected!("avx2") || !is_x86_feature_detected!("fma") {
                return;
            }
            each_pair(|a, b| {
                // SAFETY: AVX2 and FMA were detected above.
                let vector = unsafe { with_avx2(a, b) };
                assert_eq!(vector, results::<Portable<8>, 8>(a, b));
            });
            each_pair(|a, b| {
                // SAFETY: AVX2 and FMA were detected above.
                let vector = unsafe { with_pair(a, b) };
                assert_eq!(vector, results::<Portable<16>, 16>(a, b));
            });
        }

        #[test]
        fn avx512_equals_portable_bit_for_bit() {
            if !is_x86_feature_detected!("avx512f") {
                return;
            }
            each_pair(|a, b| {
                // SAFETY: AVX-512 F was detected above.
                let vector = unsafe { with_avx512(a, b) };
                assert_eq!(vector, results::<Portable<16>, 16>(a, b));
            });
        }
    }
}
