//! The sRGB transfer function (IEC 61966-2-1), both ways, and luminance.
//!
//! Colours are linear RGB triples with sRGB primaries everywhere in the program;
//! only textures come in and frames go out through the transfer functions.

use glam::{DVec3, Vec3};

/// The luminance of a colour in its own unit: the Y of sRGB's primaries (IEC 61966-2-1).
///
/// In double precision it is 0 only for black, as long as no channel is negative.
pub fn luminance(color: Vec3) -> f64 {
    color.as_dvec3().dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// The linear value of an sRGB-encoded one, both in 0..1.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        libm::powf((encoded + 0.055) / 1.055, 2.4)
    }
}

/// The sRGB encoding of a linear value; below 0 gives 0, above 1 gives 1, NaN gives 0.
pub fn linear_to_srgb(linear: f32) -> f32 {
    if linear.is_nan() || linear <= 0.0 {
        0.0
    } else if linear <= 0.003_130_8 {
        12.92 * linear
    } else if linear < 1.0 {
        1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_8_and_16_bit_code_survives_the_round_trip() {
        for levels in [255.0_f32, 65535.0] {
            for code in 0..=levels as u32 {
                let encoded = code as f32 / levels;
                let back = linear_to_srgb(srgb_to_linear(encoded)) * levels;
                assert_eq!(back.round() as u32, code);
            }
        }
    }

    #[test]
    fn white_has_luminance_1_and_the_darkest_blue_some() {
        assert!((luminance(Vec3::ONE) - 1.0).abs() < 1e-12);
        assert!(luminance(1e-45 * Vec3::Z) > 0.0);
    }

    #[test]
    fn known_values_of_the_standard() {
        assert!((srgb_to_linear(0.5) - 0.214_041).abs() < 1e-6);
        assert!((linear_to_srgb(0.18) - 0.461_356).abs() < 1e-5);
        assert_eq!(linear_to_srgb(7.0), 1.0);
        assert_eq!(linear_to_srgb(-1.0), 0.0);
        assert_eq!(linear_to_srgb(f32::NAN), 0.0);
    }
}
