use glam::Vec3;

/// A unit direction about +Z with density cos(theta) / pi, from two numbers in [0, 1).
///
/// Concentric disk of Shirley and Chiu 1997 lifted to the hemisphere (Malley's method): it keeps
/// the strata of the square compact. Never below the horizon.
#[inline]
pub fn cosine_hemisphere(u: f32, v: f32) -> Vec3 {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return Vec3::Z;
    }
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};
    let (radius, angle) = if a.abs() > b.abs() {
        (a, FRAC_PI_4 * (b / a))
    } else {
        (b, FRAC_PI_2 - FRAC_PI_4 * (a / b))
    };
    let (sin, cos) = angle.sin_cos();
    let z = (1.0 - radius * radius).max(0.0).sqrt();
    Vec3::new(radius * cos, radius * sin, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moments of the density cos/pi: E[z] = 2/3, E[z^2] = 1/2, E[x] = E[y] = 0, E[x^2] = 1/4.
    #[test]
    fn moments_of_the_cosine_density() {
        let n = 1000;
        let mut sums = [0.0_f64; 5];
        for i in 0..n {
            for j in 0..n {
                let d = cosine_hemisphere(
                    (i as f32 + 0.5) / n as f32,
                    (j as f32 + 0.5) / n as f32,
                );
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
