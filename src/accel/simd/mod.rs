//! Several floats at once, with the same bits on every processor.
//!
//! Kernels are written once over [`Floats`]. [`Portable`] is plain code for any machine; the others are
//! the same arithmetic in registers, and may only be used inside functions compiled for their
//! instructions. Apart from [`Floats::mul_sub`] nothing is fused, so all round alike.

#[cfg(target_arch = "x86_64")]
mod pair;
mod portable;
#[cfg(target_arch = "x86_64")]
mod x86_64;

use super::PACKET;
#[cfg(target_arch = "x86_64")]
pub(super) use pair::Avx2Pair;
pub(super) use portable::Portable;
#[cfg(target_arch = "x86_64")]
pub(super) use x86_64::{Avx2, Avx512};

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

#[cfg(all(test, target_arch = "x86_64"))]
mod tests;
