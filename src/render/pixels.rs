//! Single pixels of a frame.

use super::sampler::{QuadrantSums, SampleRun, Sampler, Work};
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
        let sampler = &Sampler::new(self, camera, frame);
        let corners: &[(u32, u32)] = match self.settings.sampling {
            PixelSampling::Corners => &[(0, 0), (1, 0), (0, 1), (1, 1)],
            _ => &[(0, 0)],
        };
        let of_chunk = |pixels: &[(u32, u32)]| -> Vec<[Vec3; 2]> {
            let points = pixels
                .iter()
                .flat_map(|(x, y)| corners.iter().map(move |(dx, dy)| (x + dx, y + dy)));
            let runs = points.flat_map(|point| {
                (0..sampler.half_buffers).map(move |half| SampleRun {
                    point,
                    sequence: sampler.sequence(half),
                    first: 0,
                    end: sampler.first,
                })
            });
            let sums = sampler.sums(&runs.collect::<Vec<_>>(), &mut Work::default());
            let of_pixel = |sums: &[QuadrantSums]| {
                let half = |half: usize| {
                    let of_half = sums.iter().skip(half).step_by(sampler.half_buffers);
                    of_half.map(|sums| sums.mean().as_vec3()).sum::<Vec3>() / corners.len() as f32
                };
                [half(0), half(sampler.half_buffers - 1)]
            };
            let sums = sums.chunks(corners.len() * sampler.half_buffers);
            sums.map(of_pixel).collect()
        };
        pixels.par_chunks(CHUNK).flat_map_iter(of_chunk).collect()
    }
}
