//! Weighted least squares fits of quadratic functions of two variables to pairs of colours.

use glam::DVec3;

/// The number of coefficients: of 1, x, y, x², xy and y².
pub(super) const COEFFICIENTS: usize = 6;

/// Ridge regularisation relative to the sum of the weights, for each of the coefficients.
const REGULARIZATION: [f64; COEFFICIENTS] = [0.0, 0.005, 0.005, 0.1, 0.1, 0.1];

/// Two colours.
pub(super) type Pair = [DVec3; 2];

/// The coefficients of a function of each of two colours.
pub(super) type Coefficients = [[DVec3; COEFFICIENTS]; 2];

/// The normal equations.
#[derive(Debug, Default)]
pub(super) struct LeastSquares {
    /// The lower half counts.
    matrix: [[f64; COEFFICIENTS]; COEFFICIENTS],
    right_sides: Coefficients,
}

fn basis([x, y]: [f64; 2]) -> [f64; COEFFICIENTS] {
    [1.0, x, y, x * x, x * y, y * y]
}

impl LeastSquares {
    /// Adds a value at a point with a weight above 0.
    pub(super) fn add(&mut self, weight: f64, at: [f64; 2], value: Pair) {
        let basis = basis(at);
        for (row, term) in self.matrix.iter_mut().zip(basis) {
            for (sum, other) in row.iter_mut().zip(basis) {
                *sum += weight * term * other;
            }
        }
        for (right_side, color) in self.right_sides.iter_mut().zip(value) {
            for (sum, term) in right_side.iter_mut().zip(basis) {
                *sum += weight * term * color;
            }
        }
    }

    /// The coefficients that fit best, by Cholesky decomposition. At least one value was added.
    pub(super) fn solve(&self) -> Coefficients {
        let weights = self.matrix[0][0];
        let mut lower = self.matrix;
        for (i, regularization) in REGULARIZATION.into_iter().enumerate() {
            lower[i][i] += regularization * weights;
        }
        for i in 0..COEFFICIENTS {
            for j in 0..=i {
                let products: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
                let rest = lower[i][j] - products;
                lower[i][j] = if i == j {
                    rest.sqrt()
                } else {
                    rest / lower[j][j]
                };
            }
        }
        let mut solutions = self.right_sides;
        for x in &mut solutions {
            for i in 0..COEFFICIENTS {
                let known: DVec3 = (0..i).map(|k| lower[i][k] * x[k]).sum();
                x[i] = (x[i] - known) / lower[i][i];
            }
            for i in (0..COEFFICIENTS).rev() {
                let known: DVec3 = (i + 1..COEFFICIENTS).map(|k| lower[k][i] * x[k]).sum();
                x[i] = (x[i] - known) / lower[i][i];
            }
        }
        solutions
    }

    /// The value of one of the fitted functions.
    pub(super) fn value(coefficients: &[DVec3; COEFFICIENTS], at: [f64; 2]) -> DVec3 {
        let terms = coefficients.iter().zip(basis(at));
        terms.map(|(coefficient, basis)| *coefficient * basis).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;

    /// Quadratic functions are found, up to the regularisation, from far points as from near ones.
    #[test]
    fn finds_quadratic_functions() {
        let mut random = Random::new(7);
        let truth = [1.0, -3.0].map(|color| {
            [5.0, 1.0, -2.0, 0.3, 0.2, -0.1].map(|c| color * DVec3::new(c, 2.0 * c, -c))
        });
        let mut least_squares = LeastSquares::default();
        for _ in 0..500 {
            let at = [(); 2].map(|()| 8.0 * f64::from(random.unit()) - 4.0);
            let value = truth
                .each_ref()
                .map(|of_color| LeastSquares::value(of_color, at));
            least_squares.add(1.0, at, value);
        }
        let found = least_squares.solve();
        for (found, truth) in found.iter().flatten().zip(truth.iter().flatten()) {
            assert!((found - truth).length() < 0.3, "{found} {truth}");
        }
    }

    /// One value is the value everywhere.
    #[test]
    fn a_single_value_is_constant() {
        let mut least_squares = LeastSquares::default();
        least_squares.add(3.0, [0.0, 0.0], [DVec3::ONE, DVec3::ZERO]);
        let [found, zero] = least_squares.solve();
        let off = LeastSquares::value(&found, [1.0, 2.0]) - DVec3::ONE;
        assert!(off.length() < 1e-12, "{off}");
        assert_eq!(LeastSquares::value(&zero, [1.0, 2.0]), DVec3::ZERO);
    }
}
