//! Warps of the unit square to directions, through the concentric map of Shirley and Chiu 1997, "A Low Distortion Map
//! Between Disk and Square".

use glam::{Vec2, Vec3};

/// A unit direction around +Z with pdf cos(theta) / pi, from two numbers in [0, 1).
///
/// The disk is projected up to the hemisphere (Malley's method). Never below the horizon.
#[inline]
pub fn cosine_hemisphere(u: f32, v: f32) -> Vec3 {
    let (disk, radius) = concentric_disk(u, v);
    disk.extend((1.0 - radius * radius).max(0.0).sqrt())
}

/// A unit direction with pdf 1 / (4 pi), from two numbers in 0..=1.
///
/// The disk is wrapped around the sphere by Lambert's azimuthal equal-area projection.
#[inline]
pub fn uniform_sphere(u: f32, v: f32) -> Vec3 {
    let (disk, radius) = concentric_disk(u, v);
    let rest = (1.0 - radius * radius).max(0.0);
    (2.0 * rest.sqrt() * disk).extend(rest - radius * radius)
}

/// A point uniform in the unit disk and its distance from the centre: the concentric map, which keeps the strata of
/// the square compact.
#[inline]
pub(super) fn concentric_disk(u: f32, v: f32) -> (Vec2, f32) {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return (Vec2::ZERO, 0.0);
    }
    // The angle to the nearest axis is at most pi / 4.
    let (x, y) = if a.abs() > b.abs() {
        let (sin, cos) = sin_cos_eighth(b / a);
        (a * cos, a * sin)
    } else {
        let (sin, cos) = sin_cos_eighth(a / b);
        (b * sin, b * cos)
    };
    (Vec2::new(x, y), a.abs().max(b.abs()))
}

/// Sine and cosine of `x` pi / 4 for |x| <= 1, by their power series: accurate to an ulp, and the same on every
/// machine, unlike those of the system's mathematics library.
fn sin_cos_eighth(x: f32) -> (f32, f32) {
    let angle = std::f32::consts::FRAC_PI_4 * x;
    let t = angle * angle;
    let sin = 1.0
        - t * (1.0 / 6.0)
            * (1.0 - t * (1.0 / 20.0) * (1.0 - t * (1.0 / 42.0) * (1.0 - t * (1.0 / 72.0))));
    let cos = 1.0
        - t * 0.5 * (1.0 - t * (1.0 / 12.0) * (1.0 - t * (1.0 / 30.0) * (1.0 - t * (1.0 / 56.0))));
    (angle * sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_agree_with_the_functions() {
        for i in -1000..=1000 {
            let x = i as f32 / 1000.0;
            let (sin, cos) = sin_cos_eighth(x);
            let angle = f64::from(x) * std::f64::consts::FRAC_PI_4;
            assert!((f64::from(sin) - angle.sin()).abs() < 1.2e-7);
            assert!((f64::from(cos) - angle.cos()).abs() < 1.2e-7);
        }
    }

    /// Moments of the uniform pdf: E[x] = E[y] = E[z] = 0, E[x^2] = E[y^2] = E[z^2] = 1/3, E[z^4] = 1/5.
    #[test]
    fn moments_of_the_sphere() {
        let n = 1000;
        let mut sums = [0.0_f64; 7];
        for i in 0..n {
            for j in 0..n {
                let d = uniform_sphere((i as f32 + 0.5) / n as f32, (j as f32 + 0.5) / n as f32);
                assert!((d.length() - 1.0).abs() < 1e-6);
                let (x, y, z) = (f64::from(d.x), f64::from(d.y), f64::from(d.z));
                for (sum, value) in sums
                    .iter_mut()
                    .zip([x, y, z, x * x, y * y, z * z, z.powi(4)])
                {
                    *sum += value / f64::from(n * n);
                }
            }
        }
        let third = 1.0 / 3.0;
        for (sum, expected) in sums.iter().zip([0.0, 0.0, 0.0, third, third, third, 0.2]) {
            assert!((sum - expected).abs() < 1e-5, "{sums:?}");
        }
    }

    /// Moments of the pdf cos(theta) / pi: E[z] = 2/3, E[z^2] = 1/2, E[x] = E[y] = 0, E[x^2] = 1/4.
    #[test]
    fn moments_of_the_cosine_weighted_hemisphere() {
        let n = 1000;
        let mut sums = [0.0_f64; 5];
        for i in 0..n {
            for j in 0..n {
                let d = cosine_hemisphere((i as f32 + 0.5) / n as f32, (j as f32 + 0.5) / n as f32);
                assert!((d.length() - 1.0).abs() < 1e-6 && d.z >= 0.0);
                let (x, y, z) = (f64::from(d.x), f64::from(d.y), f64::from(d.z));
                for (sum, value) in sums.iter_mut().zip([z, z * z, x, y, x * x]) {
                    *sum += value / f64::from(n * n);
                }
            }
        }
        for (sum, expected) in sums.iter().zip([2.0 / 3.0, 0.5, 0.0, 0.0, 0.25]) {
            assert!((sum - expected).abs() < 3e-5, "{sums:?}");
        }
    }
}
