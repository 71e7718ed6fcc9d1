//! Cubic Hermite curves through numbers, vectors and rotations.

use super::rotation::{exp, log};
use glam::{DQuat, DVec3};
use std::fmt::Debug;
use std::ops::{Add, Mul};

/// A value that can be interpolated.
pub(super) trait Interpolable: Copy + Debug {
    /// Differences of values and derivatives of curves through them: a real vector space.
    type Tangent: Copy + Debug + Add<Output = Self::Tangent> + Mul<f64, Output = Self::Tangent>;

    /// The step from this value to another.
    fn step_to(self, other: Self) -> Self::Tangent;

    /// The length of a step.
    fn length(step: Self::Tangent) -> f64;

    /// The inner product of two steps.
    fn dot(a: Self::Tangent, b: Self::Tangent) -> f64;

    /// The point at parameter `s` in [0, 1] of the cubic Hermite curve from here by `step`, with derivatives `start`
    /// and `end` at its ends.
    fn cubic(self, step: Self::Tangent, start: Self::Tangent, end: Self::Tangent, s: f64) -> Self;
}

/// The Hermite basis: the weights of step, start and end derivative.
pub(super) fn hermite_basis(s: f64) -> [f64; 3] {
    let t = 1.0 - s;
    [s * s * (3.0 - 2.0 * s), s * t * t, -s * s * t]
}

/// The offset from the start of a cubic in a vector space.
fn offset<T: Copy + Add<Output = T> + Mul<f64, Output = T>>(
    step: T,
    start: T,
    end: T,
    s: f64,
) -> T {
    let [a, b, c] = hermite_basis(s);
    step * a + (start * b + end * c)
}

impl Interpolable for f64 {
    type Tangent = f64;

    fn step_to(self, other: f64) -> f64 {
        other - self
    }

    fn length(step: f64) -> f64 {
        step.abs()
    }

    fn dot(a: f64, b: f64) -> f64 {
        a * b
    }

    fn cubic(self, step: f64, start: f64, end: f64, s: f64) -> f64 {
        self + offset(step, start, end, s)
    }
}

impl Interpolable for DVec3 {
    type Tangent = DVec3;

    fn step_to(self, other: DVec3) -> DVec3 {
        other - self
    }

    fn length(step: DVec3) -> f64 {
        step.length()
    }

    fn dot(a: DVec3, b: DVec3) -> f64 {
        a.dot(b)
    }

    fn cubic(self, step: DVec3, start: DVec3, end: DVec3, s: f64) -> DVec3 {
        self + offset(step, start, end, s)
    }
}

/// Rotations, by unit quaternions of either sign. Steps are rotation vectors of less than half a turn, derivatives
/// are angular velocities, both in the coordinates of the rotated body.
impl Interpolable for DQuat {
    type Tangent = DVec3;

    fn step_to(self, other: DQuat) -> DVec3 {
        log(self.conjugate() * other)
    }

    fn length(step: DVec3) -> f64 {
        step.length()
    }

    fn dot(a: DVec3, b: DVec3) -> f64 {
        a.dot(b)
    }

    /// The Bézier curve in cumulative form (Kim, Kim and Shin 1995, "A General Construction Scheme for Unit
    /// Quaternion Curves with Simple High Order Derivatives", section 4.1): its angular velocities at the ends are
    /// the given ones. Along one axis it is the cubic of the angle.
    fn cubic(self, step: DVec3, start: DVec3, end: DVec3, s: f64) -> DQuat {
        let (first, last) = (start / 3.0, end / 3.0);
        let middle = log(exp(-first) * exp(step) * exp(-last));
        let t = 1.0 - s;
        let turned = exp(first * (1.0 - t * t * t)) * exp(middle * (s * s * (3.0 - 2.0 * s)));
        (self * turned * exp(last * (s * s * s))).normalize()
    }
}
