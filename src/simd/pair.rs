//! Sixteen lanes in two AVX2 registers.

use super::floats::Floats;
use super::x86_64::Avx2Floats;

/// Two 256-bit registers.
#[derive(Clone, Copy)]
pub(super) struct Avx2FloatsPair(Avx2Floats, Avx2Floats);

impl Avx2FloatsPair {
    #[inline(always)]
    pub(super) fn join(low: Avx2Floats, high: Avx2Floats) -> Avx2FloatsPair {
        Avx2FloatsPair(low, high)
    }
}

impl Floats<16> for Avx2FloatsPair {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Avx2FloatsPair(Avx2Floats::splat(value), Avx2Floats::splat(value))
    }
    #[inline(always)]
    fn load(lanes: &[f32; 16]) -> Self {
        let [low, high] = lanes.as_chunks::<8>().0 else {
            unreachable!()
        };
        Avx2FloatsPair(Avx2Floats::load(low), Avx2Floats::load(high))
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
        Avx2FloatsPair(self.0.add(other.0), self.1.add(other.1))
    }
    #[inline(always)]
    fn reduce_min(self) -> f32 {
        self.0.min(self.1).reduce_min()
    }
    #[inline(always)]
    fn reduce_max(self) -> f32 {
        self.0.max(self.1).reduce_max()
    }
    #[inline(always)]
    fn zero_below(self, threshold: f32) -> Self {
        Avx2FloatsPair(self.0.zero_below(threshold), self.1.zero_below(threshold))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Avx2FloatsPair(self.0.sub(other.0), self.1.sub(other.1))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Avx2FloatsPair(self.0.mul(other.0), self.1.mul(other.1))
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Avx2FloatsPair(self.0.div(other.0), self.1.div(other.1))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Avx2FloatsPair(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn mul_sub(self, factor: Self, other: Self) -> Self {
        Avx2FloatsPair(
            self.0.mul_sub(factor.0, other.0),
            self.1.mul_sub(factor.1, other.1),
        )
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Avx2FloatsPair(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Avx2FloatsPair(self.0.max(other.0), self.1.max(other.1))
    }
    #[inline(always)]
    fn copy_sign(self, sign: Self) -> Self {
        Avx2FloatsPair(self.0.copy_sign(sign.0), self.1.copy_sign(sign.1))
    }
    #[inline(always)]
    fn select_le(self, bound: Self, yes: Self, no: Self) -> Self {
        Avx2FloatsPair(
            self.0.select_le(bound.0, yes.0, no.0),
            self.1.select_le(bound.1, yes.1, no.1),
        )
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
