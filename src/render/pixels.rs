//! Single pixels of a frame.

use super::sampler::{Sampler, Work};
use super::{PixelSampling, Renderer};
use crate::camera::Camera;
use glam::Vec3;
use rayon::prelude::*;

/// Pixels that are rendered together.
const CHUNK: usize = 64;

impl Renderer<'_> {
    /// The A and B half buffers at some pixels of a frame, columns and rows given: what [`Renderer::render_frame`]
    /// makes of its first samples. Both are equal where there is no noise.
    pub fn render_pixels(
        &self,
        camera: &Camera,
        frame: u32,
        pixels: &[(u32, u32)],
    ) -> Vec<[Vec3; 2]> {
        let sampler = Sampler::new(self, camera, frame);
        let corners: &[(u32, u32)] = match self.settings.sampling {
            PixelSampling::Corners => &[(0, 0), (1, 0), (0, 1), (1, 1)],
            PixelSampling::Center | PixelSampling::Spread(_) => &[(0, 0)],
        };
        let of_chunk = |pixels: &[(u32, u32)]| -> Vec<[Vec3; 2]> {
            let points = pixels
                .iter()
                .flat_map(|(x, y)| corners.iter().map(move |(dx, dy)| (x + dx, y + dy)));
            let points: Vec<(u32, u32)> = points.collect();
            let means = sampler.means(&points, |_| (0, 1), &mut Work::default());
            let of_pixel = |means: &[Vec3]| {
                let half = |half: usize| {
                    let values = means.iter().skip(half).step_by(sampler.half_buffers);
                    values.sum::<Vec3>() / corners.len() as f32
                };
                [half(0), half(sampler.half_buffers - 1)]
            };
            let means = means.chunks(corners.len() * sampler.half_buffers);
            means.map(of_pixel).collect()
        };
        pixels.par_chunks(CHUNK).flat_map_iter(of_chunk).collect()
    }
}
