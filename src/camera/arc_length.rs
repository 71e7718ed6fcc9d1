//! Arc length of a curve by adaptive Gauss-Legendre quadrature, and its inverse by Newton's method.

use super::hermite::Interpolable;
use super::track::CurveSegment;

/// The arc length of a curve in a vector space, to [`ArcLength::ACCURACY`].
#[derive(Clone, Debug)]
pub(super) struct ArcLength {
    /// Curve parameters from 0 to 1, so close that one quadrature is accurate between two of them.
    parameters: Vec<f64>,
    /// The arc lengths up to them.
    lengths: Vec<f64>,
}

impl ArcLength {
    /// Relative to the length of the curve.
    pub(super) const ACCURACY: f64 = 1e-12;

    /// Limit of the bisection: shorter parts are below double precision.
    const MAX_DEPTH: u32 = 40;

    pub(super) fn of<T: Interpolable>(segment: &CurveSegment<T>) -> ArcLength {
        let mut measured = ArcLength {
            parameters: vec![0.0],
            lengths: vec![0.0],
        };
        let whole = quadrature(segment, 0.0, 1.0);
        measured.add(segment, [0.0, 1.0], whole, Self::ACCURACY * whole, 0);
        measured
    }

    /// The length of the whole curve.
    pub(super) fn total(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// Adds the part between two parameters, of `length` by one quadrature, bisected until its halves agree with it.
    fn add<T: Interpolable>(
        &mut self,
        segment: &CurveSegment<T>,
        [start, end]: [f64; 2],
        length: f64,
        tolerance: f64,
        depth: u32,
    ) {
        let middle = 0.5 * (start + end);
        let first = quadrature(segment, start, middle);
        let second = quadrature(segment, middle, end);
        if (first + second - length).abs() > tolerance && depth < Self::MAX_DEPTH {
            self.add(segment, [start, middle], first, tolerance, depth + 1);
            self.add(segment, [middle, end], second, tolerance, depth + 1);
            return;
        }
        for (parameter, part) in [(middle, first), (end, second)] {
            self.lengths.push(self.total() + part);
            self.parameters.push(parameter);
        }
    }

    /// The curve parameter at an arc length from the start.
    pub(super) fn parameter_at<T: Interpolable>(
        &self,
        segment: &CurveSegment<T>,
        length: f64,
    ) -> f64 {
        let after = self.lengths.partition_point(|&l| l <= length);
        if after == 0 || after == self.lengths.len() {
            return if after == 0 { 0.0 } else { 1.0 };
        }
        let from = self.parameters[after - 1];
        let rest = length - self.lengths[after - 1];
        // Newton's method, with bisection where a step leaves the interval: near a cusp the speed is near zero.
        let (mut low, mut high) = (from, self.parameters[after]);
        let part = self.lengths[after] - self.lengths[after - 1];
        let mut parameter = from + (high - from) * (rest / part);
        for _ in 0..64 {
            let excess = quadrature(segment, from, parameter) - rest;
            if excess.abs() <= Self::ACCURACY * self.total() {
                break;
            }
            if excess > 0.0 {
                high = parameter;
            } else {
                low = parameter;
            }
            let next = parameter - excess / segment.speed(parameter);
            parameter = if low < next && next < high {
                next
            } else {
                0.5 * (low + high)
            };
        }
        parameter
    }
}

/// The length between two curve parameters by 8-point Gauss-Legendre quadrature, which is exact for polynomials up to
/// degree 15.
fn quadrature<T: Interpolable>(segment: &CurveSegment<T>, start: f64, end: f64) -> f64 {
    /// Positive abscissae on -1 to 1, and their weights.
    const POINTS: [[f64; 2]; 4] = [
        [0.183_434_642_495_649_8, 0.362_683_783_378_362],
        [0.525_532_409_916_329, 0.313_706_645_877_887_3],
        [0.796_666_477_413_626_7, 0.222_381_034_453_374_47],
        [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
    ];
    let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
    let pair = |[x, weight]: [f64; 2]| {
        weight * (segment.speed(middle - half * x) + segment.speed(middle + half * x))
    };
    half * POINTS.map(pair).into_iter().sum::<f64>()
}
