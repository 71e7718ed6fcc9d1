//! A pilot: a few frames of a sequence, rendered small where whole ones would take long, for what they cost.

use crate::camera::CameraPath;
use crate::frames::SequenceRecord;
use crate::render::{
    Claim, EncodedFrame, FrameSink, NoObserver, RenderSettings, RenderedFrame, Renderer, SinkError,
};
use serde::{Deserialize, Serialize};
use std::sync::Mutex;
use std::time::Instant;

/// Frames of a pilot, from the middles of as many parts of the path.
const FRAMES: u32 = 12;

/// A pilot may take this fraction of the time of the sequence, ...
const FRACTION: f64 = 0.02;

/// ... or this many seconds.
const SECONDS: f64 = 4.0;

/// With every halving of a frame's sides, rays are less coherent: each takes longer by up to twice this fraction.
const COHERENCE: f64 = 0.06;

/// With every halving, neighbouring pixels are less alike: their bytes are off by up to this fraction.
const GRAIN: f64 = 0.1;

/// The shortest side of a frame, in pixels.
const MIN_SIDE: u32 = 64;

/// What frames are rendered by and along, and how they would be stored.
#[derive(Clone, Debug)]
pub struct Workload<'a> {
    /// The renderer.
    pub renderer: Renderer<'a>,
    /// The camera path.
    pub path: &'a CameraPath,
    /// Threads.
    pub pool: &'a rayon::ThreadPool,
    /// The expected frames.
    pub sequence: &'a SequenceRecord,
}

/// A few frames of a sequence, rendered for what they cost: as they will be, or smaller.
#[derive(Debug)]
pub struct Pilot {
    /// What they cost at full size, by number.
    pub frames: Vec<PilotFrame>,
    /// Relative error of all seconds because the frames were smaller.
    pub doubt_of_seconds: f64,
    /// The same of the bytes.
    pub doubt_of_bytes: f64,
}

/// What a frame costs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Frame")]
pub struct PilotFrame {
    /// Its number.
    pub frame: u32,
    /// Seconds of the whole program, while others are rendered beside it.
    pub seconds: f64,
    /// Bytes of its files.
    pub bytes: f64,
}

impl Pilot {
    /// Renders frames at a size at which they take no more than they are worth. Where that is smaller than the
    /// sequence's, their bytes go on growing as they did from half of that size. The more pixels, the fewer of them have an
    /// edge: the seconds of adaptive frames grow by less than the pixels, but by more than they did where estimates of the
    /// error, which take a least number of samples, were most of a frame.
    pub fn run(workload: &Workload) -> Pilot {
        let renderer = &workload.renderer;
        let settings = renderer.settings();
        let timeline = workload.path.timeline();
        let chosen = timeline.spread(FRAMES);
        let all = f64::from(timeline.frame_count()) / chosen.len() as f64;
        let sum = |frames: &[PilotFrame], value: fn(&PilotFrame) -> f64| -> f64 {
            frames.iter().map(value).sum()
        };
        let mut halvings = most_halvings(settings);
        let measure = |halvings| {
            let [width, height] = smaller(settings, halvings);
            workload.measure(&renderer.with_size(width, height), &chosen)
        };
        // What is used for the first time takes longer.
        measure(halvings);
        let mut frames = measure(halvings);
        // The powers of the number of pixels that seconds and bytes grow with.
        let mut growth = [1.0; 2];
        while halvings > 0 {
            let seconds = sum(&frames, |frame| frame.seconds);
            let of_sequence = all * seconds * pixels_more(settings, halvings);
            if 4.0 * seconds > SECONDS.max(FRACTION * of_sequence) {
                break;
            }
            let step = pixels_more(settings, halvings) / pixels_more(settings, halvings - 1);
            let larger = measure(halvings - 1);
            let values: [fn(&PilotFrame) -> f64; 2] = [|frame| frame.seconds, |frame| frame.bytes];
            growth = values.map(|value| {
                let [before, now] = [&frames, &larger].map(|frames| sum(frames, value));
                (now / before).ln() / step.ln()
            });
            frames = larger;
            halvings -= 1;
        }
        let pixels = pixels_more(settings, halvings);
        let [more_seconds, more_bytes] = growth.map(|growth| pixels.powf(growth));
        let doubt_of = |more: f64| 0.5 * (more / pixels).ln().abs();
        let coherence = COHERENCE * f64::from(halvings);
        let (more_seconds, doubt_of_seconds) = match settings.is_adaptive() {
            true => {
                let between = (pixels * more_seconds).sqrt();
                (between, doubt_of(more_seconds) + coherence)
            }
            false => (pixels * (1.0 - coherence), coherence),
        };
        for frame in &mut frames {
            frame.seconds *= more_seconds;
            frame.bytes *= more_bytes;
        }
        Pilot {
            frames,
            doubt_of_seconds,
            doubt_of_bytes: doubt_of(more_bytes) + GRAIN * f64::from(halvings),
        }
    }
}

