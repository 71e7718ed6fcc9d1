use super::{Inputs, TINY, Technique, bias, flicker, light, pixels, reference};
use crate::bake;

/// Told how far the report is, of 1, and what comes next.
pub type Listener<'a> = &'a (dyn Fn(f64, &str) + Sync);

/// How far the report is.
pub(super) struct Progress<'a> {
    /// In paths.
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

    /// Something else begins.
    pub(super) fn begin(&mut self, what: &'static str) {
        self.what = what;
        self.step(0.0);
    }

    /// So many paths more are done.
    pub(super) fn step(&mut self, paths: f64) {
        self.done += paths;
        self.tell(self.done, self.what);
    }

    /// As many paths more are done by what tells its own share of them.
    pub(super) fn part<T>(&mut self, paths: f64, part: impl FnOnce(bake::Listener) -> T) -> T {
        let made = part(&|share, what| self.tell(self.done + share * paths, what));
        self.done += paths;
        made
    }

    fn tell(&self, done: f64, what: &str) {
        (self.listener)((done / self.all).min(1.0), what);
    }
}

/// About how many paths the whole report takes.
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
        + light::work(inputs)
        + bias::work(inputs, techniques)
        + flicker::work(inputs.path.timeline().frame_count())
}
