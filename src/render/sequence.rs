//! Sequences: renders the frames of a camera path and hands them to a sink.

use super::error_estimate::FrameErrorEstimate;
use super::observer::RenderObserver;
use super::renderer::Renderer;
use super::sink::{Claim, EncodedFrame, FrameSink};
use super::sink_error::SinkError;
use crate::camera::CameraPath;
use std::any::Any;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::thread;

/// Frames that are rendered at once. While one frame's last tiles are finished and its file is written, the
/// next frame's tiles keep the other threads busy; more would only cost memory.
pub const FRAMES_IN_FLIGHT: usize = 2;

/// The result of rendering a sequence.
#[derive(Debug, Default)]
pub struct Outcome {
    /// How many frames were rendered and stored.
    pub stored: u32,
    /// How many frames other processes stored in the meantime.
    pub stored_by_others: u32,
    /// The frames that were not stored, and why, by frame number.
    pub failures: Vec<(u32, SinkError)>,
    /// Whether the observer stopped the sequence before its end; frames in flight were given up.
    pub stopped: bool,
    /// Rays traced in all frames that were stored.
    pub rays: u64,
    /// Bytes of their files.
    pub bytes: u64,
    /// Samples that were replaced by black because they were not finite.
    pub non_finite_samples: u64,
    /// The errors of the frames that were stored, by frame number.
    pub errors: Vec<(u32, FrameErrorEstimate)>,
}

impl Renderer<'_> {
    /// Renders the numbered frames of a camera path, in the order given, each on all threads of the pool, and hands
    /// them to `sink`. A frame that fails, be it by a panic, does not stop the others. Frames that other processes
    /// are rendering come last, and are rendered then if they are still missing: no process is waited for.
    pub fn render_sequence<Sink: FrameSink>(
        &self,
        path: &CameraPath,
        frames: &[u32],
        pool: &rayon::ThreadPool,
        sink: &Sink,
        observer: &dyn RenderObserver,
    ) -> Outcome {
        let context = RenderContext {
            renderer: self,
            path,
            pool,
            sink,
            observer,
            queue: Mutex::new(frames.iter().map(|&frame| (frame, false)).collect()),
            outcome: Mutex::default(),
        };
        // The drivers wait outside the pool, so that no pool thread can be caught running one frame
        // inside another and hold it back.
        thread::scope(|scope| {
            for _ in 1..FRAMES_IN_FLIGHT {
                // Without it there are only fewer frames in flight.
                let _ = thread::Builder::new().spawn_scoped(scope, || context.drive());
            }
            context.drive();
        });
        let mut outcome = context.outcome.into_inner().expect("no holder panics");
        outcome.failures.sort_by_key(|(frame, _)| *frame);
        outcome.errors.sort_by_key(|(frame, _)| *frame);
        outcome
    }
}

/// A sequence that is being rendered.
struct RenderContext<'a, Sink> {
    renderer: &'a Renderer<'a>,
    path: &'a CameraPath,
    pool: &'a rayon::ThreadPool,
    sink: &'a Sink,
    observer: &'a dyn RenderObserver,
    /// Frames to render, and whether to ignore the lock of another process.
    queue: Mutex<VecDeque<(u32, bool)>>,
    outcome: Mutex<Outcome>,
}

/// What became of a frame.
enum FrameOutcome {
    Stored(FrameStats),
    StoredByOthers,
    Busy,
    Stopped,
}

/// What a stored frame adds to the outcome.
struct FrameStats {
    rays: u64,
    bytes: u64,
    non_finite_samples: u64,
    error: FrameErrorEstimate,
}

