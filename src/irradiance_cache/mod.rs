//! The irradiance cache: indirect light of a static scene at records on its surfaces, computed once and
//! interpolated by every frame (Ward, Rubinstein and Clear 1988, "A Ray Tracing Solution for Diffuse
//! Interreflection").
//!
//! What is stored is the mean incident radiance: the mean over the hemisphere, weighted by the cosine, of the radiance
//! that arrives from surfaces. It is the irradiance E divided by π, in W/(sr m²), linear RGB; a Lambert surface of
//! albedo a sends out a times as much. Light that comes straight from lights and emitters is not part of it; that of the
//! sky is part of what secondary records hold, and not of primary ones, where shadow rays bring it. Only diffuse reflection
//! uses it: mirrors are traced. Paths have a fixed maximal length, so the value depends on the bounces left at a point, and
//! each number of bounces left has values of its own.
//!
//! Records stand in cells of space: where, and what they hold, depends on the scene and the seed, not on the frames that
//! need them. Light does not pass through walls: where a record's own surface is not all that is near, what is looked up
//! has to see it.
//!
//! Knows nothing of how the values are computed: see `bake`.

mod cell;
mod cell_irradiance;
mod irradiance_gradient;
mod lookup;
mod octree;
mod primary;
mod record;
mod records;

pub use cell::CellKey;
pub use cell_irradiance::{CellIrradiance, CellRecord, CellSettings};
pub use irradiance_gradient::LinearIrradiance;
pub use primary::PrimaryIrradiance;
pub use record::IrradianceRecord;
pub use records::IrradianceRecords;

use std::sync::Arc;

/// The indirect light of a scene, as far as the frames of a camera path need it.
#[derive(Debug)]
pub struct IrradianceCache {
    /// At surfaces that the camera sees, directly and in mirrors; by the number of bounces left there, less 1.
    /// One entry per bounce.
    pub primary: Vec<PrimaryIrradiance>,
    /// At surfaces that gathered rays hit.
    pub secondary: Arc<CellIrradiance>,
    /// At surfaces that the camera sees where no primary record is valid.
    pub uncovered: Arc<CellIrradiance>,
}

impl IrradianceCache {
    /// How many bounces are counted.
    pub fn bounces(&self) -> u32 {
        self.primary.len() as u32
    }

    /// The caches that each half of the paths of primary records would give: half their difference is the noise of this one.
    pub fn halves(&self) -> [IrradianceCache; 2] {
        let halves: Vec<_> = self.primary.iter().map(PrimaryIrradiance::halves).collect();
        let (a, b) = halves.into_iter().map(|[a, b]| (a, b)).unzip();
        [a, b].map(|primary| IrradianceCache {
            primary,
            secondary: self.secondary.clone(),
            uncovered: self.uncovered.clone(),
        })
    }

    /// How many records there are, primary and secondary.
    pub fn record_count(&self) -> [usize; 2] {
        let primary = self.primary.iter().map(|primary| primary.records.len());
        [primary.sum(), self.secondary.len()]
    }

    /// Memory in bytes.
    pub fn memory(&self) -> usize {
        let primary = self.primary.iter().map(PrimaryIrradiance::memory);
        primary.sum::<usize>() + self.secondary.memory() + self.uncovered.memory()
    }
}
