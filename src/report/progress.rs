//! The progress of a report, in paths traced.

use super::{Inputs, TINY, Technique, baked_cache, bias, flicker, pixels, reference};
use crate::bake;

/// Is called with the progress, from 0 to 1, and what is done.
pub type Listener<'a> = &'a (dyn Fn(f64, &str) + Sync);

/// The progress of a report.
pub(super) struct Progress<'a> {
    /// Paths traced so far, and in all.
    done: f64,
    all: f64,
    what: &'static str,
    listener: Listener<'a>,
}

impl Progress<'_> {
    /// Of a report on so many techniques.
    pub(super) fn new<'a>(
        inputs: &Inputs,
        techniques: &[Technique],
        listener: Listener<'a>,
    ) -> Progress<'a> {
        Progress {
            done: 0.0,
            all: work(inputs, techniques),
            what: "",
            listener,
        }
    }

    /// Begins something else.
    pub(super) fn begin(&mut self, what: &'static str) {
        self.what = what;
        self.step(0.0);
    }

    /// So many paths more are done.
    pub(super) fn step(&mut self, paths: f64) {
        self.done += paths;
        self.tell(self.done, self.what);
    }

    /// So many paths more are done by work that reports its own progress.
    pub(super) fn part<T>(&mut self, paths: f64, work: impl FnOnce(bake::Listener) -> T) -> T {
        let made = work(&|progress, what| self.tell(self.done + progress * paths, what));
        self.done += paths;
        made
    }

    fn tell(&self, done: f64, what: &str) {
        (self.listener)((done / self.all).min(1.0), what);
    }
}

/// About how many paths the whole report traces.
fn work(inputs: &Inputs, techniques: &[Technique]) -> f64 {
    let usual = pixels(inputs.size) * inputs.frames.len() as f64;
    let of_technique = |technique: &Technique| {
        let pixels = if technique.is_tiny {
            pixels(TINY)
        } else {
            usual
        };
        technique.paths() * pixels * f64::from(inputs.seeds)
    };
    techniques.iter().map(of_technique).sum::<f64>()
        + reference::work(inputs, false) * usual
        + reference::work(inputs, true) * pixels(TINY)
        + baked_cache::work(inputs)
        + bias::work(inputs, techniques)
        + flicker::work(inputs.path.timeline().frame_count())
}
