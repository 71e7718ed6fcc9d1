//! Candidates: points that the pixels of a frame see, where an irradiance cache needs records.

use crate::accel::QueryState;
use crate::camera::{Camera, CameraPath};
use crate::integrator::visible_points;
use crate::math::Ray;
use crate::sampling::{SobolSequence, van_der_corput_order};
use crate::scene::{Scene, SurfacePoint};
use glam::DVec2;
use rayon::prelude::*;

/// Bounds of the side of the squares of pixels that each get one camera ray.
const MIN_STRIDE: f64 = 2.0;
const MAX_STRIDE: f64 = 8.0;

/// About how many camera rays there are in all frames together: short paths get more for each frame.
const ALL_RAYS: f64 = 3e6;

/// Frames of fewer rows are probed as if they had this many: so small frames, which are test renders of large ones, get
/// as good a cache.
const MIN_ROWS: u32 = 240;

/// Objects that mirrors show count as if they were this much farther away: they contribute less.
const MIRRORED: f32 = 2.0;

/// Neighbouring rays that are traced together.
const BATCH: u32 = 64;

/// A surface point that a pixel sees.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) point: SurfacePoint,
    /// The size of a pixel there, in metres.
    pub(super) pixel: f32,
}

/// The frames of a path whose visible points are candidates.
pub(super) struct PathProbe<'a> {
    pub(super) scene: &'a Scene,
    pub(super) path: &'a CameraPath,
    /// Columns and rows.
    pub(super) size: (u32, u32),
    pub(super) bounces: u32,
    pub(super) seed: u32,
}

impl PathProbe<'_> {
    fn frames(&self) -> u32 {
        self.path.timeline().frame_count()
    }

    /// The numbers of the frames, in an order in which the first ones are far apart.
    pub(super) fn frames_in_order(&self) -> Vec<u32> {
        van_der_corput_order(self.frames()).collect()
    }

    /// The points that a frame sees, by the number of bounces left less 1.
    pub(super) fn candidates(&self, frame: u32) -> Vec<Vec<Candidate>> {
        let camera = self.path.camera(frame);
        let (width, height) = self.size;
        let film_rays = camera.rays(DVec2::new(width.into(), height.into()), self.scene.origin);
        // Size of a pixel, in pixels of the frame, if the frame had at least `MIN_ROWS` rows.
        let pixel = f64::from(height) / f64::from(height.max(MIN_ROWS));
        let pixel_angle = pixel_angle(&camera, pixel / f64::from(height));
        let shift = SobolSequence::new(self.seed, 0, 0, 0).sample_2d(frame, 0);
        let shift = DVec2::new(shift[0].into(), shift[1].into());
        let pixels = f64::from(width) * f64::from(height) / (pixel * pixel);
        let stride = (f64::from(self.frames()) * pixels / ALL_RAYS).sqrt();
        let stride = stride.clamp(MIN_STRIDE, MAX_STRIDE) * pixel;
        let squares = |pixels: u32| (f64::from(pixels) / stride).ceil() as u32;
        let (columns, rows) = (squares(width), squares(height));
        let ray = |index: u32| -> Option<Ray> {
            let square = DVec2::new((index % columns).into(), (index / columns).into());
            let film = (square + shift) * stride;
            let is_on_film =
                index < columns * rows && film.x < width.into() && film.y < height.into();
            is_on_film.then(|| film_rays.through(film))
        };
        let visible: Vec<_> = (0..(columns * rows).div_ceil(BATCH))
            .into_par_iter()
            .flat_map_iter(|batch| {
                let rays = (batch * BATCH..(batch + 1) * BATCH).filter_map(ray);
                let rays: Vec<Ray> = rays.collect();
                visible_points(self.scene, &rays, self.bounces, &mut QueryState::default())
            })
            .collect();
        let mut candidates = vec![Vec::new(); self.bounces as usize];
        for visible in visible {
            let mirrored = if visible.bounces_left < self.bounces {
                MIRRORED
            } else {
                1.0
            };
            candidates[visible.bounces_left as usize - 1].push(Candidate {
                point: visible.point,
                pixel: mirrored * pixel_angle * visible.distance,
            });
        }
        candidates
    }
}

/// The angle, in radians, of a part of a frame's height in the middle of the frame.
fn pixel_angle(camera: &Camera, part: f64) -> f32 {
    (2.0 * camera.half_height * part) as f32
}
