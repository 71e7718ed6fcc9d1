//! Where finished frames go: claimed, encoded, stored.

use super::frame::RenderedFrame;
use super::sink_error::SinkError;

/// Takes finished frames, from several threads and in no fixed order.
pub trait FrameSink: Sync {
    /// The exclusive right to store a frame, released when dropped.
    type Lock: Send;

    /// Claims a frame right before it is rendered: other processes may render the same sequence. With `ignore_lock`
    /// the frame is granted even if another process is rendering it.
    fn claim(&self, frame: u32, ignore_lock: bool) -> Result<Claim<Self::Lock>, SinkError>;

    /// Encodes a frame. Called on a thread of the pool: it may compute, not block.
    fn encode(&self, frame: u32, rendered: RenderedFrame) -> Result<EncodedFrame, SinkError>;

    /// Stores a frame. May block.
    fn store(&self, frame: u32, lock: Self::Lock, encoded: &EncodedFrame) -> Result<(), SinkError>;
}

/// The answer to a claim.
#[derive(Debug)]
pub enum Claim<Lock> {
    /// The frame is to be rendered.
    Granted(Lock),
    /// Another process is rendering it.
    Busy,
    /// Another process has stored it.
    AlreadyStored,
}

/// The files of a frame.
#[derive(Debug)]
pub struct EncodedFrame {
    /// The image.
    pub image: Vec<u8>,
    /// The maps beside it, in the order of the sequence's.
    pub maps: Vec<Vec<u8>>,
}

impl EncodedFrame {
    /// Bytes of all files.
    pub fn bytes(&self) -> usize {
        self.image.len() + self.maps.iter().map(Vec::len).sum::<usize>()
    }
}
