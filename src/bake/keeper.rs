//! What keeps a bake while it goes on.

use super::bake_state::BakeState;
use std::convert::Infallible;

/// Keeps what is baked, so that what is interrupted goes on where it was. Its errors end the bake.
pub trait BakeKeeper {
    /// Why it cannot be kept.
    type Error;

    /// Hears of the bytes that the state will take in a file, before any light is gathered.
    fn reserve(&mut self, bytes: u64) -> Result<(), Self::Error>;

    /// Hears of the state again and again while light is gathered. A bake that is given such a state gathers the rest, and
    /// comes to the same.
    fn checkpoint(&mut self, state: &BakeState) -> Result<(), Self::Error>;
}

/// Keeps nothing.
#[derive(Clone, Copy, Debug)]
pub struct NoKeeper;

impl BakeKeeper for NoKeeper {
    type Error = Infallible;

    fn reserve(&mut self, _: u64) -> Result<(), Infallible> {
        Ok(())
    }

    fn checkpoint(&mut self, _: &BakeState) -> Result<(), Infallible> {
        Ok(())
    }
}
