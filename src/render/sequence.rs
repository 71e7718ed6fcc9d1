use super::frame::{RenderedFrame, render_frame};
use super::noise::ErrorEstimate;
use super::settings::RenderSettings;
use crate::camera::CameraPath;
use crate::scene::Scene;
use std::sync::Mutex;
use std::thread;

/// Films alive at once. While one frame's last tiles are finished and its file is written, the
/// next frame's tiles keep the other threads busy; more would only cost memory.
const FRAMES_IN_FLIGHT: usize = 2;

/// Why a frame could not be kept.
pub type SinkError = Box<dyn std::error::Error + Send + Sync>;

/// Takes finished frames, from several threads and in no fixed order.
pub trait FrameSink: Sync {
    /// What to keep of a frame. Is called on a thread of the pool: it may compute, not wait.
    fn encode(&self, frame: u32, rendered: RenderedFrame) -> Result<EncodedFrame, SinkError>;
    /// Keeps a frame for good, or says why it could not. May wait for a disk.
    fn keep(&self, frame: u32, encoded: &EncodedFrame) -> Result<(), SinkError>;
}

/// The bytes to keep of a frame.
#[derive(Debug)]
pub struct EncodedFrame {
    /// The picture.
    pub picture: Vec<u8>,
    /// The map of its error, if one is wanted.
    pub error_map: Option<Vec<u8>>,
}

/// Is told how the work goes on, from several threads.
pub trait Observer: Sync {
    /// A tile is finished; it took `rays` rays.
    fn tile_done(&self, rays: u64);
    /// A frame is finished and kept, or failed.
    fn frame_done(&self, frame: u32, failure: Option<&SinkError>);
}

/// How a sequence went.
#[derive(Debug, Default)]
pub struct Outcome {
    /// The frames that were not kept and why, by number.
    pub failures: Vec<(u32, SinkError)>,
    /// Rays traced in all frames.
    pub rays: u64,
    /// Samples that were replaced by black because they were not finite.
    pub non_finite_samples: u64,
    /// The errors of the frames that were kept and that chance had a part in, by number.
    pub errors: Vec<(u32, ErrorEstimate)>,
}

/// Renders the numbered frames of a camera path, in the order given, each on all threads of the
/// pool, and hands them to `sink`. A frame that fails does not stop the others.
pub fn render_sequence(
    scene: &Scene,
    path: &CameraPath,
    settings: &RenderSettings,
    frames: &[u32],
    pool: &rayon::ThreadPool,
    sink: &dyn FrameSink,
    observer: &dyn Observer,
) -> Outcome {
    let queue = Mutex::new(frames.iter().copied());
    let outcome = Mutex::new(Outcome::default());
    let next = || queue.lock().expect("no holder panics").next();
    let drive = || {
        while let Some(frame) = next() {
            let camera = path.camera(frame);
            let tile_done = |rays| observer.tile_done(rays);
            let (encoded, counted) = pool.install(|| {
                let rendered = render_frame(scene, &camera, settings, frame, &tile_done);
                let error = rendered.error;
                let counted = (rendered.rays, rendered.non_finite_samples, error);
                (sink.encode(frame, rendered), counted)
            });
            let kept = encoded.and_then(|encoded| sink.keep(frame, &encoded));
            observer.frame_done(frame, kept.as_ref().err());
            let (rays, non_finite_samples, error) = counted;
            let mut outcome = outcome.lock().expect("no holder panics");
            outcome.rays += rays;
            outcome.non_finite_samples += non_finite_samples;
            match kept {
                Ok(()) => outcome.errors.extend(error.map(|error| (frame, error))),
                Err(error) => outcome.failures.push((frame, error)),
            }
        }
    };
    // The drivers wait outside the pool, so that no pool thread can be caught running one frame
    // inside another and hold it back.
    thread::scope(|scope| {
        for _ in 0..FRAMES_IN_FLIGHT {
            scope.spawn(drive);
        }
    });
    let mut outcome = outcome.into_inner().expect("no holder panics");
    outcome.failures.sort_by_key(|(frame, _)| *frame);
    outcome.errors.sort_by_key(|(frame, _)| *frame);
    outcome
}
