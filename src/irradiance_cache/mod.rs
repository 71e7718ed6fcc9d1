//! Indirect light of a scene that stands still: worked out once, read by every frame.
//!
//! Light is known at places: small discs of surfaces. It is the mean radiance that arrives from the
//! hemisphere, weighted by the cosine: what a Lambert surface multiplies by its reflectance. It does not
//! depend on the eye, but on how many bounces are still counted, so there is light for each number of
//! bounces that is left (Ward et al. 1988, "A Ray Tracing Solution for Diffuse Interreflection"; the
//! numbers apart, for paths of a fixed length would otherwise come out too dark or too bright).
//!
//! Knows nothing of how light is gathered.

mod kernel;
mod lookup;
mod octree;
mod primary;
mod record;
mod records;
mod secondary;

pub use octree::{Leaf, Octree};
pub use primary::{LinearIrradiance, PrimaryIrradiance};
pub use record::{IrradianceRecord, OccluderPlanes};
pub use records::IrradianceRecords;
pub use secondary::SecondaryIrradiance;

/// The indirect light of a scene, as far as a camera path needs it.
#[derive(Debug)]
pub struct IrradianceCache {
    /// What the camera sees, itself and in mirrors; by the number of bounces that are left there, less 1.
    /// As long as there are bounces.
    pub visible: Vec<PrimaryIrradiance>,
    /// What rays see that are gathered where the light is not known.
    pub secondary: SecondaryIrradiance,
}

impl IrradianceCache {
    /// How many bounces are counted.
    pub fn bounces(&self) -> u32 {
        self.visible.len() as u32
    }

    /// How many places there are, seen and secondary.
    pub fn place_count(&self) -> [usize; 2] {
        let visible = self.visible.iter().map(|light| light.places.len());
        [visible.sum(), self.secondary.places.len()]
    }

    /// Bytes.
    pub fn memory(&self) -> usize {
        let visible = self.visible.iter().map(PrimaryIrradiance::memory);
        visible.sum::<usize>() + self.secondary.memory()
    }
}
