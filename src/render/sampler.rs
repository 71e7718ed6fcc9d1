//! Camera samples of the points of a frame, in runs of consecutive samples of one random sequence.

use super::{PixelSampling, Renderer};
use crate::accel::QueryState;
use crate::camera::{Camera, CameraRays};
use crate::integrator::{CameraSample, Integrator};
use crate::math::{Ray, RayDifferential};
use crate::sampling::SobolSequence;
use glam::{DVec2, DVec3, Vec3};

/// Rows and columns of rays that stand for a camera.
const PROBES: u32 = 8;

/// Camera rays that are traced together.
const BATCH: usize = 256;

/// Consecutive samples of a point in one of its random sequences.
#[derive(Clone, Copy, Debug)]
pub(super) struct SampleRun {
    pub(super) point: (u32, u32),
    pub(super) sequence: Sequence,
    /// The first sample.
    pub(super) first: u32,
    /// The one after the last.
    pub(super) end: u32,
}

/// One of the independent random sequences of a point.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sequence {
    /// Of a picture without half buffers.
    Whole,
    /// Of a half buffer, A (0) or B (1).
    Half(u32),
    /// Of the two estimates of a held-out pixel, each time that pixels are held out.
    HeldOut {
        /// Which of the two estimates, 0 or 1.
        estimate: u32,
        /// How often pixels were held out before.
        round: u32,
        /// How often the pixel was asked for before in this round.
        answer: u32,
        /// Textures are filtered as by a point, or its half buffer, of so many samples; 0 is not at all.
        filtered_as: u32,
    },
}

/// The moments of samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    /// The mean radiance.
    pub(super) mean: Vec3,
    /// The mean over samples and channels of the square of the radiance.
    pub(super) square: f32,
    /// How many samples there are.
    pub(super) count: u32,
}

/// The sums of a run's samples by quadrants of the pixel: upper left, upper right, lower left, lower right.
#[derive(Clone, Copy, Default)]
pub(super) struct QuadrantSums([Sums; 4]);

impl Sequence {
    /// Which half buffer of a point the sequence is of.
    pub(super) fn half(self) -> usize {
        match self {
            Sequence::Half(half) => half as usize,
            Sequence::Whole | Sequence::HeldOut { .. } => 0,
        }
    }
}

impl Moments {
    /// Adds other samples.
    pub(super) fn add(&mut self, other: &Moments) {
        if self.count == 0 {
            *self = *other;
        } else if other.count > 0 {
            self.count += other.count;
            let fraction = other.count as f32 / self.count as f32;
            self.mean += fraction * (other.mean - self.mean);
            self.square += fraction * (other.square - self.square);
        }
    }
}

impl QuadrantSums {
    /// The mean radiance.
    pub(super) fn mean(&self) -> DVec3 {
        let count: u32 = self.0.iter().map(|sums| sums.count).sum();
        let sum: DVec3 = self.0.iter().map(|sums| sums.radiance).sum();
        sum / f64::from(count)
    }

    /// The moments of each quadrant.
    pub(super) fn moments(&self) -> [Moments; 4] {
        self.0.map(|sums| sums.moments())
    }
}

/// How the points of a frame are sampled.
///
/// Where there is Monte Carlo noise, they are in two independent half buffers, A and B, whose difference tells the
/// variance of their mean: half of the samples each or, of a single sample, one each with half of the paths from the
/// first diffuse bounce, and of the shadow rays. Odd numbers are rounded up.
pub(super) struct Sampler<'a> {
    rays: CameraRays,
    position: Position,
    /// Of a run's samples.
    integrator: Integrator<'a>,
    /// The first samples of a point, or of each of its half buffers; adaptive ones double from there.
    pub(super) first: u32,
    /// How many half buffers there are, 2, or 1: the picture itself.
    pub(super) half_buffers: usize,
    seed: u32,
    frame: u32,
    pub(super) is_adaptive: bool,
}

/// Where a camera sample lies, from the point's upper left corner.
#[derive(Clone, Copy)]
enum Position {
    /// At the corner.
    Corner,
    /// In the middle of the pixel.
    Center,
    /// Anywhere in the pixel.
    Spread,
}

