//! Observers of frames and sequences that are being rendered: progress and cancellation.

use super::sink_error::SinkError;

/// Follows the rendering of frames, from several threads, and may stop it. Each method is optional.
pub trait RenderObserver: Sync {
    /// Whether to stop: frames that are not finished are given up.
    fn is_stopped(&self) -> bool {
        false
    }
    /// A tile is finished: the number of rays that were traced for it.
    fn tile_done(&self, _rays: u64) {}
    /// A frame is rendered and stored.
    fn frame_stored(&self, _frame: u32) {}
    /// A frame is not rendered: another process has rendered it, or it could not be claimed.
    fn frame_skipped(&self, _frame: u32) {}
    /// A frame could not be claimed, rendered or stored.
    fn frame_failed(&self, _frame: u32, _error: &SinkError) {}
}

/// Ignores everything and never stops.
#[derive(Clone, Copy, Debug)]
pub struct NoObserver;

impl RenderObserver for NoObserver {}
