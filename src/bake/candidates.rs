//! Candidates for primary records: points that the pixels of a frame see.

use super::placement::Candidate;
use crate::accel::QueryState;
use crate::camera::Camera;
use crate::integrator::visible_points;
use crate::math::Ray;
use crate::sampling::{SobolSequence, van_der_corput_order};
use crate::scene::Scene;
use glam::DVec2;
use rayon::prelude::*;

/// Side of the squares of pixels that each get one camera ray.
const STRIDE: f64 = 8.0;

/// Frames of fewer rows are probed as if they had this many, so that small frames get as many candidates.
const MIN_ROWS: u32 = 240;

/// Neighbouring rays that are traced together.
const BATCH: u32 = 64;

/// A frame whose visible points are candidates.
pub(super) struct FrameProbe<'a> {
    pub(super) scene: &'a Scene,
    pub(super) camera: Camera,
    /// Columns and rows.
    pub(super) size: (u32, u32),
    pub(super) bounces: u32,
    /// The smallest radius, in pixels, of records that the camera sees directly, and in mirrors.
    pub(super) min_pixels: [f32; 2],
    pub(super) seed: u32,
    /// Chooses the position within all squares.
    pub(super) pass: u32,
}

/// The points that a frame sees, by the number of bounces left less 1, in an order of which every prefix is spread
/// over the frame.
pub(super) fn candidates(probe: &FrameProbe) -> Vec<Vec<Candidate>> {
    let (width, height) = probe.size;
    let bounces = probe.bounces;
    let rays = probe
        .camera
        .rays(DVec2::new(width.into(), height.into()), probe.scene.origin);
    // Size of a pixel, in pixels of the frame, if the frame had at least `MIN_ROWS` rows.
    let pixel = f64::from(height) / f64::from(height.max(MIN_ROWS));
    let pixel_angle = (pixel * 2.0 * probe.camera.half_height / f64::from(height)) as f32;
    let shift = SobolSequence::new(probe.seed, 0, 0, 0).sample_2d(probe.pass, 0);
    let shift = DVec2::new(shift[0].into(), shift[1].into());
    let stride = STRIDE * pixel;
    let squares = |pixels: u32| (f64::from(pixels) / stride).ceil() as u32;
    let (columns, rows) = (squares(width), squares(height));
    let ray = |index: u32| -> Option<Ray> {
        let square = DVec2::new((index % columns).into(), (index / columns).into());
        let film = (square + shift) * stride;
        let is_on_film = index < columns * rows && film.x < width.into() && film.y < height.into();
        is_on_film.then(|| rays.through(film))
    };
    let visible: Vec<_> = (0..(columns * rows).div_ceil(BATCH))
        .into_par_iter()
        .flat_map_iter(|batch| {
            let rays: Vec<Ray> = (batch * BATCH..(batch + 1) * BATCH)
                .filter_map(ray)
                .collect();
            visible_points(probe.scene, &rays, bounces, &mut QueryState::default())
        })
        .collect();
    let with_bounces = |bounces_left: u32| {
        let visible: Vec<_> = visible
            .iter()
            .filter(|visible| visible.bounces_left == bounces_left)
            .collect();
        let pixels = probe.min_pixels[usize::from(bounces_left < bounces)];
        van_der_corput_order(visible.len() as u32)
            .map(|index| visible[index as usize])
            .map(|visible| Candidate {
                point: visible.point,
                min_radius: pixels * pixel_angle * visible.distance,
            })
            .collect()
    };
    (1..=bounces).map(with_bounces).collect()
}
