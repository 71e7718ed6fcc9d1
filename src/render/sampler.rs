//! Camera samples of the points of a frame, and their A/B half buffers. In one pass a point takes the camera samples of
//! the settings, half of them in each half buffer; adaptive sampling adds passes.

use super::{PixelSampling, Renderer};
use crate::accel::QueryState;
use crate::camera::{Camera, CameraRays};
use crate::integrator::{CameraSample, Integrator};
use crate::math::RayDifferential;
use crate::sampling::SobolSequence;
use glam::{DVec2, DVec3, Vec3};

/// Camera rays that are traced together.
const BATCH: usize = 256;

/// How the points of a frame are sampled.
///
/// Where there is noise, samples are taken in two independent half buffers, A and B, whose difference tells the
/// variance of their mean: half of the samples each or, of a single sample, one each with half of the paths from the
/// first diffuse bounce. Odd numbers are rounded up.
pub(super) struct Sampler<'a> {
    rays: CameraRays,
    sampling: PixelSampling,
    /// Of one half buffer.
    integrator: Integrator<'a>,
    /// Of one half buffer in one pass.
    samples: u32,
    /// How many half buffers there are: 1 without noise, else 2.
    pub(super) half_buffers: usize,
    seed: u32,
    frame: u32,
}

impl<'a> Sampler<'a> {
    pub(super) fn new(renderer: &Renderer<'a>, camera: &Camera, frame: u32) -> Sampler<'a> {
        let Renderer {
            settings,
            integrator,
            ..
        } = renderer;
        let size = DVec2::new(settings.width.into(), settings.height.into());
        let mut samples = match settings.sampling {
            PixelSampling::Spread(count) => count,
            PixelSampling::Center | PixelSampling::Corners => 1,
        };
        let mut integrator = integrator.clone();
        let mut half_buffers = 1;
        if settings.has_noise() {
            half_buffers = 2;
            if samples == 1 && !integrator.splits().is_empty() {
                integrator = integrator.with_half_the_paths();
            } else {
                samples = samples.div_ceil(2);
            }
        }
        Sampler {
            rays: camera.rays(size, renderer.scene().origin),
            sampling: settings.sampling,
            integrator,
            samples,
            half_buffers,
            seed: settings.seed,
            frame: if settings.lock_seed { 0 } else { frame },
        }
    }

    /// The most passes of a point: single precision tells 2^24 camera samples of a half buffer apart, and the indices
    /// of their paths have 32 bits.
    pub(super) fn max_passes(&self) -> u32 {
        let splits = self.integrator.splits().iter();
        let paths = splits.map(|&split| u64::from(split));
        let paths = paths.fold(1, u64::saturating_mul);
        let samples = (1_u64 << 24).min((1_u64 << 32) / paths);
        (samples as u32 / self.samples).max(1)
    }

    /// The mean radiance at each point, half buffer by half buffer, over the passes that `passes` gives, from `.0`
    /// to before `.1`: at least one.
    pub(super) fn means(
        &self,
        points: &[(u32, u32)],
        passes: impl Fn((u32, u32)) -> (u32, u32),
        work: &mut Work,
    ) -> Vec<Vec3> {
        // The sum of a million equal numbers is wrong in single precision.
        let mut sums = vec![DVec3::ZERO; points.len() * self.half_buffers];
        let mut batch = Batch::default();
        for (number, &(x, y)) in points.iter().enumerate() {
            let (first, last) = passes((x, y));
            let (width, moved) = self.footprint(last);
            let corner = DVec2::new(x.into(), y.into());
            let sequence = SobolSequence::new(self.seed, self.frame, x, y);
            for half in 0..self.half_buffers {
                let sequence = match self.half_buffers {
                    1 => sequence,
                    _ => sequence.for_half_buffer(half as u32),
                };
                for index in first * self.samples..last * self.samples {
                    let film = match self.sampling {
                        PixelSampling::Corners => corner,
                        PixelSampling::Center => corner + 0.5,
                        PixelSampling::Spread(_) => {
                            let [u, v] = sequence.sample_2d(index, 0);
                            corner + DVec2::new(u.into(), v.into())
                        }
                    };
                    if width > 0.0 {
                        let middle = film.lerp(corner + 0.5, moved);
                        let differential = self.rays.differential(film, middle, width);
                        batch.differentials.push(differential);
                    }
                    let ray = self.rays.through(film);
                    batch.samples.push(CameraSample {
                        ray,
                        sequence,
                        index,
                    });
                    batch.sums.push(number * self.half_buffers + half);
                    if batch.samples.len() == BATCH {
                        self.trace(&mut batch, work, &mut sums);
                    }
                }
            }
        }
        self.trace(&mut batch, work, &mut sums);
        let count = |number: usize| {
            let (first, last) = passes(points[number / self.half_buffers]);
            f64::from((last - first) * self.samples)
        };
        let sums = sums.into_iter().enumerate();
        sums.map(|(number, sum)| (sum / count(number)).as_vec3())
            .collect()
    }

    /// The width in pixels of the square over which each sample of a point filters textures once the point has so many
    /// passes, and how far the middle of the square is moved from the sample to the middle of the pixel: 0 not at all, 1
    /// all the way.
    ///
    /// The squares of all samples cover a pixel twice, tuned for the least error: their width falls to 0 as the number of
    /// samples grows. They are moved so that the positions that they cover have the variance of those of the pixel: it
    /// would be blurred otherwise.
    fn footprint(&self, passes: u32) -> (f64, f64) {
        if self.integrator.scene().textures().is_empty() {
            return (0.0, 0.0);
        }
        match self.sampling {
            PixelSampling::Center | PixelSampling::Corners => (1.0, 0.0),
            PixelSampling::Spread(_) => {
                let samples = f64::from(passes) * f64::from(self.samples);
                let area = (2.0 / (samples * self.half_buffers as f64)).min(1.0);
                (area.sqrt(), 1.0 - (1.0 - area).sqrt())
            }
        }
    }

    /// Adds the radiance of up to [`BATCH`] samples to the sums that they belong to, and clears the batch.
    fn trace(&self, batch: &mut Batch, work: &mut Work, sums: &mut [DVec3]) {
        let mut radiance = [Vec3::ZERO; BATCH];
        let radiance = &mut radiance[..batch.samples.len()];
        let query_state = &mut work.query_state;
        self.integrator
            .radiance(&batch.samples, &batch.differentials, query_state, radiance);
        for (sum, radiance) in batch.sums.iter().zip(radiance) {
            if radiance.is_finite() {
                sums[*sum] += radiance.as_dvec3();
            } else {
                work.non_finite += 1;
            }
        }
        batch.samples.clear();
        batch.differentials.clear();
        batch.sums.clear();
    }
}

/// Samples that are traced together, their footprints, and the indices of the sums that they belong to.
#[derive(Default)]
struct Batch {
    samples: Vec<CameraSample>,
    /// The footprints of the samples; empty without textures.
    differentials: Vec<RayDifferential>,
    sums: Vec<usize>,
}

/// Scratch space and counters of a thread that renders a tile.
#[derive(Default)]
pub(super) struct Work {
    pub(super) query_state: QueryState,
    pub(super) non_finite: u64,
}
