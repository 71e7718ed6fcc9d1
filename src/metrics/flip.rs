use super::mean;
use nv_flip::FlipImageRgb8;

/// How different two pictures look when one is shown after the other in the same place: 0 if nothing is seen,
/// 1 for the most that can be; the mean over all pixels, as the authors recommend.
///
/// The displayed pictures are of the same size, columns and rows, as [`Film::to_srgb8`](crate::film::Film::to_srgb8)
/// gives them, and seen at 67 pixels for each degree: a display 0.7 m wide, of 3840 columns, from 0.7 m. The
/// method and the code are NVIDIA's (Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating
/// Images").
///
/// # Panics
///
/// If a picture has fewer pixels than its size says.
pub fn flip([width, height]: [u32; 2], reference: &[u8], picture: &[u8]) -> f64 {
    let image = |codes| FlipImageRgb8::with_data(width, height, codes);
    let distance = nv_flip::DEFAULT_PIXELS_PER_DEGREE;
    let map = nv_flip::flip(image(reference), image(picture), distance).to_vec();
    let values: Vec<f64> = map.into_iter().map(f64::from).collect();
    mean(&values)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [40, 30];

    /// A slope of greys, with its middle brighter by some codes.
    fn slope(more: u8) -> Vec<u8> {
        let code = |i: usize| {
            let (x, y) = (i / 3 % 40, i / 120);
            let middle = (10..30).contains(&x) && (10..20).contains(&y);
            (4 * x + y) as u8 + if middle { more } else { 0 }
        };
        (0..3600).map(code).collect()
    }

    #[test]
    fn equal_pictures_do_not_differ() {
        assert_eq!(flip(SIZE, &slope(0), &slope(0)), 0.0);
    }

    #[test]
    fn grows_with_the_difference() {
        let mut last = 0.0;
        for more in [1, 4, 16, 64] {
            let flip = flip(SIZE, &slope(0), &slope(more));
            assert!(flip > last && flip < 1.0, "{more}: {flip}");
            last = flip;
        }
    }

    /// Green and blue are as far apart as colours are, and an even picture has nothing but colour.
    #[test]
    fn the_largest_difference_is_one() {
        let even = |code: [u8; 3]| code.repeat(1200);
        let flip = flip(SIZE, &even([0, 255, 0]), &even([0, 0, 255]));
        assert!((flip - 1.0).abs() < 1e-3, "{flip}");
    }

    #[test]
    fn a_single_pixel_is_a_picture() {
        let flip = flip([1, 1], &[0, 0, 0], &[255, 255, 255]);
        assert!(flip > 0.5, "{flip}");
    }
}
