//! A sky whose radiance depends on the elevation alone.

use crate::math::color::luminance;
use crate::sampling::PiecewiseConstant1D;
use glam::Vec3;
use std::f32::consts::TAU;

/// A sky whose radiance is linear in the sine of the elevation, the direction's y, above and below the horizon.
///
/// Black at the horizon and below, it is the cosine sky about +Y: of the radiance L at the zenith it casts the irradiance
/// 2 pi / 3 L on a horizontal plate.
#[derive(Clone, Debug)]
pub struct SkyGradient {
    zenith: Vec3,
    horizon: Vec3,
    nadir: Vec3,
    /// The choice of the upper hemisphere, which is cell 0, or the lower one.
    halves: PiecewiseConstant1D,
    /// For each of them the pdf of |y| at the horizon and at the pole, linear in between.
    ends: [[f32; 2]; 2],
}

impl SkyGradient {
    /// Of the radiances at y = 1, 0 and -1, linear RGB in W/(sr m²), each 0 or more.
    pub fn new(zenith: Vec3, horizon: Vec3, nadir: Vec3) -> SkyGradient {
        let lines = [zenith, nadir].map(|pole| [horizon, pole].map(luminance));
        let sums = lines.map(|[horizon, pole]| horizon + pole);
        let ends = lines.map(|line| {
            let sum: f64 = line.iter().sum();
            match sum > 0.0 {
                true => line.map(|end| (2.0 * end / sum) as f32),
                false => [1.0; 2],
            }
        });
        SkyGradient {
            zenith,
            horizon,
            nadir,
            halves: PiecewiseConstant1D::new(&sums),
            ends,
        }
    }

    /// See [`Sky::radiance`](super::Sky::radiance).
    #[inline]
    pub(super) fn radiance(&self, direction: Vec3) -> Vec3 {
        let pole = [self.zenith, self.nadir][half(direction)];
        self.horizon.lerp(pole, height(direction))
    }

    /// The colours at the zenith, the horizon and the nadir.
    pub(super) fn colors(&self) -> [Vec3; 3] {
        [self.zenith, self.horizon, self.nadir]
    }

    /// A direction for two numbers in [0, 1), by [`SkyGradient::pdf`]: in proportion to the luminance.
    pub(super) fn sample(&self, [u, v]: [f32; 2]) -> Vec3 {
        let (half, v) = self.halves.sample(v);
        let height = sample_linear(v, self.ends[half]);
        let radius = ((1.0 - height) * (1.0 + height)).sqrt();
        let (sin, cos) = libm::sincosf(TAU * u);
        let y = if half == 0 { height } else { -height };
        Vec3::new(radius * cos, y, radius * sin)
    }

    /// The pdf of a direction over solid angle.
    #[inline]
    pub(super) fn pdf(&self, direction: Vec3) -> f32 {
        let half = half(direction);
        let [horizon, pole] = self.ends[half];
        let height = height(direction);
        self.halves.probability(half) * (horizon * (1.0 - height) + pole * height) / TAU
    }

    /// Bytes besides its own.
    pub(super) fn memory(&self) -> usize {
        self.halves.memory()
    }
}

/// The hemisphere of a direction: 0 above, 1 below.
#[inline]
fn half(direction: Vec3) -> usize {
    usize::from(direction.y < 0.0)
}

/// The sine of the angle to the horizon, which rounding may take beyond 1.
#[inline]
fn height(direction: Vec3) -> f32 {
    direction.y.abs().min(1.0)
}

/// A number in 0..=1 with a pdf in proportion to a line from `start` to `end`, both 0 or more and of sum 2, for a
/// number in [0, 1): Pharr, Jakob and Humphreys 2023, "Physically Based Rendering", section A.4.1.
fn sample_linear(u: f32, [start, end]: [f32; 2]) -> f32 {
    if u == 0.0 {
        return 0.0;
    }
    let root = (start * start * (1.0 - u) + end * end * u).sqrt();
    (u * (start + end) / (start + root)).min(1.0)
}