impl<'a> Sampler<'a> {
    pub(super) fn new(renderer: &Renderer<'a>, camera: &Camera, frame: u32) -> Sampler<'a> {
        let Renderer {
            settings,
            integrator,
            ..
        } = renderer;
        let size = DVec2::new(settings.width.into(), settings.height.into());
        let (position, mut first) = match settings.sampling {
            PixelSampling::Spread(count) => (Position::Spread, count),
            PixelSampling::Adaptive(_) => (Position::Spread, 1),
            PixelSampling::Center => (Position::Center, 1),
            PixelSampling::Corners => (Position::Corner, 1),
        };
        let rays = camera.rays(size, renderer.scene().origin);
        let middles = (0..PROBES * PROBES).map(|i| {
            let place = DVec2::new((i % PROBES).into(), (i / PROBES).into()) + 0.5;
            rays.through(place * size / f64::from(PROBES))
        });
        let middles: Vec<Ray> = middles.collect();
        let mut integrator = integrator
            .clone()
            .for_camera(&middles, &mut QueryState::default());
        let mut half_buffers = 1;
        if renderer.is_noisy() {
            half_buffers = 2;
            if first == 1 {
                integrator = integrator.with_half_the_paths();
            } else {
                first = first.div_ceil(2);
            }
        }
        Sampler {
            rays,
            position,
            integrator,
            first,
            half_buffers,
            seed: settings.seed,
            frame: if settings.lock_seed { 0 } else { frame },
            is_adaptive: settings.is_adaptive(),
        }
    }

    /// The same sampler of pixels, with samples anywhere in a pixel: what the converged picture is the mean of.
    pub(super) fn of_whole_pixels(&self) -> Sampler<'a> {
        Sampler {
            integrator: self.integrator.clone(),
            position: Position::Spread,
            ..*self
        }
    }

    /// Random numbers of the frame as a whole.
    pub(super) fn frame_sequence(&self, round: u32) -> SobolSequence {
        SobolSequence::new(self.seed, self.frame, u32::MAX, round)
    }

    /// The sequence of a half buffer.
    pub(super) fn sequence(&self, half: usize) -> Sequence {
        match self.half_buffers {
            1 => Sequence::Whole,
            _ => Sequence::Half(half as u32),
        }
    }

    /// The most samples of a run: single precision tells 2^24 camera samples apart, and the indices of their paths and
    /// shadow rays have 32 bits.
    pub(super) fn most(&self) -> u32 {
        let splits = self.integrator.splits().iter();
        let paths = splits.map(|&split| u64::from(split));
        let paths = paths.fold(1, u64::saturating_mul);
        let rays = paths.max(self.integrator.shadow_rays().into());
        let samples = (1_u64 << 24).min((1_u64 << 32) / rays);
        (samples as u32).max(self.first)
    }

