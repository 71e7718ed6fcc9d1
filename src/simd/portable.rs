//! Lanes in an array, without vector instructions.

use super::doubles::{Doubles, ORDERED_BITS};
use super::floats::Floats;

/// `N` lanes in an array.
#[derive(Clone, Copy)]
pub(crate) struct PortableLanes<T, const N: usize>([T; N]);

/// `N` lanes of single precision.
pub(crate) type PortableFloats<const N: usize> = PortableLanes<f32, N>;

/// `N` lanes of double precision.
pub(crate) type PortableDoubles<const N: usize> = PortableLanes<f64, N>;

/// One lane.
pub(crate) type Scalar = PortableFloats<1>;

impl<T: Copy, const N: usize> PortableLanes<T, N> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        PortableLanes(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(T, T) -> bool) -> u32 {
        (0..N).fold(0, |bits, i| bits | u32::from(f(self.0[i], other.0[i])) << i)
    }
}

impl PortableFloats<8> {
    #[inline(always)]
    pub(super) fn transpose(rows: [Self; 8]) -> [Self; 8] {
        std::array::from_fn(|column| PortableLanes(rows.map(|row| row.0[column])))
    }

    #[inline(always)]
    pub(super) fn join(low: Self, high: Self) -> PortableFloats<16> {
        PortableLanes(std::array::from_fn(|i| {
            if i < 8 { low.0[i] } else { high.0[i - 8] }
        }))
    }
}

impl<const N: usize> Floats<N> for PortableFloats<N> {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        PortableLanes([value; N])
    }
    #[inline(always)]
    fn load(lanes: &[f32; N]) -> Self {
        PortableLanes(*lanes)
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
    fn copy_sign(self, sign: Self) -> Self {
        self.zip(sign, f32::copysign)
    }
    #[inline(always)]
    fn select_le(self, bound: Self, yes: Self, no: Self) -> Self {
        let select = |i| match self.0[i] <= bound.0[i] {
            true => yes.0[i],
            false => no.0[i],
        };
        PortableLanes(std::array::from_fn(select))
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

/// One lane of double precision.
pub(crate) type ScalarDouble = PortableDoubles<1>;

impl<const N: usize> Doubles<N> for PortableDoubles<N> {
    type Floats = PortableFloats<N>;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        PortableLanes([value; N])
    }
    #[inline(always)]
    fn widen(floats: PortableFloats<N>) -> Self {
        PortableLanes(floats.0.map(f64::from))
    }
    #[inline(always)]
    fn load(lanes: &[f64; N]) -> Self {
        PortableLanes(*lanes)
    }
    #[inline(always)]
    fn store(self) -> [f64; N] {
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
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn round_for_order(self) -> Self {
        PortableLanes(self.0.map(|t| f64::from_bits(t.to_bits() & ORDERED_BITS)))
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
