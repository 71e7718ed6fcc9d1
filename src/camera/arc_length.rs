use super::track::Piece;
use super::value::Value;

/// The length along a curve in a flat space, known to [`ArcLength::ACCURACY`].
#[derive(Clone, Debug)]
pub(super) struct ArcLength {
    /// Shares of the curve, from 0 to 1, so close that one quadrature is accurate between two of them.
    shares: Vec<f64>,
    /// The lengths up to them.
    lengths: Vec<f64>,
}

impl ArcLength {
    /// As a share of the curve's length.
    pub(super) const ACCURACY: f64 = 1e-12;

    /// Parts are not halved more often: shorter ones are below what numbers resolve.
    const MAX_DEPTH: u32 = 40;

    pub(super) fn of<T: Value>(piece: &Piece<T>) -> ArcLength {
        let mut measured = ArcLength {
            shares: vec![0.0],
            lengths: vec![0.0],
        };
        let whole = quadrature(piece, 0.0, 1.0);
        measured.add(piece, [0.0, 1.0], whole, Self::ACCURACY * whole, 0);
        measured
    }

    /// The length of all of the curve.
    pub(super) fn total(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// Measures the part between two shares, which one quadrature says is of `length`, in halves until they agree
    /// with it.
    fn add<T: Value>(
        &mut self,
        piece: &Piece<T>,
        [start, end]: [f64; 2],
        length: f64,
        tolerance: f64,
        depth: u32,
    ) {
        let middle = 0.5 * (start + end);
        let first = quadrature(piece, start, middle);
        let second = quadrature(piece, middle, end);
        if (first + second - length).abs() > tolerance && depth < Self::MAX_DEPTH {
            self.add(piece, [start, middle], first, tolerance, depth + 1);
            self.add(piece, [middle, end], second, tolerance, depth + 1);
            return;
        }
        for (share, part) in [(middle, first), (end, second)] {
            self.lengths.push(self.total() + part);
            self.shares.push(share);
        }
    }

    /// The share of the curve at which so much of its length is passed.
    pub(super) fn share_at<T: Value>(&self, piece: &Piece<T>, length: f64) -> f64 {
        let after = self.lengths.partition_point(|&l| l <= length);
        if after == 0 || after == self.lengths.len() {
            return if after == 0 { 0.0 } else { 1.0 };
        }
        let from = self.shares[after - 1];
        let rest = length - self.lengths[after - 1];
        // Newton's steps, halving the interval where they leave it: beside a cusp the speed is near zero.
        let (mut low, mut high) = (from, self.shares[after]);
        let part = self.lengths[after] - self.lengths[after - 1];
        let mut share = from + (high - from) * (rest / part);
        for _ in 0..64 {
            let excess = quadrature(piece, from, share) - rest;
            if excess.abs() <= Self::ACCURACY * self.total() {
                break;
            }
            if excess > 0.0 {
                high = share;
            } else {
                low = share;
            }
            let next = share - excess / piece.speed(share);
            share = if low < next && next < high {
                next
            } else {
                0.5 * (low + high)
            };
        }
        share
    }
}

/// The length between two shares by Gauss and Legendre's quadrature with 8 points: exact for speeds that are
/// polynomials up to degree 15.
fn quadrature<T: Value>(piece: &Piece<T>, start: f64, end: f64) -> f64 {
    /// Positive abscissae on -1 to 1, and their weights.
    const POINTS: [[f64; 2]; 4] = [
        [0.183_434_642_495_649_8, 0.362_683_783_378_362],
        [0.525_532_409_916_329, 0.313_706_645_877_887_3],
        [0.796_666_477_413_626_7, 0.222_381_034_453_374_47],
        [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
    ];
    let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
    let pair = |[x, weight]: [f64; 2]| {
        weight * (piece.speed(middle - half * x) + piece.speed(middle + half * x))
    };
    half * POINTS.map(pair).into_iter().sum::<f64>()
}
