//! Observers of frames and sequences that are being rendered: progress and cancellation.

use super::sink_error::SinkError;

/// Follows the rendering of a frame, from several threads, and may stop it.
pub trait FrameObserver: Sync {
    /// A tile is finished; `rays` rays were traced.
    fn tile_done(&self, rays: u64);
    /// Whether to stop: the frame is then given up.
    fn is_stopped(&self) -> bool;
}

/// Follows the rendering of a sequence, from several threads, and may stop it.
pub trait SequenceObserver: FrameObserver {
    /// A frame is rendered and kept.
    fn frame_kept(&self, frame: u32);
    /// A frame is not rendered: another process has rendered it, or it could not be claimed.
    fn frame_skipped(&self, frame: u32);
    /// A frame could not be claimed, rendered or kept.
    fn frame_failed(&self, frame: u32, error: &SinkError);
}

/// Ignores everything and never stops.
#[derive(Clone, Copy, Debug)]
pub struct NoObserver;

impl FrameObserver for NoObserver {
    fn tile_done(&self, _: u64) {}

    fn is_stopped(&self) -> bool {
        false
    }
}

impl SequenceObserver for NoObserver {
    fn frame_kept(&self, _: u32) {}

    fn frame_skipped(&self, _: u32) {}

    fn frame_failed(&self, _: u32, _: &SinkError) {}
}
