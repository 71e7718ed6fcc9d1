use crate::render::{Observer, SinkError};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// What the bar counts.
#[derive(Clone, Copy, Debug)]
pub(super) enum Steps {
    /// So many in each frame.
    Tiles(u64),
    /// Frames that are finished.
    Frames,
}

/// One bar for the whole sequence: frames, rays per second, time left.
///
/// Where it moves with every tile, the forecast needs no whole frame. It counts only frames that are
/// rendered now. Where there is no terminal, only failures are shown.
pub(super) struct SequenceProgress {
    bar: ProgressBar,
    steps: Steps,
    frames: u64,
    frames_done: AtomicU64,
    rays: AtomicU64,
    start: Instant,
}

impl SequenceProgress {
    pub(super) fn new(frames: u64, steps: Steps, quiet: bool) -> SequenceProgress {
        let steps_per_frame = match steps {
            Steps::Tiles(count) => count,
            Steps::Frames => 1,
        };
        SequenceProgress {
            bar: bar(frames * steps_per_frame, quiet),
            steps,
            frames,
            frames_done: AtomicU64::new(0),
            rays: AtomicU64::new(0),
            start: Instant::now(),
        }
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn update(&self) {
        if self.bar.is_hidden() {
            return;
        }
        let elapsed = self.start.elapsed();
        let done = self.bar.position() as f64 / self.bar.length().unwrap_or(1).max(1) as f64;
        let rays = self.rays.load(Ordering::Relaxed);
        self.bar.set_message(format!(
            "frame {}/{}  {}  ETA {}",
            self.frames_done.load(Ordering::Relaxed),
            self.frames,
            rays_per_second(rays, elapsed),
            remaining(elapsed, done).map_or("?".to_owned(), clock),
        ));
    }
}

impl Observer for SequenceProgress {
    fn tile_done(&self, rays: u64) {
        self.rays.fetch_add(rays, Ordering::Relaxed);
        if matches!(self.steps, Steps::Tiles(_)) {
            self.bar.inc(1);
        }
        self.update();
    }

    fn frame_done(&self, frame: u32, failure: Option<&SinkError>) {
        self.frames_done.fetch_add(1, Ordering::Relaxed);
        if matches!(self.steps, Steps::Frames) {
            self.bar.inc(1);
        }
        if let Some(error) = failure {
            self.bar
                .suspend(|| eprintln!("frame {frame} failed: {error}"));
        }
        self.update();
    }
}

/// One bar for work of which shares are known: what is done now, time left.
pub(super) struct ShareProgress {
    bar: ProgressBar,
    start: Instant,
}

impl ShareProgress {
    /// Steps of the bar.
    const STEPS: u64 = 1000;

    pub(super) fn new(quiet: bool) -> ShareProgress {
        ShareProgress {
            bar: bar(Self::STEPS, quiet),
            start: Instant::now(),
        }
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// The share `done`, of 1, is done.
    pub(super) fn at(&self, done: f64, what: &str) {
        let left = remaining(self.start.elapsed(), done).map_or("?".to_owned(), clock);
        self.bar.set_position((done * Self::STEPS as f64) as u64);
        self.bar.set_message(format!("{what}  ETA {left}"));
    }
}

fn bar(steps: u64, quiet: bool) -> ProgressBar {
    let target = if quiet {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let bar = ProgressBar::with_draw_target(Some(steps), target);
    let style = ProgressStyle::with_template("{bar:30} {msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

/// The time that the rest will take at the pace so far.
fn remaining(elapsed: Duration, done: f64) -> Option<Duration> {
    (done > 0.0).then(|| elapsed.mul_f64((1.0 - done) / done))
}

/// Rays per second, for people.
pub(super) fn rays_per_second(rays: u64, elapsed: Duration) -> String {
    let rate = rays as f64 / elapsed.as_secs_f64().max(1e-9);
    format!("{:.2} Mray/s", rate / 1e6)
}

/// A duration as h:mm:ss.
pub(super) fn clock(duration: Duration) -> String {
    let seconds = duration.as_secs_f64().round() as u64;
    format!(
        "{}:{:02}:{:02}",
        seconds / 3600,
        seconds / 60 % 60,
        seconds % 60
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_takes_as_long_as_the_pace_says() {
        let minute = Duration::from_secs(60);
        assert_eq!(remaining(minute, 0.25), Some(Duration::from_secs(180)));
        assert_eq!(remaining(minute, 1.0), Some(Duration::ZERO));
        assert_eq!(remaining(minute, 0.0), None);
    }

    #[test]
    fn clocks() {
        assert_eq!(clock(Duration::from_secs_f64(59.6)), "0:01:00");
        assert_eq!(clock(Duration::from_secs(3600 * 26 + 61)), "26:01:01");
    }
}
