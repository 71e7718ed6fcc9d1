//! The records of one or more camera paths and their values, as a file keeps them between runs.

use super::fit_gradients::RecordFit;
use super::gather::GatherSettings;
use super::gathered_light::{GatheredLight, RecordKey};
use crate::irradiance_cache::IrradianceCache;
use crate::render::ErrorEstimate;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// The irradiance records of some camera paths, and what it takes to add those of further paths.
///
/// A path's frames look up its own records only, and each record is the same whichever path needed it first: so what is
/// there for other paths changes nothing.
#[derive(Debug, Serialize, Deserialize)]
pub struct BakeState {
    pub(super) seed: u32,
    pub(super) bounces: u32,
    pub(super) lights: Vec<GatheredLight>,
    pub(super) paths: Vec<PathRecords>,
}

/// What the frames of a camera path look up.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct PathRecords {
    /// The name of the camera path.
    pub(super) name: String,
    pub(super) refinement_level: u32,
    pub(super) settings: GatherSettings,
    /// In order.
    pub(super) records: Vec<RecordKey>,
    /// Of each record.
    pub(super) fits: Vec<RecordFit>,
    /// The radiance that is displayed as white: errors are relative to it.
    pub(super) display_white: f32,
    /// The cache errors, by frame; none before they are measured.
    pub(super) errors: Option<Vec<ErrorEstimate>>,
}

impl BakeState {
    /// The highest refinement level.
    pub const MAX_REFINEMENT: u32 = 2;

    /// The state without records, where `bounces` bounces are counted.
    pub fn new(bounces: u32, seed: u32) -> BakeState {
        BakeState {
            seed,
            bounces,
            lights: Vec::new(),
            paths: Vec::new(),
        }
    }

    /// The refinement level of the records of a path; none if it does not hold that path.
    pub fn refinement_level(&self, name: &str) -> Option<u32> {
        self.path(name).map(|path| path.refinement_level)
    }

    /// The names of the camera paths whose records it holds, in the order in which they were added.
    pub fn camera_paths(&self) -> impl Iterator<Item = &str> {
        self.paths.iter().map(|path| &*path.name)
    }

    pub(super) fn path(&self, name: &str) -> Option<&PathRecords> {
        self.paths.iter().find(|path| path.name == name)
    }

    /// The cache error of each frame of a path, if it was measured for this display white.
    pub fn errors(&self, name: &str, display_white: f32) -> Option<&[ErrorEstimate]> {
        let path = self.path(name)?;
        let is_same = path.display_white == display_white;
        path.errors.as_deref().filter(|_| is_same)
    }

    /// Stores the cache error of each frame of a path.
    pub(super) fn set_errors(&mut self, name: &str, display_white: f32, errors: &[ErrorEstimate]) {
        if let Some(path) = self.paths.iter_mut().find(|path| path.name == name) {
            path.display_white = display_white;
            path.errors = Some(errors.to_vec());
        }
    }

    /// The irradiance cache that the frames of a path use; none if it does not hold that path.
    pub fn irradiance_cache(&self, scene: &Scene, name: &str) -> Option<IrradianceCache> {
        let path = self.path(name)?;
        let light = self
            .lights
            .iter()
            .find(|light| light.settings() == path.settings)?;
        Some(light.irradiance_cache(scene, self.bounces, &path.records, &path.fits))
    }
}
