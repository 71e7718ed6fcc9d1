//! Progress of sequences and of other long work: a bar, lines, or what Open Job Description reads.

use super::interrupt::Interrupt;
use super::outcome::tell;
use super::values::ProgressArgument;
use crate::render::{RenderObserver, RenderSettings, SinkError, tile_count};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    /// A bar.
    Bar,
    /// A line a minute, for log files.
    Lines,
    /// The lines of Open Job Description, on stdout.
    OpenJobDescription,
    /// Nothing but failures.
    Nothing,
}

impl ProgressArgument {
    pub(super) fn shown(self, quiet: bool) -> Shown {
        match self {
            _ if quiet => Shown::Nothing,
            ProgressArgument::Openjd => Shown::OpenJobDescription,
            ProgressArgument::Auto if std::io::stderr().is_terminal() => Shown::Bar,
            ProgressArgument::Auto => Shown::Lines,
        }
    }
}

/// Progress of a sequence: frames, rays per second, ETA.
///
/// It counts only frames that are rendered by this process.
pub(super) struct SequenceProgress {
    bar: ProgressBar,
    shown: Shown,
    steps_per_frame: u64,
    steps_are_frames: bool,
    /// Frames that this process renders.
    frames: AtomicU64,
    frames_stored: AtomicU64,
    rays: AtomicU64,
    lines: Lines,
    interrupt: Interrupt,
}

impl SequenceProgress {
    /// The first signal from now on only asks for an end.
    pub(super) fn new(
        frames: usize,
        settings: &RenderSettings,
        shown: Shown,
        interrupt: Interrupt,
    ) -> SequenceProgress {
        interrupt.wait_to_be_asked();
        let frames = frames as u64;
        // How many samples an adaptive frame will need is not known: it counts as a whole.
        let steps_are_frames = settings.is_adaptive();
        let steps_per_frame = match steps_are_frames {
            true => 1,
            false => tile_count(settings),
        };
        SequenceProgress {
            bar: bar(frames * steps_per_frame, shown != Shown::Bar),
            shown,
            steps_per_frame,
            steps_are_frames,
            frames: AtomicU64::new(frames),
            frames_stored: AtomicU64::new(0),
            rays: AtomicU64::new(0),
            lines: Lines::new(),
            interrupt,
        }
    }

    /// Removes the bar, or says how it ended.
    pub(super) fn finish(&self) {
        if self.shown == Shown::OpenJobDescription {
            self.tell_openjd();
        }
        self.bar.finish_and_clear();
    }

    fn update(&self) {
        match self.shown {
            Shown::Bar => self.bar.set_message(self.state()),
            Shown::Lines if self.lines.is_time(60_000, 60_000) => tell(self.state()),
            Shown::OpenJobDescription if self.lines.is_time(1_000, 1_000) => self.tell_openjd(),
            _ => {}
        }
    }

    /// The fraction that is done.
    fn done(&self) -> f64 {
        match self.bar.length() {
            None | Some(0) => 1.0,
            Some(length) => self.bar.position() as f64 / length as f64,
        }
    }

    fn state(&self) -> String {
        let elapsed = self.lines.start.elapsed();
        format!(
            "frame {}/{}  {}  ETA {}",
            self.frames_stored.load(Ordering::Relaxed),
            self.frames.load(Ordering::Relaxed),
            rays_per_second(self.rays.load(Ordering::Relaxed), elapsed),
            remaining(elapsed, self.done()).map_or("?".to_owned(), clock),
        )
    }

    fn tell_openjd(&self) {
        // A reader that has gone is no failure of the rendering.
        let _ = writeln!(
            std::io::stdout(),
            "openjd_progress: {:.1}\nopenjd_status: {}",
            100.0 * self.done(),
            self.state()
        );
    }
}

impl RenderObserver for SequenceProgress {
    fn tile_done(&self, rays: u64) {
        self.rays.fetch_add(rays, Ordering::Relaxed);
        if !self.steps_are_frames {
            self.bar.inc(1);
        }
        self.update();
    }

    fn is_stopped(&self) -> bool {
        self.interrupt.is_asked()
    }

    fn frame_stored(&self, _: u32) {
        self.frames_stored.fetch_add(1, Ordering::Relaxed);
        if self.steps_are_frames {
            self.bar.inc(1);
        }
        self.update();
    }

    fn frame_skipped(&self, _: u32) {
        // It does not count: the ETA is of frames that are rendered.
        self.frames.fetch_sub(1, Ordering::Relaxed);
        self.bar.dec_length(self.steps_per_frame);
        self.update();
    }

    fn frame_failed(&self, frame: u32, error: &SinkError) {
        self.bar
            .suspend(|| tell(format_args!("frame {frame} failed: {error}")));
    }
}

/// A bar for work whose fraction done is known: the current step, ETA.
pub(super) struct FractionProgress {
    bar: ProgressBar,
    /// Whether there are lines in place of a bar.
    has_lines: bool,
    lines: Lines,
}

impl FractionProgress {
    /// Steps of the bar.
    const STEPS: u64 = 1000;

    pub(super) fn new(quiet: bool) -> FractionProgress {
        FractionProgress {
            bar: bar(Self::STEPS, quiet),
            has_lines: !quiet && !std::io::stderr().is_terminal(),
            lines: Lines::new(),
        }
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// The fraction `done` is done; `what` is the current step.
    pub(super) fn at(&self, done: f64, what: &str) {
        let left = remaining(self.lines.start.elapsed(), done).map_or("?".to_owned(), clock);
        if self.has_lines && self.lines.is_time(2_000, 60_000) {
            tell(format_args!("{what}: {:.0} %  ETA {left}", 100.0 * done));
        }
        self.bar.set_position((done * Self::STEPS as f64) as u64);
        self.bar.set_message(format!("{what}  ETA {left}"));
    }
}

/// When it is time for a line of progress.
struct Lines {
    start: Instant,
    /// Time of the last line, in milliseconds from the start; 0 before the first.
    last: AtomicU64,
}

impl Lines {
    fn new() -> Lines {
        Lines {
            start: Instant::now(),
            last: AtomicU64::new(0),
        }
    }

    /// Whether `first` milliseconds have passed since the start, or `pause` since this was last true; it is for one
    /// thread only.
    fn is_time(&self, first: u64, pause: u64) -> bool {
        let now = self.start.elapsed().as_millis() as u64;
        let last = self.last.load(Ordering::Relaxed);
        let wait = if last == 0 { first } else { pause };
        let swap = || {
            self.last
                .compare_exchange(last, now, Ordering::Relaxed, Ordering::Relaxed)
        };
        now - last.min(now) >= wait && swap().is_ok()
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

/// The time that is left at the average speed so far.
fn remaining(elapsed: Duration, done: f64) -> Option<Duration> {
    // The sum of parts may round to more than the whole.
    (done > 0.0).then(|| elapsed.mul_f64((1.0 - done).max(0.0) / done))
}

/// Rays per second.
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
        assert_eq!(remaining(minute, 1.000_001), Some(Duration::ZERO));
        assert_eq!(remaining(minute, 0.0), None);
    }

    #[test]
    fn clocks() {
        assert_eq!(clock(Duration::from_secs_f64(59.6)), "0:01:00");
        assert_eq!(clock(Duration::from_secs(3600 * 26 + 61)), "26:01:01");
    }
}
