//! SIGTERM and Ctrl-C.

use super::outcome::Status;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What SIGTERM and Ctrl-C do.
///
/// While there is nothing to lose they end the program at once. While frames are rendered the first only asks for
/// an end, and the second ends the program at once.
#[derive(Clone)]
pub(super) struct Interrupt {
    /// Whether the next signal ends the program.
    at_once: Arc<AtomicBool>,
}

impl Interrupt {
    pub(super) fn install() -> io::Result<Interrupt> {
        let at_once = Arc::new(AtomicBool::new(true));
        for signal in [SIGINT, SIGTERM] {
            // They act in this order: the one that asks does not end at once.
            flag::register_conditional_shutdown(
                signal,
                Status::Interrupted as i32,
                at_once.clone(),
            )?;
            flag::register(signal, at_once.clone())?;
        }
        Ok(Interrupt { at_once })
    }

    /// From now on the first signal only asks for an end.
    pub(super) fn wait_to_be_asked(&self) {
        self.at_once.store(false, Ordering::SeqCst);
    }

    /// Whether an end was asked for since.
    pub(super) fn is_asked(&self) -> bool {
        self.at_once.load(Ordering::SeqCst)
    }
}
