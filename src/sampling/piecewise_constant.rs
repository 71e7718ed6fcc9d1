//! Choices among cells with given probabilities, in one and two dimensions, by inversion of the distribution function:
//! the PiecewiseConstant1D and PiecewiseConstant2D of Pharr, Jakob and Humphreys 2023, "Physically Based Rendering",
//! sections A.4.7 and A.5.6.

/// The least probability of a cell whose weight is above 0: four steps of the numbers below 1 of single precision and
/// of random numbers of 24 bits, which would lose what is less likely.
const LEAST_PROBABILITY: f64 = 1.0 / (1 << 22) as f64;

/// A choice among the cells of a row.
#[derive(Clone, Debug)]
pub struct PiecewiseConstant1D {
    /// The probability of all cells before each, and 1.
    cdf: Vec<f32>,
}

impl PiecewiseConstant1D {
    /// Cells with probabilities in proportion to their weights, of which there is at least one, each finite and 0 or
    /// more. A cell of weight 0 is never chosen, but if all are 0, all are equally likely.
    pub fn new(weights: &[f64]) -> PiecewiseConstant1D {
        let sum: f64 = weights.iter().sum();
        let counted = |weight: &f64| match sum > 0.0 {
            true if *weight > 0.0 => weight.max(LEAST_PROBABILITY * sum),
            true => 0.0,
            false => 1.0,
        };
        let total: f64 = weights.iter().map(counted).sum();
        let mut before = 0.0;
        let mut cdf = vec![0.0];
        for weight in weights {
            before += counted(weight);
            cdf.push((before / total) as f32);
        }
        PiecewiseConstant1D { cdf }
    }

    /// The number of cells.
    pub fn cell_count(&self) -> usize {
        self.cdf.len() - 1
    }

    /// The cell that a number in [0, 1) chooses, and what is left of the number: uniform in [0, 1) again.
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32) {
        let inner = &self.cdf[1..self.cell_count()];
        let cell = inner.partition_point(|&before| before <= u);
        let rest = (u - self.cdf[cell]) / self.probability(cell);
        (cell, rest.min(1.0_f32.next_down()))
    }

    /// The probability of a cell.
    #[inline]
    pub fn probability(&self, cell: usize) -> f32 {
        self.cdf[cell + 1] - self.cdf[cell]
    }

    /// The memory that it takes, in bytes.
    pub fn memory(&self) -> usize {
        size_of_val(&*self.cdf)
    }
}

/// A choice among the cells of a grid: of a row, then of a column.
#[derive(Clone, Debug)]
pub struct PiecewiseConstant2D {
    marginal: PiecewiseConstant1D,
    /// The columns of each row.
    conditional: Vec<PiecewiseConstant1D>,
}

impl PiecewiseConstant2D {
    /// Cells with probabilities in proportion to their weights, as in [`PiecewiseConstant1D::new`]: rows of `columns`
    /// each, at least one.
    pub fn new(columns: usize, weights: &[f64]) -> PiecewiseConstant2D {
        let rows = || weights.chunks_exact(columns);
        let sums: Vec<f64> = rows().map(|row| row.iter().sum()).collect();
        PiecewiseConstant2D {
            marginal: PiecewiseConstant1D::new(&sums),
            conditional: rows().map(PiecewiseConstant1D::new).collect(),
        }
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        let columns = self.conditional.first();
        let columns = columns.map_or(0, PiecewiseConstant1D::cell_count);
        [columns, self.conditional.len()]
    }

    /// The column and the row of the cell that two numbers in [0, 1) choose, and what is left of the numbers: uniform
    /// in [0, 1) again.
    #[inline]
    pub fn sample(&self, [u, v]: [f32; 2]) -> ([usize; 2], [f32; 2]) {
        let (row, v) = self.marginal.sample(v);
        let (column, u) = self.conditional[row].sample(u);
        ([column, row], [u, v])
    }

    /// The probability of a cell, by its column and row.
    #[inline]
    pub fn probability(&self, [column, row]: [usize; 2]) -> f32 {
        self.marginal.probability(row) * self.conditional[row].probability(column)
    }

    /// The memory that it takes, in bytes.
    pub fn memory(&self) -> usize {
        let rows = self.conditional.iter().map(PiecewiseConstant1D::memory);
        self.marginal.memory() + rows.sum::<usize>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Multiples of 2^-24, the random numbers, choose each cell as often as its probability says, and what is left of
    /// them is spread evenly.
    #[test]
    fn cells_are_chosen_by_their_weights() {
        for weights in [
            &[3.0][..],
            &[0.0, 0.0],
            &[1.0, 3.0, 0.0, 4.0],
            &[0.0, 0.0, 2.0, 0.0, 1.0, 0.0],
            &[1e30, 1e-30, 0.0, 1e30],
            &[1e-300, 1e300],
        ] {
            let choice = PiecewiseConstant1D::new(weights);
            let count = choice.cell_count();
            let mut seen = vec![0_u32; count];
            let mut rests = vec![0.0; count];
            for i in 0..1 << 24 {
                let (cell, rest) = choice.sample(i as f32 / (1 << 24) as f32);
                assert!((0.0..1.0).contains(&rest));
                seen[cell] += 1;
                rests[cell] += f64::from(rest);
            }
            let sum: f64 = weights.iter().sum();
            for (cell, weight) in weights.iter().enumerate() {
                let probability = f64::from(choice.probability(cell));
                let expected = if sum > 0.0 { weight / sum } else { 0.5 };
                assert!((probability - expected).abs() < 5e-7, "{weights:?}");
                let fraction = f64::from(seen[cell]) / f64::from(1 << 24);
                assert!((fraction - probability).abs() < 1e-7, "{weights:?}");
                assert_eq!(seen[cell] > 0, *weight > 0.0 || sum == 0.0);
                if fraction > 1e-3 {
                    assert!((rests[cell] / f64::from(seen[cell]) - 0.5).abs() < 1e-3);
                }
            }
        }
    }

    #[test]
    fn grids_are_rows_of_columns() {
        let weights = [1.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 5.0, 0.0];
        let choice = PiecewiseConstant2D::new(3, &weights);
        assert_eq!(choice.size(), [3, 3]);
        let mut sums = [0.0; 9];
        for i in 0..400 {
            for j in 0..400 {
                let u = [i, j].map(|i| (i as f32 + 0.5) / 400.0);
                let ([column, row], rest) = choice.sample(u);
                assert!(rest.iter().all(|u| (0.0..1.0).contains(u)));
                sums[3 * row + column] += 1.0 / 160_000.0;
            }
        }
        for (cell, weight) in weights.iter().enumerate() {
            let probability = f64::from(choice.probability([cell % 3, cell / 3]));
            let chosen_row = cell / 3 != 1;
            if chosen_row {
                assert!((probability - weight / 8.0).abs() < 1e-7);
            } else {
                assert_eq!(probability, 0.0);
            }
            assert!((sums[cell] - weight / 8.0).abs() < 0.003, "{sums:?}");
        }
    }
}
