//! Wall-clock and CPU time of work.

use rustix::time::{ClockId, clock_gettime};
use std::time::Instant;

/// The time that work took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seconds {
    /// Wall-clock seconds.
    pub(super) wall: f64,
    /// CPU seconds, of all threads together.
    pub(super) cpu: f64,
}

impl Seconds {
    /// Does some work; gives its result, too.
    pub(super) fn of<T>(work: impl FnOnce() -> T) -> (T, Seconds) {
        let (start, cpu_start) = (Instant::now(), cpu_seconds());
        let made = work();
        let seconds = Seconds {
            wall: start.elapsed().as_secs_f64(),
            cpu: cpu_seconds() - cpu_start,
        };
        (made, seconds)
    }
}

/// CPU seconds of this process so far.
fn cpu_seconds() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
