/// Follows the work on a frame, from several threads, and may stop it.
pub trait Watch: Sync {
    /// A tile is finished; it took `rays` rays.
    fn tile_done(&self, rays: u64);
    /// Whether the frame is to be given up.
    fn is_stopped(&self) -> bool;
}

/// Nobody watches: nothing is heard and nothing stopped.
#[derive(Clone, Copy, Debug)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn tile_done(&self, _: u64) {}

    fn is_stopped(&self) -> bool {
        false
    }
}
