//! Lanes in an array, without vector instructions.

use super::floats::Floats;

/// `N` lanes in an array.
#[derive(Clone, Copy)]
pub(super) struct PortableFloats<const N: usize>([f32; N]);

impl<const N: usize> PortableFloats<N> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        PortableFloats(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f32, f32) -> bool) -> u32 {
        (0..N).fold(0, |bits, i| bits | u32::from(f(self.0[i], other.0[i])) << i)
    }
}

impl<const N: usize> Floats<N> for PortableFloats<N> {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        PortableFloats([value; N])
    }
    #[inline(always)]
    fn load(lanes: &[f32; N]) -> Self {
        PortableFloats(*lanes)
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
    fn reduce_min(self) -> f32 {
        self.0.into_iter().fold(f32::INFINITY, f32::min)
    }
    #[inline(always)]
    fn reduce_max(self) -> f32 {
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
