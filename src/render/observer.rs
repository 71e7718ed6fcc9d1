//! Observers of frames and sequences that are being rendered: progress and cancellation.

use super::sink_error::SinkError;

/// Follows the rendering of frames, from several threads, and may stop it. Each method is optional.
pub trait RenderObserver: Sync {
    /// Whether to stop: frames that are not finished are given up.
    fn is_stopped(&self) -> bool {
        false
    }
    /// A tile is finished; `rays` rays were traced.
    fn tile_done(&self, rays: u64) {
        let _ = rays;
    }
    /// A frame is rendered and stored.
    fn frame_stored(&self, frame: u32) {
        let _ = frame;
    }
    /// A frame is not rendered: another process has rendered it, or it could not be claimed.
    fn frame_skipped(&self, frame: u32) {
        let _ = frame;
    }
    /// A frame could not be claimed, rendered or stored.
    fn frame_failed(&self, frame: u32, error: &SinkError) {
        let _ = (frame, error);
    }
}

/// Ignores everything and never stops.
#[derive(Clone, Copy, Debug)]
pub struct NoObserver;

impl RenderObserver for NoObserver {}
