//! The local mean of pixels, and what makes squared errors relative to it (relMSE).

use glam::Vec3;
use std::ops::{AddAssign, Div};

/// The least radiance that errors are relative to, as a fraction of display white: otherwise a few pixels that are
/// nearly black would outweigh all others.
pub const RADIANCE_FLOOR: f32 = 0.1;

/// The mean of the up to eight neighbours of a value, the value itself left out, at a distance of `spacing` in rows of
/// `width`; none if it has no neighbours.
pub fn local_mean<T>(values: &[T], width: usize, index: usize, spacing: usize) -> Option<T>
where
    T: Copy + Default + AddAssign + Div<f32, Output = T>,
{
    let mut sum = T::default();
    let mut count = 0;
    for value in neighbours(values, width, index, spacing) {
        sum += value;
        count += 1;
    }
    (count > 0).then(|| sum / count as f32)
}

/// The values that [`local_mean`] is the mean of.
pub fn neighbours<T: Copy>(
    values: &[T],
    width: usize,
    index: usize,
    spacing: usize,
) -> impl Iterator<Item = T> {
    let (x, y) = (index % width, index / width);
    let height = values.len() / width;
    let near = move |at: usize, size: usize| {
        let offsets = [at.checked_sub(spacing), Some(at), Some(at + spacing)];
        offsets.into_iter().flatten().filter(move |c| *c < size)
    };
    near(y, height).flat_map(move |row| {
        let columns = near(x, width).filter(move |column| (*column, row) != (x, y));
        columns.map(move |column| values[row * width + column])
    })
}

/// What squared errors at a pixel are divided by: m^2 + (display white / 10)^2, where m is the [`local_mean`]. Where
/// radiance is even, m^2 is the usual r^2; but its noise is independent of the pixel's, so that the quotient is not
/// biased.
pub fn normaliser(
    pixels: &[Vec3],
    width: usize,
    index: usize,
    spacing: usize,
    display_white: f32,
) -> Vec3 {
    let mean = local_mean(pixels, width, index, spacing).unwrap_or(pixels[index]);
    mean * mean + (RADIANCE_FLOOR * display_white).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_do_not_include_the_pixel() {
        let values: Vec<f32> = (0..12).map(|i| i as f32).collect();
        assert_eq!(local_mean(&values, 4, 5, 1), Some(5.0));
        // The neighbours of the corner: 1, 4 and 5.
        assert_eq!(local_mean(&values, 4, 0, 1), Some(10.0 / 3.0));
        // Two away from 5, in rows of four and columns of three: 7 only.
        assert_eq!(local_mean(&values, 4, 5, 2), Some(7.0));
        assert_eq!(local_mean(&[3.0], 1, 0, 1), None);
    }

    #[test]
    fn errors_are_relative_to_the_local_mean_or_to_a_tenth_of_white() {
        let pixels = [0.3, 5.0, 0.5].map(Vec3::splat);
        let close = |a: Vec3, b: f32| (a - b).abs().max_element() < 1e-6;
        assert!(close(normaliser(&pixels, 3, 1, 1, 2.0), 0.16 + 0.04));
        assert!(close(normaliser(&pixels[..1], 1, 0, 1, 1.0), 0.09 + 0.01));
    }
}