impl<Sink: FrameSink> RenderContext<'_, Sink> {
    /// Renders frames from the queue until it is empty.
    fn drive(&self) {
        while let Some((frame, ignore_lock)) = self.next() {
            let result = self.render(frame, ignore_lock);
            match &result {
                Ok(FrameOutcome::Stored(_)) => self.observer.frame_stored(frame),
                Ok(_) => {}
                Err(error) => self.observer.frame_failed(frame, error),
            }
            let mut outcome = self.outcome.lock().expect("no holder panics");
            match result {
                Ok(FrameOutcome::Stored(stats)) => {
                    outcome.stored += 1;
                    outcome.rays += stats.rays;
                    outcome.bytes += stats.bytes;
                    outcome.non_finite_samples += stats.non_finite_samples;
                    outcome.errors.push((frame, stats.error));
                }
                Ok(FrameOutcome::StoredByOthers) => outcome.stored_by_others += 1,
                Ok(FrameOutcome::Busy) => self.queue().push_back((frame, true)),
                Ok(FrameOutcome::Stopped) => outcome.stopped = true,
                Err(error) => outcome.failures.push((frame, error)),
            }
        }
    }

    fn queue(&self) -> std::sync::MutexGuard<'_, VecDeque<(u32, bool)>> {
        self.queue.lock().expect("no holder panics")
    }

    fn next(&self) -> Option<(u32, bool)> {
        self.queue().pop_front()
    }

    fn render(&self, frame: u32, ignore_lock: bool) -> Result<FrameOutcome, SinkError> {
        if self.observer.is_stopped() {
            return Ok(FrameOutcome::Stopped);
        }
        let claim = self.sink.claim(frame, ignore_lock);
        if matches!(claim, Ok(Claim::AlreadyStored) | Err(_)) {
            self.observer.frame_skipped(frame);
        }
        let lock = match claim? {
            Claim::Granted(lock) => lock,
            Claim::Busy => return Ok(FrameOutcome::Busy),
            Claim::AlreadyStored => return Ok(FrameOutcome::StoredByOthers),
        };
        let work = || self.pool.install(|| self.encoded(frame));
        // A frame's data is dropped with its panic.
        let Some((encoded, mut stats)) = catch_unwind(AssertUnwindSafe(work))
            .map_err(|panic| format!("the renderer panicked: {}", message(&*panic)))?
        else {
            return Ok(FrameOutcome::Stopped);
        };
        let encoded = encoded?;
        stats.bytes = encoded.bytes() as u64;
        self.sink.store(frame, lock, &encoded)?;
        Ok(FrameOutcome::Stored(stats))
    }

    /// A frame as the sink encodes it; none if the observer stops.
    fn encoded(&self, frame: u32) -> Option<(Result<EncodedFrame, SinkError>, FrameStats)> {
        let camera = self.path.camera(frame);
        let rendered = (self.renderer).render_observed(&camera, frame, self.observer)?;
        let stats = FrameStats {
            rays: rendered.rays,
            bytes: 0,
            non_finite_samples: rendered.non_finite_samples,
            error: rendered.error,
        };
        Some((self.sink.encode(frame, rendered), stats))
    }
}

