//! Eight lanes of double precision: two registers with AVX2, one with AVX-512.
#![expect(
    unsafe_code,
    reason = "vector instructions; each block states why it is sound"
)]

use super::doubles::{Doubles, ORDERED_BITS};
use super::x86_64::Avx2Floats;
use std::arch::x86_64::*;

/// Two 256-bit registers, for AVX2.
///
/// Values exist only inside [`Kernel::run`](super::Kernel::run), compiled for the instructions and called only
/// where the processor has them: every `unsafe` block relies on that, here and below.
#[derive(Clone, Copy)]
pub(super) struct Avx2Doubles(__m256d, __m256d);

impl Doubles<8> for Avx2Doubles {
    type Floats = Avx2Floats;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: the instructions are present; see the type.
        let lanes = unsafe { _mm256_set1_pd(value) };
        Avx2Doubles(lanes, lanes)
    }
    #[inline(always)]
    fn widen(Avx2Floats(lanes): Avx2Floats) -> Self {
        // SAFETY: as above.
        unsafe {
            let (low, high) = (
                _mm256_castps256_ps128(lanes),
                _mm256_extractf128_ps::<1>(lanes),
            );
            Avx2Doubles(_mm256_cvtps_pd(low), _mm256_cvtps_pd(high))
        }
    }
    #[inline(always)]
    fn load(lanes: &[f64; 8]) -> Self {
        let (low, high) = lanes.split_at(4);
        // SAFETY: as above; each pointer covers four lanes and needs no alignment.
        unsafe {
            Avx2Doubles(
                _mm256_loadu_pd(low.as_ptr()),
                _mm256_loadu_pd(high.as_ptr()),
            )
        }
    }
    #[inline(always)]
    fn store(self) -> [f64; 8] {
        let mut lanes = [0.0; 8];
        let (low, high) = lanes.split_at_mut(4);
        // SAFETY: as above; each pointer covers four lanes and needs no alignment.
        unsafe {
            _mm256_storeu_pd(low.as_mut_ptr(), self.0);
            _mm256_storeu_pd(high.as_mut_ptr(), self.1);
        }
        lanes
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: as above.
        unsafe {
            Avx2Doubles(
                _mm256_add_pd(self.0, other.0),
                _mm256_add_pd(self.1, other.1),
            )
        }
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: as above.
        unsafe {
            Avx2Doubles(
                _mm256_sub_pd(self.0, other.0),
                _mm256_sub_pd(self.1, other.1),
            )
        }
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: as above.
        unsafe {
            Avx2Doubles(
                _mm256_mul_pd(self.0, other.0),
                _mm256_mul_pd(self.1, other.1),
            )
        }
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: as above.
        unsafe {
            Avx2Doubles(
                _mm256_div_pd(self.0, other.0),
                _mm256_div_pd(self.1, other.1),
            )
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: as above.
        unsafe {
            Avx2Doubles(
                _mm256_max_pd(self.0, other.0),
                _mm256_max_pd(self.1, other.1),
            )
        }
    }
    #[inline(always)]
    fn round_for_order(self) -> Self {
        // SAFETY: as above.
        unsafe {
            let mask = _mm256_castsi256_pd(_mm256_set1_epi64x(ORDERED_BITS as i64));
            Avx2Doubles(_mm256_and_pd(self.0, mask), _mm256_and_pd(self.1, mask))
        }
    }
    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        // SAFETY: as above.
        unsafe {
            let low = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0));
            let high = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.1, other.1));
            (low | high << 4) as u32
        }
    }
    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        // SAFETY: as above.
        unsafe {
            let low = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0));
            let high = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(self.1, other.1));
            (low | high << 4) as u32
        }
    }
}

/// A 512-bit register, for AVX-512 F.
#[derive(Clone, Copy)]
pub(super) struct Avx512Doubles(__m512d);

impl Doubles<8> for Avx512Doubles {
    type Floats = Avx2Floats;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: the instructions are present; see `Avx2Doubles`.
        Avx512Doubles(unsafe { _mm512_set1_pd(value) })
    }
    #[inline(always)]
    fn widen(Avx2Floats(lanes): Avx2Floats) -> Self {
        // SAFETY: as above.
        Avx512Doubles(unsafe { _mm512_cvtps_pd(lanes) })
    }
    #[inline(always)]
    fn load(lanes: &[f64; 8]) -> Self {
        // SAFETY: as above; the pointer covers all lanes and needs no alignment.
        Avx512Doubles(unsafe { _mm512_loadu_pd(lanes.as_ptr()) })
    }
    #[inline(always)]
    fn store(self) -> [f64; 8] {
        let mut lanes = [0.0; 8];
        // SAFETY: as above; the pointer covers all lanes and needs no alignment.
        unsafe { _mm512_storeu_pd(lanes.as_mut_ptr(), self.0) };
        lanes
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: as above.
        Avx512Doubles(unsafe { _mm512_add_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: as above.
        Avx512Doubles(unsafe { _mm512_sub_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: as above.
        Avx512Doubles(unsafe { _mm512_mul_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: as above.
        Avx512Doubles(unsafe { _mm512_div_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: as above.
        Avx512Doubles(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn round_for_order(self) -> Self {
        // SAFETY: as above.
        unsafe {
            let mask = _mm512_castsi512_pd(_mm512_set1_epi64(ORDERED_BITS as i64));
            Avx512Doubles(_mm512_and_pd(self.0, mask))
        }
    }
    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        // SAFETY: as above.
        unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0).into() }
    }
    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        // SAFETY: as above.
        unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0).into() }
    }
}
