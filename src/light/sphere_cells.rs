//! A choice of directions by cells of longitude and latitude.

use crate::sampling::PiecewiseConstant2D;
use std::f64::consts::PI;

/// Cells between circles of longitude and of latitude, each with its own pdf, which is the same in all of the cell.
///
/// A direction is given by its longitude, as a fraction of a turn, and its y, the cosine of the angle to +Y: areas on the
/// sphere are those of these two, times 2 pi (Archimedes), so no pdf is infinite at the poles.
#[derive(Clone, Debug)]
pub(super) struct SphereCells {
    cells: PiecewiseConstant2D,
    /// y of the circles of latitude, from 1 down to -1: one more than rows.
    circles: Vec<f32>,
}

impl SphereCells {
    /// Cells of `columns` in each row, which are equally high in angle, the row at +Y first; at least one. Those with
    /// the same mean radiance have the same pdf.
    pub(super) fn new(columns: usize, means: &[f64]) -> SphereCells {
        let rows = means.len() / columns;
        let circle = |row: usize| libm::cos(PI * row as f64 / rows as f64);
        let height = |row: usize| circle(row) - circle(row + 1);
        let weights = means.iter().enumerate();
        let weights: Vec<f64> = weights
            .map(|(cell, mean)| mean * height(cell / columns))
            .collect();
        SphereCells {
            cells: PiecewiseConstant2D::new(columns, &weights),
            circles: (0..=rows).map(|row| circle(row) as f32).collect(),
        }
    }

    /// The longitude and y of a direction, for two numbers in [0, 1).
    pub(super) fn sample(&self, u: [f32; 2]) -> [f32; 2] {
        let ([column, row], [u, v]) = self.cells.sample(u);
        let [columns, _] = self.cells.size();
        let (upper, lower) = (self.circles[row], self.circles[row + 1]);
        [
            (column as f32 + u) / columns as f32,
            upper * (1.0 - v) + lower * v,
        ]
    }

    /// The pdf over solid angle of a direction with a longitude in 0..=1 and a y.
    #[inline]
    pub(super) fn pdf(&self, [longitude, y]: [f32; 2]) -> f32 {
        let [columns, rows] = self.cells.size();
        let column = (longitude * columns as f32) as usize;
        let inner = &self.circles[1..rows];
        let row = inner.partition_point(|&circle| circle >= y);
        let height = self.circles[row] - self.circles[row + 1];
        let area = std::f32::consts::TAU / columns as f32 * height;
        self.cells.probability([column.min(columns - 1), row]) / area
    }

    /// Bytes besides its own.
    pub(super) fn memory(&self) -> usize {
        self.cells.memory() + size_of_val(&*self.circles)
    }
}