/// The message of a panic.
fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or(panic.downcast_ref::<&str>().copied());
    text.unwrap_or("without a message")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{CameraPathTiming, Interpolation, Keyframe, Orientation, Segment};
    use crate::integrator::IntegratorSettings;
    use crate::render::{RenderSettings, RenderedFrame};
    use crate::scene::SceneBuilder;
    use glam::DVec3;
    use std::sync::atomic::{AtomicBool, Ordering};

    /// Stores the numbers of frames, and fails at some, as other processes and disks do.
    #[derive(Default)]
    struct Sink {
        stored: Mutex<Vec<u32>>,
        claims: Mutex<Vec<(u32, bool)>>,
    }

    const PANICS: u32 = 3;
    const CANNOT_BE_CLAIMED: u32 = 4;
    const CANNOT_BE_STORED: u32 = 5;
    const IS_BUSY: u32 = 1;
    const IS_STORED: u32 = 2;

    impl FrameSink for Sink {
        type Lock = ();

        fn claim(&self, frame: u32, ignore_lock: bool) -> Result<Claim<()>, SinkError> {
            self.claims
                .lock()
                .expect("whole")
                .push((frame, ignore_lock));
            match frame {
                CANNOT_BE_CLAIMED => Err("no room".into()),
                IS_BUSY if !ignore_lock => Ok(Claim::Busy),
                IS_STORED => Ok(Claim::AlreadyStored),
                _ => Ok(Claim::Granted(())),
            }
        }

        fn encode(&self, frame: u32, _: RenderedFrame) -> Result<EncodedFrame, SinkError> {
            assert_ne!(frame, PANICS, "as planned");
            Ok(EncodedFrame {
                image: Vec::new(),
                maps: Vec::new(),
            })
        }

        fn store(&self, frame: u32, (): (), _: &EncodedFrame) -> Result<(), SinkError> {
            if frame == CANNOT_BE_STORED {
                return Err("lost".into());
            }
            self.stored.lock().expect("whole").push(frame);
            Ok(())
        }
    }

    /// Records calls, and stops after a frame.
    #[derive(Default)]
    struct Notes {
        lines: Mutex<Vec<String>>,
        last: Option<u32>,
        stopped: AtomicBool,
    }

    impl Notes {
        fn note(&self, line: String) {
            self.lines.lock().expect("whole").push(line);
        }
    }

    impl RenderObserver for Notes {
        fn is_stopped(&self) -> bool {
            self.stopped.load(Ordering::SeqCst)
        }

        fn frame_stored(&self, frame: u32) {
            self.note(format!("{frame} stored"));
            if self.last == Some(frame) {
                self.stopped.store(true, Ordering::SeqCst);
            }
        }

        fn frame_skipped(&self, frame: u32) {
            self.note(format!("{frame} skipped"));
        }

        fn frame_failed(&self, frame: u32, error: &SinkError) {
            self.note(format!("{frame} failed: {error}"));
        }
    }

    fn render(frames: &[u32], sink: &Sink, notes: &Notes) -> Outcome {
        let (scene, _) = SceneBuilder::default().build();
        let key = |time| Keyframe {
            time,
            position: DVec3::ZERO,
            orientation: Orientation::LookAt {
                target: DVec3::NEG_Z,
                roll: 0.0,
            },
            field_of_view: 1.0,
            segment: Segment::of(Interpolation::Linear),
        };
        let keys = [key(0.0), key(999.0)];
        let path = CameraPath::new(1.0, &keys, &CameraPathTiming::BY_KEYS).expect("a path");
        let settings = RenderSettings::new(IntegratorSettings::Whitted { bounces: 0 }, 4, 4);
        let pool = rayon::ThreadPoolBuilder::new().build().expect("threads");
        let renderer = Renderer::new(&scene, settings, None).expect("needs no cache");
        renderer.render_sequence(&path, frames, &pool, sink, notes)
    }

    #[test]
    fn one_frames_failure_is_not_anothers() {
        let (sink, notes) = (Sink::default(), Notes::default());
        let outcome = render(&[0, 1, 2, 3, 4, 5, 6], &sink, &notes);
        let mut stored = sink.stored.into_inner().expect("whole");
        stored.sort_unstable();
        assert_eq!(stored, [0, 1, 6]);
        assert_eq!((outcome.stored, outcome.stored_by_others), (3, 1));
        assert!(!outcome.stopped);
        let failures: Vec<String> = outcome
            .failures
            .iter()
            .map(|(frame, error)| format!("{frame}: {error}"))
            .collect();
        assert!(
            failures[0].starts_with("3: the renderer panicked: "),
            "{failures:?}"
        );
        assert!(failures[0].contains("as planned"), "{failures:?}");
        assert_eq!(failures[1..], ["4: no room", "5: lost"]);
        let mut lines = notes.lines.into_inner().expect("whole");
        lines.retain(|line| !line.contains("panicked"));
        lines.sort();
        let expected = [
            "0 stored",
            "1 stored",
            "2 skipped",
            "4 failed: no room",
            "4 skipped",
            "5 failed: lost",
            "6 stored",
        ];
        assert_eq!(lines, expected);
    }

    #[test]
    fn frames_others_are_rendering_are_claimed_again_ignoring_the_lock() {
        let (sink, notes) = (Sink::default(), Notes::default());
        render(&[1, 0, 6], &sink, &notes);
        let claims = sink.claims.into_inner().expect("whole");
        assert_eq!(claims.len(), 4);
        let of_1 = claims.iter().filter(|(frame, _)| *frame == 1);
        assert_eq!(of_1.collect::<Vec<_>>(), [&(1, false), &(1, true)]);
    }

    #[test]
    fn no_frame_is_begun_after_an_end_is_asked_for() {
        let sink = Sink::default();
        let notes = Notes {
            last: Some(0),
            ..Notes::default()
        };
        let frames: Vec<u32> = [0].into_iter().chain(6..400).collect();
        let outcome = render(&frames, &sink, &notes);
        assert!(outcome.stopped);
        assert!(outcome.stored < 394, "{}", outcome.stored);
        assert_eq!(
            outcome.stored as usize,
            sink.stored.into_inner().expect("whole").len()
        );
    }
}
