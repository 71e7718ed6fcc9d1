//! Counts what is done of a stage, for its progress.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Calls `report` with the part of `all` that is done, for some of the times that it is called.
pub(super) fn counter(all: usize, report: impl Fn(f64) + Sync) -> impl Fn() + Sync {
    const REPORTS: usize = 256;
    let done = AtomicUsize::new(0);
    let stride = all.div_ceil(REPORTS).max(1);
    move || {
        let before = done.fetch_add(1, Ordering::Relaxed);
        if before.is_multiple_of(stride) {
            report(before as f64 / all as f64);
        }
    }
}
