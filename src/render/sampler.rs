use super::grid::Grid;
use super::observer::FrameObserver;
use super::{PixelSampling, Renderer};
use crate::accel::Traversal;
use crate::camera::{Camera, CameraRays};
use crate::integrator::{CameraSample, Integrator};
use crate::sampling::Sequence;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

/// So many camera rays set out together.
const BATCH: usize = 256;

/// How the points of a frame are sampled.
///
/// Where there is noise, samples are taken in two independent half buffers, A and B, whose difference tells the
/// variance of their mean: half of the samples each or, of a single sample, one each with half of the paths from the
/// first diffuse bounce. Odd numbers are rounded up.
pub(super) struct Sampler<'a> {
    rays: CameraRays,
    sampling: PixelSampling,
    /// Of each half.
    integrator: Integrator<'a>,
    /// Of each half in one pass.
    samples: u32,
    /// 1 or 2.
    pub(super) halves: usize,
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
        let mut halves = 1;
        if settings.has_noise() {
            halves = 2;
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
            halves,
            seed: settings.seed,
            frame: if settings.lock_seed { 0 } else { frame },
        }
    }

    /// How many passes a point can take: single precision tells 2^24 camera samples of a half apart, and 32
    /// bits number their paths.
    pub(super) fn most_passes(&self) -> u32 {
        let splits = self.integrator.splits().iter();
        let paths = splits.map(|&split| u64::from(split));
        let paths = paths.fold(1, u64::saturating_mul);
        let samples = (1_u64 << 24).min((1_u64 << 32) / paths);
        (samples as u32 / self.samples).max(1)
    }

    /// The mean light of each half of each point, half by half, in the passes that `passes` gives: those
    /// before `.0` were taken before, those before `.1`, one more at least, are taken now.
    pub(super) fn means(
        &self,
        points: &[(u32, u32)],
        passes: impl Fn((u32, u32)) -> (u32, u32),
        work: &mut Work,
    ) -> Vec<Vec3> {
        // In double precision: a million equal numbers would not add up in single precision.
        let mut sums = vec![DVec3::ZERO; points.len() * self.halves];
        let mut batch = Batch::default();
        for (number, &(x, y)) in points.iter().enumerate() {
            let (first, last) = passes((x, y));
            let corner = DVec2::new(x.into(), y.into());
            let sequence = Sequence::new(self.seed, self.frame, x, y);
            for half in 0..self.halves {
                let sequence = match self.halves {
                    1 => sequence,
                    _ => sequence.half(half as u32),
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
                    let ray = self.rays.through(film);
                    batch.samples.push(CameraSample {
                        ray,
                        sequence,
                        index,
                    });
                    batch.owners.push(number * self.halves + half);
                    if batch.samples.len() == BATCH {
                        self.trace(&mut batch, work, &mut sums);
                    }
                }
            }
        }
        self.trace(&mut batch, work, &mut sums);
        let count = |number: usize| {
            let (first, last) = passes(points[number / self.halves]);
            f64::from((last - first) * self.samples)
        };
        let sums = sums.into_iter().enumerate();
        sums.map(|(number, sum)| (sum / count(number)).as_vec3())
            .collect()
    }

    /// Adds the light of up to [`BATCH`] samples to the sums of their owners, and forgets them.
    fn trace(&self, batch: &mut Batch, work: &mut Work, sums: &mut [DVec3]) {
        let mut radiance = [Vec3::ZERO; BATCH];
        let radiance = &mut radiance[..batch.samples.len()];
        let traversal = &mut work.traversal;
        self.integrator
            .radiance(&batch.samples, traversal, radiance);
        for (owner, light) in batch.owners.iter().zip(radiance) {
            if light.is_finite() {
                sums[*owner] += light.as_dvec3();
            } else {
                work.non_finite += 1;
            }
        }
        batch.samples.clear();
        batch.owners.clear();
    }
}

/// Samples that set out together, and the numbers of the sums that they belong to.
#[derive(Default)]
struct Batch {
    samples: Vec<CameraSample>,
    owners: Vec<usize>,
}

/// What a thread needs while it works on a tile, and what it counts.
#[derive(Default)]
pub(super) struct Work {
    pub(super) traversal: Traversal,
    pub(super) non_finite: u64,
}

/// The points of a tile that took samples, and the mean of these, half by half.
struct RefinedTile {
    points: Vec<(u32, u32)>,
    means: Vec<Vec3>,
    rays: u64,
    non_finite: u64,
}

/// What the points of a frame are known to be so far.
pub(super) struct Estimates {
    /// The mean of each half of each point, half by half.
    pub(super) values: Vec<Vec3>,
    /// How many passes each point has taken.
    pub(super) passes: Vec<u32>,
    pub(super) rays: u64,
    pub(super) non_finite: u64,
}

impl Estimates {
    pub(super) fn new(grid: Grid, sampler: &Sampler) -> Estimates {
        Estimates {
            values: vec![Vec3::ZERO; grid.len() * sampler.halves],
            passes: vec![0; grid.len()],
            rays: 0,
            non_finite: 0,
        }
    }

    /// Takes as many passes at each point, by its number, as are missing to those wanted; tile by tile in
    /// parallel. Once the observer stops, further tiles take none.
    pub(super) fn refine(
        &mut self,
        grid: Grid,
        sampler: &Sampler,
        wanted: impl Fn(usize) -> u32 + Sync,
        observer: &dyn FrameObserver,
    ) {
        let taken = &self.passes;
        let passes = |point| {
            let number = grid.number(point);
            (taken[number], wanted(number))
        };
        let refined: Vec<RefinedTile> = (0..grid.tiles())
            .into_par_iter()
            .map(|tile| {
                let mut points = grid.tile_points(tile);
                let stopped = observer.is_stopped();
                points.retain(|&point| {
                    let (before, now) = passes(point);
                    now > before && !stopped
                });
                let mut work = Work::default();
                let means = sampler.means(&points, passes, &mut work);
                observer.tile_done(work.traversal.rays);
                RefinedTile {
                    points,
                    means,
                    rays: work.traversal.rays,
                    non_finite: work.non_finite,
                }
            })
            .collect();
        for tile in refined {
            for (&point, means) in tile.points.iter().zip(tile.means.chunks(sampler.halves)) {
                let number = grid.number(point);
                let (before, now) = (self.passes[number], wanted(number));
                let share = (now - before) as f32 / now as f32;
                let values = &mut self.values[number * sampler.halves..];
                for (value, mean) in values.iter_mut().zip(means) {
                    *value += share * (mean - *value);
                }
                self.passes[number] = now;
            }
            self.rays += tile.rays;
            self.non_finite += tile.non_finite;
        }
    }
}
