use rustix::time::{ClockId, clock_gettime};
use std::time::Instant;

/// What something took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seconds {
    /// By the clock.
    pub(super) wall: f64,
    /// Of all processors together.
    pub(super) cpu: f64,
}

impl Seconds {
    /// Does something; gives what it made, too.
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

/// Seconds that the processors have worked for this program.
fn cpu_seconds() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
