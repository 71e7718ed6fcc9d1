//! A sky from an image: an environment map (Blinn and Newell 1976, "Texture and Reflection in Computer Generated
//! Images"), sampled by its luminance as in Pharr, Jakob and Humphreys 2023, "Physically Based Rendering", section
//! 12.5.2.

use super::cell_means::cell_means;
use super::sphere_cells::SphereCells;
use crate::math::color::luminance;
use glam::{DVec3, Vec3};
use std::f32::consts::{PI, TAU};

/// The most columns and rows of the cells by which directions are sampled.
const MAX_CELLS: [usize; 2] = [512, 256];

/// A latitude-longitude image of the sky.
///
/// The top row is at +Y, the bottom row at -Y. From left to right the columns are towards -Z, +X, +Z in the middle, -X
/// and -Z again: the `envmap` of Mitsuba 3 without a transform, and Blender's environment texture after a quarter turn.
/// Texel centres lie at half-integers, as in Blender; between them radiance is interpolated bilinearly, around the back
/// and constant over the poles.
#[derive(Clone, Debug)]
pub struct SkyMap {
    width: usize,
    height: usize,
    texels: Vec<Vec3>,
    /// Its rotation as a fraction of a turn, in [0, 1).
    turn: f32,
    mean: Vec3,
    cells: SphereCells,
}

impl SkyMap {
    /// Of rows of radiance from the top of the image, each from the left: linear RGB in W/(sr m²), each channel finite
    /// and 0 or more. It is rotated about +Y, in radians, counter-clockwise seen from above. None if the number of
    /// `texels` is 0 or not `width * height`.
    pub fn new(width: usize, height: usize, texels: Vec<Vec3>, rotation: f64) -> Option<SkyMap> {
        if texels.is_empty() || Some(texels.len()) != width.checked_mul(height) {
            return None;
        }
        // Two cells for each texel follow the interpolation.
        let [columns, rows] = [(width, MAX_CELLS[0]), (height, MAX_CELLS[1])]
            .map(|(texels, most)| most.min(2 * texels));
        let means = cell_means([columns, rows], [width, height], |column, row| {
            luminance(texels[row * width + column])
        });
        let turn = (rotation / std::f64::consts::TAU).rem_euclid(1.0) as f32;
        Some(SkyMap {
            mean: mean_over_sphere(height, &texels),
            cells: SphereCells::new(columns, &means),
            turn: if turn < 1.0 { turn } else { 0.0 },
            width,
            height,
            texels,
        })
    }

    /// See [`Sky::radiance`](super::Sky::radiance).
    #[inline]
    pub(super) fn radiance(&self, direction: Vec3) -> Vec3 {
        // Not the arc cosine of y, which is coarse near the poles.
        let from_axis = (direction.x * direction.x + direction.z * direction.z).sqrt();
        let latitude = libm::atan2f(from_axis, direction.y) / PI;
        // The positions are in 0.5..=count + 0.5, so that truncation is floor.
        let x = self.longitude(direction) * self.width as f32 + 0.5;
        let y = latitude * self.height as f32 + 0.5;
        let (right, below) = (x as usize, y as usize);
        let left = if right == 0 { self.width } else { right } - 1;
        let columns = [left, if right < self.width { right } else { 0 }];
        let rows = [below.saturating_sub(1), below.min(self.height - 1)];
        let row = |row: usize| {
            let [left, right] = columns.map(|column| self.texels[row * self.width + column]);
            left.lerp(right, x - x.trunc())
        };
        row(rows[0]).lerp(row(rows[1]), y - y.trunc())
    }

    /// The mean radiance over the sphere.
    pub(super) fn mean(&self) -> Vec3 {
        self.mean
    }

    /// Whether all of it is black.
    pub(super) fn is_black(&self) -> bool {
        self.texels.iter().all(|texel| *texel == Vec3::ZERO)
    }

    /// A direction for two numbers in [0, 1), by [`SkyMap::pdf`]: about in proportion to the luminance.
    pub(super) fn sample(&self, u: [f32; 2]) -> Vec3 {
        let [longitude, y] = self.cells.sample(u);
        let (sin, cos) = libm::sincosf(TAU * (0.5 + self.turn - longitude));
        let radius = ((1.0 - y) * (1.0 + y)).sqrt();
        Vec3::new(radius * sin, y, radius * cos)
    }

    /// The pdf of a direction over solid angle.
    #[inline]
    pub(super) fn pdf(&self, direction: Vec3) -> f32 {
        self.cells.pdf([self.longitude(direction), direction.y])
    }

    /// Bytes besides its own.
    pub(super) fn memory(&self) -> usize {
        size_of_val(&*self.texels) + self.cells.memory()
    }

    /// The fraction of the image's width at which a direction lies, in 0..=1.
    #[inline]
    fn longitude(&self, direction: Vec3) -> f32 {
        let around = 0.5 - libm::atan2f(direction.x, direction.z) / TAU + self.turn;
        if around < 1.0 { around } else { around - 1.0 }
    }
}

/// The mean over the sphere of an image of `height` rows, exact for its interpolation.
fn mean_over_sphere(height: usize, texels: &[Vec3]) -> Vec3 {
    let step = std::f64::consts::PI / height as f64;
    // The integral of a row's weight in the interpolation, a tent, over half the sine of the angle to +Y.
    let between = (1.0 - libm::cos(step)) / step;
    let weight = |row: usize| between * libm::sin((row as f64 + 0.5) * step);
    // The first and the last row, which reach to the poles, have the rest in equal parts.
    let ends = height.min(2);
    let inner = 1..height.saturating_sub(1);
    let rest = 1.0 - inner.clone().map(weight).sum::<f64>();
    let rows = texels.chunks_exact(texels.len() / height).enumerate();
    let sum: DVec3 = rows
        .map(|(row, texels)| {
            let sum: DVec3 = texels.iter().map(|texel| texel.as_dvec3()).sum();
            let weight = if inner.contains(&row) {
                weight(row)
            } else {
                rest / ends as f64
            };
            sum * weight / texels.len() as f64
        })
        .sum();
    sum.as_vec3()
}
