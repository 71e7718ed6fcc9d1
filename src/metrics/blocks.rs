use super::Estimate;

/// Blocks are squares of this many pixels, cut off at the right and lower edges.
const SIDE: usize = 16;

/// The mean of one value for each pixel of a picture `width` pixels wide, and the degrees of freedom of its
/// standard error: one less than the blocks. A picture of one block leaves its error unknown.
///
/// The error comes from the spread of whole blocks rather than of pixels, because neighbours that share their
/// corners' samples share their noise: pixels taken for independent would give half the error, blocks give
/// 0.97 of it. What spreads over more than a block is still underestimated. Blocks that are cut off count by
/// their pixels (Cochran 1977, "Sampling Techniques", chapter 9A).
pub(super) fn over_blocks(width: u32, values: &[f64]) -> (Estimate, u32) {
    let width = width as usize;
    let columns = width.div_ceil(SIDE);
    let rows = (values.len() / width).div_ceil(SIDE);
    let mut sums = vec![(0.0, 0.0); columns * rows];
    for (pixel, value) in values.iter().enumerate() {
        let (x, y) = (pixel % width, pixel / width);
        let (sum, count) = &mut sums[y / SIDE * columns + x / SIDE];
        *sum += value;
        *count += 1.0;
    }
    let total = values.len() as f64;
    let mean = sums.iter().map(|(sum, _)| sum).sum::<f64>() / total;
    let squares = sums.iter().map(|(sum, count)| (sum - mean * count).powi(2));
    let blocks = sums.len() as f64;
    let error = match sums.len() {
        0 | 1 => f64::INFINITY,
        _ => (squares.sum::<f64>() * blocks / (blocks - 1.0)).sqrt() / total,
    };
    (
        Estimate { mean, error },
        sums.len().saturating_sub(1) as u32,
    )
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::Noise;
    use super::*;

    #[test]
    fn whole_blocks_are_like_single_values() {
        let blocks = [1.0, 2.0, 4.0, 1.5, 3.5, 0.0];
        let pixel = |i: usize| blocks[i / 48 / SIDE * 3 + i % 48 / SIDE];
        let values: Vec<f64> = (0..48 * 32).map(pixel).collect();
        let (estimate, degrees) = over_blocks(48, &values);
        let expected = Estimate::of(&blocks);
        assert!((estimate.mean - expected.mean).abs() < 1e-12);
        assert!((estimate.error - expected.error).abs() < 1e-12);
        assert_eq!(degrees, 5);
    }

    #[test]
    fn one_block_says_nothing_of_its_error() {
        for (width, values) in [(1, vec![7.0]), (16, vec![7.0; 256])] {
            let (estimate, degrees) = over_blocks(width, &values);
            assert_eq!((estimate.mean, estimate.error), (7.0, f64::INFINITY));
            assert_eq!(degrees, 0);
        }
        let (estimate, degrees) = over_blocks(17, &[7.0; 17]);
        assert_eq!((estimate, degrees), (Estimate::exact(7.0), 1));
    }

    /// As in the supersampling modes. The mean of z^2 is 1 if the errors are right.
    #[test]
    fn noise_that_neighbours_share_is_seen() {
        let (width, height) = (72, 40);
        let mut noise = Noise::new(2);
        let (mut by_blocks, mut by_pixels) = (0.0, 0.0);
        for _ in 0..100 {
            let corners: Vec<f64> = (0..(width + 1) * (height + 1))
                .map(|_| noise.normal())
                .collect();
            let corner = |x: usize, y: usize| corners[y * (width + 1) + x];
            let pixel = |i: usize| {
                let (x, y) = (i % width, i / width);
                0.25 * (corner(x, y) + corner(x + 1, y) + corner(x, y + 1) + corner(x + 1, y + 1))
            };
            let values: Vec<f64> = (0..width * height).map(pixel).collect();
            let z_squared = |estimate: Estimate| (estimate.mean / estimate.error).powi(2) / 100.0;
            by_blocks += z_squared(over_blocks(width as u32, &values).0);
            by_pixels += z_squared(Estimate::of(&values));
        }
        assert!((0.7..1.6).contains(&by_blocks), "{by_blocks}");
        assert!(by_pixels > 2.5, "{by_pixels}");
    }
}
