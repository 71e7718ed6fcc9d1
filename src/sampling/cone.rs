//! Uniform sampling of the directions of a cone, through the concentric map of Shirley and Chiu 1997, "A Low Distortion
//! Map Between Disk and Square".
//!
//! A cone is given by 1 - cos of its half angle, of which its solid angle is a multiple: the cosine of a narrow cone
//! rounds to 1.

use super::warp::concentric_disk;
use glam::Vec3;
use std::f32::consts::TAU;

/// A unit direction around +Z, uniform in the cone of directions with 1 - cos(theta) <= `one_minus_cos_max`, from two
/// numbers in 0..=1.
///
/// `one_minus_cos_max` is in 0..=2; 2 is the sphere. The disk is wrapped around the cone by Lambert's azimuthal
/// equal-area projection.
#[inline]
pub fn uniform_cone(u: f32, v: f32, one_minus_cos_max: f32) -> Vec3 {
    let (disk, radius) = concentric_disk(u, v);
    let one_minus_cos = radius * radius * one_minus_cos_max;
    // sin^2 = (1 - cos)(1 + cos), of which the disk has the radius already.
    let sin_over_radius = (one_minus_cos_max * (2.0 - one_minus_cos)).sqrt();
    (sin_over_radius * disk).extend(1.0 - one_minus_cos)
}

/// The pdf of [`uniform_cone`] over solid angle, in 1/sr: 1 over the cone's solid angle. Infinite for a cone of no
/// width.
#[inline]
pub fn uniform_cone_pdf(one_minus_cos_max: f32) -> f32 {
    1.0 / (TAU * one_minus_cos_max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In a cone, k = 1 - cos(theta) is uniform up to its maximum m: E[k] = m / 2, E[k^2] = m^2 / 3, E[x] = E[y] = 0,
    /// E[x^2] = E[y^2] = E[k - k^2 / 2] = m / 2 - m^2 / 6. For narrow cones z is 1, and x^2 + y^2 tells k.
    #[test]
    fn moments() {
        let n = 500;
        for m in [1e-8_f32, 1e-4, 0.1, 1.0, 1.7, 2.0] {
            let mut sums = [0.0_f64; 5];
            let max = f64::from(m);
            for i in 0..n {
                for j in 0..n {
                    let (u, v) = ((i as f32 + 0.5) / n as f32, (j as f32 + 0.5) / n as f32);
                    let d = uniform_cone(u, v, m);
                    assert!((d.length() - 1.0).abs() < 1e-6);
                    assert!(1.0 - d.z <= m + 2e-7);
                    let (x, y, z) = (f64::from(d.x), f64::from(d.y), f64::from(d.z));
                    let sin2 = x * x + y * y;
                    assert!(m > 1.0 || sin2 <= max * (2.0 - max) * (1.0 + 1e-6));
                    let k = if z > 0.5 {
                        sin2 / (1.0 + (1.0 - sin2).max(0.0).sqrt())
                    } else {
                        1.0 - z
                    };
                    let root = max.sqrt();
                    let values = [k / max, (k / max).powi(2), x / root, y / root, x * x / max];
                    for (sum, value) in sums.iter_mut().zip(values) {
                        *sum += value / f64::from(n * n);
                    }
                }
            }
            let expected = [0.5, 1.0 / 3.0, 0.0, 0.0, 0.5 - max / 6.0];
            for (sum, expected) in sums.iter().zip(expected) {
                assert!((sum - expected).abs() < 1e-4, "{m}: {sums:?}");
            }
        }
    }

    #[test]
    fn ends() {
        assert_eq!(uniform_cone(0.3, 0.9, 0.0), Vec3::Z);
        assert_eq!(uniform_cone(0.5, 0.5, 1e-8), Vec3::Z);
        assert_eq!(uniform_cone_pdf(0.0), f32::INFINITY);
        assert_eq!(uniform_cone_pdf(2.0), 0.5 / TAU);
        // The rim of a cone that a cosine could not tell from none: sin^2 = 2e-8.
        let rim = uniform_cone(1.0, 0.5, 1e-8);
        assert!((rim.x / 1.414_213_6e-4 - 1.0).abs() < 1e-6);
    }

    /// Strata stay compact: neighbouring numbers give directions no further apart than their distance times the
    /// cone's width, but for a constant.
    #[test]
    fn neighbours_stay_near() {
        let (m, n) = (1e-6_f32, 64);
        let at = |i: i32, j: i32| uniform_cone(i as f32 / n as f32, j as f32 / n as f32, m);
        for i in 0..n {
            for j in 0..n {
                let d = at(i, j).truncate();
                let step = (at(i + 1, j).truncate() - d).length();
                let other = (at(i, j + 1).truncate() - d).length();
                assert!(step.max(other) < 3.0 * (2.0 * m).sqrt() / n as f32);
            }
        }
    }
}
