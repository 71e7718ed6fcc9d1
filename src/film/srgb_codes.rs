//! The 8-bit sRGB codes of linear values (IEC 61966-2-1): the nearest one, or one of the two around by a threshold.

use crate::math::color::srgb_to_linear;

/// The nearest code.
pub(super) struct NearestCodes {
    /// The values from which on the code is above 0, above 1, ...; none is above 255.
    steps: [f32; 256],
    bins: Bins,
}

impl NearestCodes {
    pub(super) fn new() -> NearestCodes {
        let steps = std::array::from_fn(|code| match code {
            255 => f32::INFINITY,
            _ => linear(code as f32 + 0.5),
        });
        NearestCodes {
            bins: Bins::new(&steps),
            steps,
        }
    }

    /// The code of a value, clipped; 0 for NaN.
    #[inline]
    pub(super) fn code(&self, value: f32) -> u8 {
        let value = clipped(value);
        let first = self.bins.first(value);
        first + u8::from(self.steps[usize::from(first)] <= value)
    }
}

/// The code below or above, by a threshold.
pub(super) struct ThresholdCodes {
    /// The value of each code, and how far the next one's is; none is above 255.
    levels: [[f32; 2]; 257],
    bins: Bins,
}

impl ThresholdCodes {
    pub(super) fn new() -> ThresholdCodes {
        let level = |code| match code {
            0..256 => linear(code as f32),
            _ => f32::INFINITY,
        };
        let steps: [f32; 255] = std::array::from_fn(|i| level(i + 1));
        ThresholdCodes {
            levels: std::array::from_fn(|code| [level(code), level(code + 1) - level(code)]),
            bins: Bins::new(&steps),
        }
    }

    /// The code at or below a value, or the next one if the value is beyond `threshold`, between 0 and 1, of the way
    /// there. Thresholds that are uniform give the value on average; a code's value gives the code. What is clipped is
    /// such a value, and NaN is 0.
    #[inline]
    pub(super) fn code(&self, value: f32, threshold: f32) -> u8 {
        let value = clipped(value);
        let first = self.bins.first(value);
        let is_beyond = |code: usize| {
            let [level, gap] = self.levels[code];
            u8::from(value - level > threshold * gap)
        };
        // One step in a bin: the value may be above the next code.
        first + is_beyond(usize::from(first)) + is_beyond(usize::from(first) + 1)
    }
}

/// The linear value of a code.
fn linear(code: f32) -> f32 {
    srgb_to_linear(code / 255.0)
}

#[inline]
#[expect(clippy::manual_clamp, reason = "NaN becomes 0")]
fn clipped(value: f32) -> f32 {
    value.max(0.0).min(1.0)
}

/// How many of rising numbers, 255 or fewer between 1/8192 and 1, are up to the least value of each bin: of values that
/// share exponent and the first seven bits of the fraction. There is at most one of them in a bin. A power would cost far
/// more than this look-up and a comparison.
struct Bins([u8; Bins::COUNT]);

impl Bins {
    const LEAST: f32 = 1.0 / 8192.0;
    const COUNT: usize = Self::bin(1.0) + 1;

    const fn bin(value: f32) -> usize {
        ((value.to_bits() - Self::LEAST.to_bits()) >> 16) as usize
    }

    fn new(numbers: &[f32]) -> Bins {
        Bins(std::array::from_fn(|bin| {
            let least = f32::from_bits(Self::LEAST.to_bits() + ((bin as u32) << 16));
            numbers.partition_point(|&number| number <= least) as u8
        }))
    }

    /// The number up to the least value of the bin of a value in 0..=1.
    #[inline]
    fn first(&self, value: f32) -> u8 {
        self.0[Self::bin(value.max(Self::LEAST))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values around each of some numbers, and everywhere.
    fn values(numbers: &[f32]) -> impl Iterator<Item = f32> {
        let around = numbers
            .iter()
            .flat_map(|&x| [x.next_down(), x, x.next_up()]);
        around.chain((0..1_000_000).map(|i| i as f32 * 1.1e-6))
    }

    #[test]
    fn nearest_codes_count_the_steps_up_to_a_value() {
        let codes = NearestCodes::new();
        let steps = &codes.steps[..255];
        let outside = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, 1e-40];
        for value in values(steps).chain(outside) {
            let below = steps.iter().filter(|&&step| step <= value).count();
            assert_eq!(usize::from(codes.code(value)), below, "{value}");
        }
    }

    #[test]
    fn thresholds_choose_between_the_codes_around() {
        let codes = ThresholdCodes::new();
        let levels: Vec<f32> = (0..=255).map(|code| linear(code as f32)).collect();
        for value in values(&levels).map(clipped) {
            let below = levels
                .iter()
                .rposition(|&level| level <= value)
                .unwrap_or(0);
            let above = below + usize::from(levels[below] < value);
            for (threshold, code) in [(0.0, above), (1.0_f32.next_down(), below)] {
                assert_eq!(usize::from(codes.code(value, threshold)), code, "{value}");
            }
        }
    }

    /// Whatever the threshold.
    #[test]
    fn codes_stay_and_what_is_beyond_is_clipped() {
        let codes = ThresholdCodes::new();
        for threshold in [1e-6, 0.25, 0.5, 1.0 - 1e-6] {
            for code in 0..=255 {
                assert_eq!(codes.code(linear(code.into()), threshold), code);
            }
            for (value, code) in [
                (-0.0, 0),
                (-1e-9, 0),
                (f32::NEG_INFINITY, 0),
                (f32::NAN, 0),
                (1.0_f32.next_up(), 255),
                (1e30, 255),
                (f32::INFINITY, 255),
            ] {
                assert_eq!(codes.code(value, threshold), code, "{value}");
            }
        }
    }

    #[test]
    fn thresholds_are_fractions_of_linear_light() {
        let codes = ThresholdCodes::new();
        for below in 0..255_u8 {
            let [low, high] = [below, below + 1].map(|code| linear(code.into()));
            for fraction in [0.01, 0.3, 0.99] {
                let value = low + fraction * (high - low);
                assert_eq!(codes.code(value, fraction - 0.001), below + 1);
                assert_eq!(codes.code(value, fraction + 0.001), below);
            }
        }
    }
}
