//! Lanes of floats: the operations that every instruction set has.

/// The number of rays of a packet, and of points that are shaded or looked up together.
pub const PACKET_WIDTH: usize = 16;

/// A mask with a bit for each lane of a packet.
pub(crate) const ALL_LANES: u32 = (1 << PACKET_WIDTH) - 1;

/// `N` lanes of `f32`. Comparisons give a mask with a bit for each lane and are false for NaN.
pub(crate) trait Floats<const N: usize>: Copy {
    fn splat(value: f32) -> Self;
    fn load(lanes: &[f32; N]) -> Self;
    fn store(self) -> [f32; N];
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn sqrt(self) -> Self;
    /// `self * factor - other`, rounded once or twice: the one operation whose bits depend on the
    /// processor, for conservative bounds that cover either.
    fn mul_sub(self, factor: Self, other: Self) -> Self;
    /// The smaller; `other` where either is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger; `other` where either is NaN.
    fn max(self, other: Self) -> Self;
    /// The minimum over all lanes, none of which is NaN.
    fn reduce_min(self) -> f32;
    /// The maximum over all lanes, none of which is NaN.
    fn reduce_max(self) -> f32;
    /// Zero in each lane whose absolute value is below `threshold`.
    fn zero_below(self, threshold: f32) -> Self;
    /// The absolute value of each lane with the sign of `sign`.
    fn copy_sign(self, sign: Self) -> Self;
    /// `yes` in the lanes where `self <= bound`, `no` in the others and for NaN.
    fn select_le(self, bound: Self, yes: Self, no: Self) -> Self;
    fn lt(self, other: Self) -> u32;
    fn le(self, other: Self) -> u32;

    /// The absolute value.
    #[inline(always)]
    fn abs(self) -> Self {
        self.max(Self::splat(0.0).sub(self))
    }
}