    /// The sums of each run, which has at least one sample.
    pub(super) fn sums(&self, runs: &[SampleRun], work: &mut Work) -> Vec<QuadrantSums> {
        // The sum of a million equal numbers is wrong in single precision.
        let mut sums = vec![QuadrantSums::default(); runs.len()];
        let mut batch = Batch::default();
        for (number, run) in runs.iter().enumerate() {
            let (x, y) = run.point;
            let corner = DVec2::new(x.into(), y.into());
            let sequence = SobolSequence::new(self.seed, self.frame, x, y);
            let sequence = match run.sequence {
                Sequence::Whole => sequence,
                Sequence::Half(half) => sequence.stream(half),
                Sequence::HeldOut {
                    estimate,
                    round,
                    answer,
                    ..
                } => sequence.stream(2 + 2 * round + estimate).stream(answer),
            };
            for index in run.first..run.end {
                let [u, v] = match self.position {
                    Position::Corner => [0.0, 0.0],
                    Position::Center => [0.5, 0.5],
                    Position::Spread => sequence.sample_2d(index, 0),
                };
                let film = corner + DVec2::new(u.into(), v.into());
                if let Some(Footprint { width, moved }) = self.footprint(run, index) {
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
                let quadrant = usize::from(u >= 0.5) + 2 * usize::from(v >= 0.5);
                batch.runs.push((number, quadrant));
                if batch.samples.len() == BATCH {
                    self.trace(&mut batch, work, &mut sums);
                }
            }
        }
        self.trace(&mut batch, work, &mut sums);
        sums
    }

    /// Over what a sample of a run filters textures; none in a scene without textures.
    ///
    /// The squares of all samples of a pixel cover it twice, tuned for the least error: their width falls to 0 as the
    /// number of samples grows. They are moved so that the positions that they cover have the variance of those of the
    /// pixel: it would be blurred otherwise. What the converged picture is estimated from is not filtered.
    fn footprint(&self, run: &SampleRun, index: u32) -> Option<Footprint> {
        if self.integrator.scene().textures().is_empty() {
            return None;
        }
        // Of adaptive samples, as many as there were once they doubled up to this one.
        let samples = |index: u32, end: u32| match self.is_adaptive {
            true => f64::from((index + 1).next_power_of_two()),
            false => f64::from(end),
        };
        let area = match (run.sequence, self.position) {
            (Sequence::HeldOut { filtered_as: 0, .. }, _) => 0.0,
            (Sequence::HeldOut { filtered_as, .. }, _) => {
                1.0 / samples(index % filtered_as, filtered_as)
            }
            (_, Position::Center | Position::Corner) => 1.0,
            (Sequence::Whole | Sequence::Half(_), Position::Spread) => {
                1.0 / samples(index, run.end)
            }
        };
        let area = area * 2.0 / self.half_buffers as f64;
        let area = area.min(1.0);
        Some(Footprint {
            width: area.sqrt(),
            moved: match self.position {
                Position::Spread => 1.0 - (1.0 - area).sqrt(),
                Position::Center | Position::Corner => 0.0,
            },
        })
    }

    /// Adds the radiance of up to [`BATCH`] samples to the sums that they belong to, and clears the batch.
    fn trace(&self, batch: &mut Batch, work: &mut Work, sums: &mut [QuadrantSums]) {
        let mut radiance = [Vec3::ZERO; BATCH];
        let radiance = &mut radiance[..batch.samples.len()];
        let query_state = &mut work.query_state;
        self.integrator
            .radiance(&batch.samples, &batch.differentials, query_state, radiance);
        for (&(run, quadrant), radiance) in batch.runs.iter().zip(radiance) {
            let sums = &mut sums[run].0[quadrant];
            sums.count += 1;
            if radiance.is_finite() {
                let radiance = radiance.as_dvec3();
                sums.radiance += radiance;
                sums.square += radiance.length_squared();
            } else {
                work.non_finite += 1;
            }
        }
        batch.samples.clear();
        batch.differentials.clear();
        batch.runs.clear();
    }
}

/// The square of the film over which a sample filters textures.
#[derive(Clone, Copy)]
struct Footprint {
    /// In pixels.
    width: f64,
    /// How far its middle is moved from the sample to the middle of the pixel: 0 not at all, 1 all the way.
    moved: f64,
}

/// Samples that are traced together, their footprints, and the indices of the runs that they belong to.
#[derive(Default)]
struct Batch {
    samples: Vec<CameraSample>,
    /// Empty without textures.
    differentials: Vec<RayDifferential>,
    /// ... and the quadrants that they lie in.
    runs: Vec<(usize, usize)>,
}

/// The sums of samples.
#[derive(Clone, Copy, Default)]
struct Sums {
    radiance: DVec3,
    square: f64,
    count: u32,
}

impl Sums {
    fn moments(&self) -> Moments {
        let count = f64::from(self.count.max(1));
        Moments {
            mean: (self.radiance / count).as_vec3(),
            square: (self.square / (3.0 * count)) as f32,
            count: self.count,
        }
    }
}

/// Scratch space and counters of a thread that renders a tile.
#[derive(Default)]
pub(super) struct Work {
    pub(super) query_state: QueryState,
    pub(super) non_finite: u64,
}
