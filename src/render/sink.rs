//! Where finished frames go: claimed, encoded, kept.

use super::frame::RenderedFrame;
use super::sink_error::SinkError;

/// Takes finished frames, from several threads and in no fixed order.
pub trait FrameSink: Sync {
    /// The exclusive right to keep a frame, released when dropped.
    type Slot: Send;

    /// Claims a frame right before it is rendered: other processes may render the same sequence. With `insists` the
    /// frame is granted even if another process is rendering it.
    fn claim(&self, frame: u32, insists: bool) -> Result<Claim<Self::Slot>, SinkError>;

    /// Encodes a frame. Called on a thread of the pool: it may compute, not block.
    fn encode(&self, frame: u32, rendered: RenderedFrame) -> Result<EncodedFrame, SinkError>;

    /// Keeps a frame. May block.
    fn keep(&self, frame: u32, slot: Self::Slot, encoded: &EncodedFrame) -> Result<(), SinkError>;
}

/// The answer to a claim.
#[derive(Debug)]
pub enum Claim<Slot> {
    /// The frame is to be rendered.
    Granted(Slot),
    /// Another process is rendering it.
    Busy,
    /// Another process has kept it.
    Kept,
}

/// The files of a frame.
#[derive(Debug)]
pub struct EncodedFrame {
    /// The image.
    pub picture: Vec<u8>,
    /// The map of its error, if requested.
    pub error_map: Option<Vec<u8>>,
}

impl EncodedFrame {
    /// Bytes of all files.
    pub fn bytes(&self) -> usize {
        self.picture.len() + self.error_map.as_ref().map_or(0, Vec::len)
    }
}
