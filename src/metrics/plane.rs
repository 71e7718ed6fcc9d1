//! Separable convolution of one channel of an image.

/// One number for each pixel, row by row.
pub(super) struct Plane {
    pub(super) width: usize,
    pub(super) values: Vec<f64>,
}

impl Plane {
    /// Convolved with one filter along its rows and another along its columns, both of odd length; beyond the
    /// border are the pixels of the border.
    pub(super) fn convolved(&self, along_rows: &[f64], along_columns: &[f64]) -> Plane {
        let (width, height) = (self.width, self.values.len() / self.width);
        let filtered =
            |filter: &[f64], position: usize, size: usize, value: &dyn Fn(usize) -> f64| {
                let taps = filter.iter().enumerate().map(|(i, weight)| {
                    let tap = (position + i).saturating_sub(filter.len() / 2);
                    weight * value(tap.min(size - 1))
                });
                taps.sum::<f64>()
            };
        let pixels = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let rows =
            pixels().map(|(x, y)| filtered(along_rows, x, width, &|x| self.values[y * width + x]));
        let rows: Vec<f64> = rows.collect();
        let columns =
            pixels().map(|(x, y)| filtered(along_columns, y, height, &|y| rows[y * width + x]));
        Plane {
            width,
            values: columns.collect(),
        }
    }
}

/// How far a filter reaches, in pixels: three standard deviations.
pub(super) fn radius(sigma: f64) -> usize {
    (3.0 * sigma).ceil() as usize
}

/// A Gaussian, 1 in its middle.
pub(super) fn gaussian(sigma: f64, radius: usize) -> Vec<f64> {
    let offsets = (0..=2 * radius).map(|i| i as f64 - radius as f64);
    offsets
        .map(|x| libm::exp(-0.5 * (x / sigma).powi(2)))
        .collect()
}

/// Weights in proportion, whose sum is 1.
pub(super) fn normalised(mut weights: Vec<f64>) -> Vec<f64> {
    let sum: f64 = weights.iter().sum();
    for weight in &mut weights {
        *weight /= sum;
    }
    weights
}
