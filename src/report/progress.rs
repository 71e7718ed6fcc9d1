//! The progress of a report, in paths traced.

use crate::bake::Listener;

/// The progress of a report.
pub(super) struct Progress<'a> {
    /// Paths traced so far, and in all.
    done: f64,
    all: f64,
    what: &'static str,
    listener: Listener<'a>,
}

impl Progress<'_> {
    /// Of a report that traces `all` paths.
    pub(super) fn new(all: f64, listener: Listener<'_>) -> Progress<'_> {
        Progress {
            done: 0.0,
            all,
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
    pub(super) fn part<T>(&mut self, paths: f64, work: impl FnOnce(Listener) -> T) -> T {
        let made = work(&|progress, what| self.tell(self.done + progress * paths, what));
        self.done += paths;
        made
    }

    fn tell(&self, done: f64, what: &'static str) {
        (self.listener)((done / self.all).min(1.0), what);
    }
}
