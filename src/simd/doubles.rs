//! Lanes of double precision: the few operations of exact distances.

use super::floats::Floats;

/// The bits that [`Doubles::round_for_order`] keeps.
pub(super) const ORDERED_BITS: u64 = !0 << 24;

/// `N` lanes of `f64`. Comparisons give a mask with a bit for each lane and are false for NaN.
pub(crate) trait Doubles<const N: usize>: Copy {
    /// The same number of lanes in single precision.
    type Floats: Floats<N>;

    fn splat(value: f64) -> Self;
    fn widen(floats: Self::Floats) -> Self;
    fn load(lanes: &[f64; N]) -> Self;
    fn store(self) -> [f64; N];
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    /// The larger; `other` where either is NaN.
    fn max(self, other: Self) -> Self;
    /// With the lowest 24 bits of the significand zero: rounded towards zero to a relative 2^-28.
    fn round_for_order(self) -> Self;
    fn lt(self, other: Self) -> u32;
    fn le(self, other: Self) -> u32;
}
