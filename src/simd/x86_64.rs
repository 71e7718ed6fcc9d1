//! Lanes in one vector register: eight with AVX2, sixteen with AVX-512.
#![expect(
    unsafe_code,
    reason = "vector instructions; each block states why it is sound"
)]

use super::floats::Floats;
use std::arch::x86_64::*;

/// Defines lanes in one register. Values exist only inside [`Kernel::run`](super::Kernel::run), compiled for the
/// instructions and called only where the processor has them: every `unsafe` block relies on that.
macro_rules! register {
    ($(#[$doc:meta])* $name:ident, $register:ty, $lanes:literal,
     $set1:ident, $load:ident, $store:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $sqrt:ident, $mul_sub:ident,
     $min:ident, $max:ident, $reduce_min:ident, $reduce_max:ident, |$a:ident, $b:ident| $lt:expr, $le:expr, $zero_below:expr, $copy_sign:expr,
     |$yes:ident, $no:ident| $select_le:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub(super) struct $name(pub(super) $register);

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
            fn reduce_min(self) -> f32 {
                // SAFETY: the instructions are present; see the macro.
                unsafe { $reduce_min(self.0) }
            }
            #[inline(always)]
            fn reduce_max(self) -> f32 {
                // SAFETY: the instructions are present; see the macro.
                unsafe { $reduce_max(self.0) }
            }
            #[inline(always)]
            fn zero_below(self, threshold: f32) -> Self {
                let ($a, $b) = (self.0, Self::splat(threshold).0);
                // SAFETY: the instructions are present; see the macro.
                $name(unsafe { $zero_below })
            }
            #[inline(always)]
            fn copy_sign(self, sign: Self) -> Self {
                let ($a, $b) = (self.0, sign.0);
                // SAFETY: the instructions are present; see the macro.
                $name(unsafe { $copy_sign })
            }
            #[inline(always)]
            fn select_le(self, bound: Self, yes: Self, no: Self) -> Self {
                let ($a, $b, $yes, $no) = (self.0, bound.0, yes.0, no.0);
                // SAFETY: the instructions are present; see the macro.
                $name(unsafe { $select_le })
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
fn reduce_min(lanes: __m256) -> f32 {
    let lanes = _mm_min_ps(
        _mm256_castps256_ps128(lanes),
        _mm256_extractf128_ps::<1>(lanes),
    );
    let lanes = _mm_min_ps(lanes, _mm_movehl_ps(lanes, lanes));
    _mm_cvtss_f32(_mm_min_ss(lanes, _mm_shuffle_ps::<1>(lanes, lanes)))
}

#[inline]
#[target_feature(enable = "avx2")]
fn reduce_max(lanes: __m256) -> f32 {
    let lanes = _mm_max_ps(
        _mm256_castps256_ps128(lanes),
        _mm256_extractf128_ps::<1>(lanes),
    );
    let lanes = _mm_max_ps(lanes, _mm_movehl_ps(lanes, lanes));
    _mm_cvtss_f32(_mm_max_ss(lanes, _mm_shuffle_ps::<1>(lanes, lanes)))
}

register!(
    /// A 256-bit register, for AVX2 and FMA.
    Avx2Floats, __m256, 8,
    _mm256_set1_ps, _mm256_loadu_ps, _mm256_storeu_ps, _mm256_add_ps, _mm256_sub_ps, _mm256_mul_ps,
    _mm256_div_ps, _mm256_sqrt_ps, _mm256_fmsub_ps, _mm256_min_ps, _mm256_max_ps, reduce_min, reduce_max,
    |a, b| _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b)) as u32,
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32,
    {
        let abs = _mm256_andnot_ps(_mm256_set1_ps(-0.0), a);
        _mm256_andnot_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(abs, b), a)
    },
    {
        let sign = _mm256_set1_ps(-0.0);
        _mm256_or_ps(_mm256_andnot_ps(sign, a), _mm256_and_ps(sign, b))
    },
    |yes, no| _mm256_blendv_ps(no, yes, _mm256_cmp_ps::<_CMP_LE_OQ>(a, b))
);

register!(
    /// A 512-bit register, for AVX-512 F and DQ.
    Avx512Floats, __m512, 16,
    _mm512_set1_ps, _mm512_loadu_ps, _mm512_storeu_ps, _mm512_add_ps, _mm512_sub_ps, _mm512_mul_ps,
    _mm512_div_ps, _mm512_sqrt_ps, _mm512_fmsub_ps, _mm512_min_ps, _mm512_max_ps, _mm512_reduce_min_ps, _mm512_reduce_max_ps,
    |a, b| _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b).into(),
    _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b).into(),
    _mm512_maskz_mov_ps(!_mm512_cmp_ps_mask::<_CMP_LT_OQ>(_mm512_abs_ps(a), b), a),
    {
        let sign = _mm512_set1_ps(-0.0);
        _mm512_or_ps(_mm512_andnot_ps(sign, a), _mm512_and_ps(sign, b))
    },
    |yes, no| _mm512_mask_blend_ps(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b), no, yes)
);

