//! Signals that ask for an end: SIGTERM, SIGINT (Ctrl-C), SIGHUP and SIGUSR1, by which Slurm warns of a time limit.

use super::outcome::{Status, complain};
use crate::storage::remove_unfinished;
use rustix::process::Signal;
use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGTERM, SIGUSR1};
use signal_hook::flag;
use signal_hook::iterator::Signals;
use std::fs;
use std::io;
use std::process::exit;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// How long the rendering of frames may take to stop: a tile may take minutes.
const UNTIL_STOPPED: Duration = Duration::from_millis(600);

/// How long the listing of the frames may take after that; it can be done again.
const UNTIL_LISTED: Duration = Duration::from_millis(300);

/// What signals do.
///
/// While there is nothing to list they end the program at once. While frames are rendered the first only asks for an
/// end, for which it waits, but not for long. No unfinished file is left.
#[derive(Clone)]
pub(super) struct Interrupt {
    stage: Arc<AtomicU8>,
}

/// Nothing is to be listed.
const AT_ONCE: u8 = 0;
/// Frames are rendered: they are given up if an end is asked for.
const RENDERING: u8 = 1;
/// An end is asked for.
const ASKED: u8 = 2;
/// No frame is rendered any more.
const STOPPED: u8 = 3;

impl Interrupt {
    pub(super) fn install() -> io::Result<Interrupt> {
        // A file beyond a limit of its size is an error of the write.
        flag::register(Signal::XFSZ.as_raw(), Arc::default())?;
        // The system's memory is exhausted: what a thread was at is lost, but trying again may help.
        let always = Arc::new(AtomicBool::new(true));
        flag::register_conditional_shutdown(SIGABRT, Status::SomeFailed as i32, always)?;
        // Under nohup it is ignored.
        // Under nohup it is ignored.
        let hangup = (!is_ignored(SIGHUP)).then_some(SIGHUP);
        let mut signals = Signals::new([SIGINT, SIGTERM, SIGUSR1].into_iter().chain(hangup))?;
        let stage = Arc::new(AtomicU8::new(AT_ONCE));
        let interrupt = Interrupt {
            stage: stage.clone(),
        };
        thread::Builder::new()
            .name("signals".to_owned())
            .spawn(move || {
                signals.wait().next();
                let asked =
                    stage.compare_exchange(RENDERING, ASKED, Ordering::SeqCst, Ordering::SeqCst);
                if asked.is_ok() {
                    wait_for_the_end(&stage, &mut signals);
                }
                remove_unfinished();
                // The reader of the message may hang.
                let _ = thread::Builder::new().spawn(|| {
                    thread::sleep(Duration::from_millis(100));
                    exit(Status::Interrupted as i32);
                });
                complain("interrupted: the same command continues");
                exit(Status::Interrupted as i32);
            })?;
        Ok(interrupt)
    }

    /// From now on a signal only asks for an end, at first.
    pub(super) fn wait_to_be_asked(&self) {
        self.stage.store(RENDERING, Ordering::SeqCst);
    }

    /// Whether an end was asked for since.
    pub(super) fn is_asked(&self) -> bool {
        self.stage.load(Ordering::SeqCst) == ASKED
    }

    /// No frame is rendered any more: those that are there are listed.
    pub(super) fn rendering_is_over(&self) {
        self.stage.store(STOPPED, Ordering::SeqCst);
    }

    /// Nothing is left to list: from now on a signal ends the program at once.
    pub(super) fn nothing_is_left(&self) {
        self.stage.store(AT_ONCE, Ordering::SeqCst);
    }
}

/// Returns if the program takes too long to end, or at the next signal.
fn wait_for_the_end(stage: &AtomicU8, signals: &mut Signals) {
    let mut start = Instant::now();
    let mut until = UNTIL_STOPPED;
    let mut is_stopped = false;
    let goes_on = || stage.load(Ordering::SeqCst) != AT_ONCE;
    while goes_on() && start.elapsed() < until && signals.pending().next().is_none() {
        if !is_stopped && stage.load(Ordering::SeqCst) == STOPPED {
            (is_stopped, start, until) = (true, Instant::now(), UNTIL_LISTED);
        }
        thread::sleep(Duration::from_millis(10));
    }
}

/// Whether whoever started the program lets it ignore a signal; false where the system does not say.
fn is_ignored(signal: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