/// Columns and rows of frames with so often halved sides.
fn smaller(settings: &RenderSettings, halvings: u32) -> [u32; 2] {
    [settings.width, settings.height].map(|side| (side >> halvings).max(1))
}

fn most_halvings(settings: &RenderSettings) -> u32 {
    let side = settings.width.min(settings.height);
    (side / MIN_SIDE).checked_ilog2().unwrap_or(0)
}

/// How many times as many pixels the full size has.
fn pixels_more(settings: &RenderSettings, halvings: u32) -> f64 {
    let pixels = |[width, height]: [u32; 2]| f64::from(width) * f64::from(height);
    pixels(smaller(settings, 0)) / pixels(smaller(settings, halvings))
}

impl Workload<'_> {
    /// Renders frames as a sequence. The seconds are divided among them by their rays.
    fn measure(&self, renderer: &Renderer, frames: &[u32]) -> Vec<PilotFrame> {
        let scale = Scale {
            sequence: self.sequence,
            weighed: Mutex::default(),
        };
        let start = Instant::now();
        renderer.render_sequence(self.path, frames, self.pool, &scale, &NoObserver);
        let seconds = start.elapsed().as_secs_f64();
        let mut weighed = scale.weighed.into_inner().expect("no holder panics");
        weighed.sort_unstable_by_key(|(frame, ..)| *frame);
        let rays: u64 = weighed.iter().map(|(_, rays, _)| rays).sum();
        let of = |(frame, of_frame, bytes): (u32, u64, usize)| PilotFrame {
            frame,
            seconds: seconds * of_frame as f64 / rays.max(1) as f64,
            bytes: bytes as f64,
        };
        weighed.into_iter().map(of).collect()
    }
}

/// Weighs frames in place of storing them: number, rays and bytes.
struct Scale<'a> {
    sequence: &'a SequenceRecord,
    weighed: Mutex<Vec<(u32, u64, usize)>>,
}

impl FrameSink for Scale<'_> {
    type Lock = ();

    fn claim(&self, _: u32, _: bool) -> Result<Claim<()>, SinkError> {
        Ok(Claim::Granted(()))
    }

    fn encode(&self, frame: u32, rendered: RenderedFrame) -> Result<EncodedFrame, SinkError> {
        let rays = rendered.rays;
        let encoded = self.sequence.encode(frame, rendered)?;
        let weight = (frame, rays, encoded.bytes());
        self.weighed.lock().expect("no holder panics").push(weight);
        Ok(encoded)
    }

    fn store(&self, _: u32, (): (), _: &EncodedFrame) -> Result<(), SinkError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::IntegratorSettings;

    #[test]
    fn sizes_are_halved_down_to_the_least() {
        let settings = |width, height| {
            RenderSettings::new(IntegratorSettings::Whitted { bounces: 0 }, width, height)
        };
        let full = settings(1280, 720);
        assert_eq!(most_halvings(&full), 3);
        assert_eq!(smaller(&full, 3), [160, 90]);
        assert_eq!(pixels_more(&full, 3), 64.0);
        assert_eq!(most_halvings(&settings(20, 30)), 0);
    }
}