impl Avx2Floats {
    /// Columns from rows.
    #[inline(always)]
    pub(super) fn transpose([a, b, c, d, e, f, g, h]: [Avx2Floats; 8]) -> [Avx2Floats; 8] {
        let (a, b, c, d) = (a.0, b.0, c.0, d.0);
        let (e, f, g, h) = (e.0, f.0, g.0, h.0);
        // SAFETY: the instructions are present; see the macro.
        unsafe {
            // Pairs of rows, then fours, in each half of the registers; then the halves.
            let (ab, ab_high) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
            let (cd, cd_high) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
            let (ef, ef_high) = (_mm256_unpacklo_ps(e, f), _mm256_unpackhi_ps(e, f));
            let (gh, gh_high) = (_mm256_unpacklo_ps(g, h), _mm256_unpackhi_ps(g, h));
            let first = [
                _mm256_shuffle_ps::<0x44>(ab, cd),
                _mm256_shuffle_ps::<0xee>(ab, cd),
                _mm256_shuffle_ps::<0x44>(ab_high, cd_high),
                _mm256_shuffle_ps::<0xee>(ab_high, cd_high),
            ];
            let last = [
                _mm256_shuffle_ps::<0x44>(ef, gh),
                _mm256_shuffle_ps::<0xee>(ef, gh),
                _mm256_shuffle_ps::<0x44>(ef_high, gh_high),
                _mm256_shuffle_ps::<0xee>(ef_high, gh_high),
            ];
            [
                Avx2Floats(_mm256_permute2f128_ps::<0x20>(first[0], last[0])),
                Avx2Floats(_mm256_permute2f128_ps::<0x20>(first[1], last[1])),
                Avx2Floats(_mm256_permute2f128_ps::<0x20>(first[2], last[2])),
                Avx2Floats(_mm256_permute2f128_ps::<0x20>(first[3], last[3])),
                Avx2Floats(_mm256_permute2f128_ps::<0x31>(first[0], last[0])),
                Avx2Floats(_mm256_permute2f128_ps::<0x31>(first[1], last[1])),
                Avx2Floats(_mm256_permute2f128_ps::<0x31>(first[2], last[2])),
                Avx2Floats(_mm256_permute2f128_ps::<0x31>(first[3], last[3])),
            ]
        }
    }
}

impl Avx512Floats {
    /// The lanes of `low`, then those of `high`.
    #[inline(always)]
    pub(super) fn join(low: Avx2Floats, high: Avx2Floats) -> Avx512Floats {
        // SAFETY: the instructions are present; see the macro.
        Avx512Floats(unsafe { _mm512_insertf32x8::<1>(_mm512_castps256_ps512(low.0), high.0) })
    }
}

/// Asks for all cache lines of a value.
#[inline(always)]
pub(super) fn prefetch<T>(value: &T) {
    let first = std::ptr::from_ref(value).cast::<i8>();
    for line in 0..size_of::<T>().div_ceil(64) {
        // SAFETY: the instruction is present on every x86-64 processor, and reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(first.wrapping_add(64 * line)) };
    }
}
