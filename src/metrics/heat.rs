//! Errors in false colours.

use glam::Vec3;

/// The least and the most relative error with a colour of its own: 1 % and 100 %.
const HEAT_RANGE: [f32; 2] = [0.01, 1.0];

/// "Magma" of matplotlib (van der Walt and Smith 2015) in even steps, as 8-bit sRGB: linear in between, it is within
/// 3 codes of all 256 entries.
const MAGMA: [[u8; 3]; 17] = [
    [0, 0, 4],
    [10, 8, 34],
    [29, 17, 71],
    [54, 16, 107],
    [81, 18, 124],
    [106, 28, 129],
    [131, 38, 129],
    [156, 46, 127],
    [183, 55, 121],
    [207, 64, 112],
    [229, 80, 100],
    [244, 105, 92],
    [251, 135, 97],
    [254, 165, 113],
    [254, 194, 135],
    [253, 224, 161],
    [252, 253, 191],
];

/// Paints errors, one for each pixel: R, G, B by pixel, in 8-bit sRGB.
///
/// The scale is logarithmic over 1 % to 100 %, the same for every image so that two may be compared:
/// black is 1 % or less, red-violet 10 %, pale yellow 100 % or more, and so is what is no number. The steps of the
/// colours look alike, and their lightness alone tells the order.
pub fn heat_map(errors: &[f32]) -> Vec<u8> {
    let [least, most] = HEAT_RANGE;
    let color = |&error: &f32| {
        let value = if error < most {
            libm::logf(error.max(least) / least) / libm::logf(most / least)
        } else {
            1.0
        };
        magma(value)
    };
    errors.iter().flat_map(color).collect()
}

/// The colour of a value between 0 and 1.
fn magma(value: f32) -> [u8; 3] {
    let position = value * (MAGMA.len() - 1) as f32;
    let step = (position as usize).min(MAGMA.len() - 2);
    let [low, high] = [step, step + 1].map(|i| Vec3::from_array(MAGMA[i].map(f32::from)));
    let color = low.lerp(high, position - step as f32).round();
    color.to_array().map(|code| code as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::color::srgb_to_linear;

    fn luminance(color: &[u8]) -> f32 {
        let linear = |i: usize| srgb_to_linear(f32::from(color[i]) / 255.0);
        0.2126 * linear(0) + 0.7152 * linear(1) + 0.0722 * linear(2)
    }

    #[test]
    fn ends_and_middle_have_their_colors() {
        let ends = [0.01, 1.0].map(|error| heat_map(&[error]));
        assert_eq!(ends, [[0, 0, 4], [252, 253, 191]]);
        for error in [0.0, -1.0, 0.0099, f32::NEG_INFINITY] {
            assert_eq!(heat_map(&[error]), ends[0], "{error}");
        }
        for error in [1.5, f32::INFINITY, f32::NAN] {
            assert_eq!(heat_map(&[error]), ends[1], "{error}");
        }
        assert_eq!(heat_map(&[0.1]), [183, 55, 121]);
        assert_eq!(heat_map(&[0.1, 0.01]).len(), 6);
    }

    /// Evenly in lightness L* (CIE 1976), a factor of the error being the same step everywhere.
    #[test]
    fn lightness_rises_evenly_with_the_logarithm() {
        let errors: Vec<f32> = (0..=20)
            .map(|i| libm::powf(10.0, 0.1 * i as f32 - 2.0))
            .collect();
        let lightness = |color: &[u8]| 116.0 * libm::cbrtf(luminance(color)) - 16.0;
        let map = heat_map(&errors);
        let lightness: Vec<f32> = map.chunks_exact(3).map(lightness).collect();
        // What is nearly black is left out: there the cube root is no measure of lightness.
        for pair in lightness[2..].windows(2) {
            let step = pair[1] - pair[0];
            assert!((3.0..7.0).contains(&step), "{lightness:?}");
        }
    }
}
