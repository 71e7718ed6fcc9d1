use super::order::spread;
use super::placement::Candidate;
use crate::accel::Traversal;
use crate::camera::Camera;
use crate::integrator::visible_points;
use crate::math::Ray;
use crate::sampling::Sequence;
use crate::scene::Scene;
use glam::DVec2;
use rayon::prelude::*;

/// One point is looked at in each frame in a square of so many pixels across.
const STRIDE: f64 = 8.0;

/// Frames of fewer rows are looked at as if they had so many: they are worth as much.
const LEAST_ROWS: u32 = 240;

/// So many rays are traced together, side by side.
const BATCH: u32 = 64;

/// A frame whose pixels are looked at.
pub(super) struct Film<'a> {
    pub(super) scene: &'a Scene,
    pub(super) camera: Camera,
    /// Columns and rows.
    pub(super) size: (u32, u32),
    pub(super) bounces: u32,
    /// The least radius of places that the camera sees, and of those in mirrors.
    pub(super) least_pixels: [f32; 2],
    pub(super) seed: u32,
    /// Chooses which point of each square.
    pub(super) turn: u32,
}

/// What a frame sees, by the number of bounces left less 1: points all over the frame, in an order of which
/// every beginning is spread.
pub(super) fn candidates(film: &Film) -> Vec<Vec<Candidate>> {
    let (width, height) = film.size;
    let bounces = film.bounces;
    let rays = film
        .camera
        .rays(DVec2::new(width.into(), height.into()), film.scene.origin);
    // Of the pixels that places are measured by.
    let pixel = f64::from(height) / f64::from(height.max(LEAST_ROWS));
    let pixel_angle = (pixel * 2.0 * film.camera.half_height / f64::from(height)) as f32;
    let shift = Sequence::new(film.seed, 0, 0, 0).sample_2d(film.turn, 0);
    let shift = DVec2::new(shift[0].into(), shift[1].into());
    let stride = STRIDE * pixel;
    let squares = |pixels: u32| (f64::from(pixels) / stride).ceil() as u32;
    let (columns, rows) = (squares(width), squares(height));
    let ray = |number: u32| -> Option<Ray> {
        let square = DVec2::new((number % columns).into(), (number / columns).into());
        let film = (square + shift) * stride;
        let is_on_film = number < columns * rows && film.x < width.into() && film.y < height.into();
        is_on_film.then(|| rays.through(film))
    };
    let seen: Vec<_> = (0..(columns * rows).div_ceil(BATCH))
        .into_par_iter()
        .flat_map_iter(|batch| {
            let rays: Vec<Ray> = (batch * BATCH..(batch + 1) * BATCH)
                .filter_map(ray)
                .collect();
            visible_points(film.scene, &rays, bounces, &mut Traversal::default())
        })
        .collect();
    let of_level = |left: u32| {
        let of_level: Vec<_> = seen
            .iter()
            .filter(|seen| seen.bounces_left == left)
            .collect();
        let pixels = film.least_pixels[usize::from(left < bounces)];
        spread(of_level.len() as u32)
            .map(|number| of_level[number as usize])
            .map(|seen| Candidate {
                point: seen.point,
                least_radius: pixels * pixel_angle * seen.distance,
            })
            .collect()
    };
    (1..=bounces).map(of_level).collect()
}
