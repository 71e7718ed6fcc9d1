//! Irradiance at the second and later vertices of a path, coarser than what the camera sees because each gathered
//! value averages many of them (the idea of Tabellion and Lamorlette 2004, "An Approximate Global Illumination
//! System for Computer Generated Films").
//!
//! There is one record in a cell. It is gathered when a path first asks for it, and is the same whoever asks.

use super::cell::CellKey;
use dashmap::DashMap;
use glam::Vec3;
use rustc_hash::FxBuildHasher;
use serde::{Deserialize, Serialize, Serializer};
use std::sync::{Arc, OnceLock};

/// What decides secondary records, beside the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SecondarySettings {
    /// The level of their largest cells.
    pub level: i8,
    /// Paths that gather a value.
    pub paths: u32,
    /// Seed of the random numbers.
    pub seed: u32,
}

/// Where the record of a cell stands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SecondaryPlace {
    /// Position in metres, relative to the scene's origin.
    pub position: Vec3,
    /// The unit shading normal.
    pub normal: Vec3,
    /// A point above the record: what sees it sees the record.
    pub eye: Vec3,
    /// Whether other surfaces are so close that irradiance may change within the cell.
    pub is_obstructed: bool,
}

/// The record of a cell.
#[derive(Debug)]
pub struct SecondaryRecord {
    /// Where it stands.
    pub place: SecondaryPlace,
    /// E / π in W/(sr m²), by the number of bounces left, less 1; unset until they are asked for.
    pub values: Vec<OnceLock<Vec3>>,
}

/// Mean incident radiance at surfaces that gathered rays hit.
#[derive(Debug, Deserialize)]
#[serde(from = "StoredRecords")]
pub struct SecondaryIrradiance {
    settings: SecondarySettings,
    /// The most bounces left.
    bounces: u32,
    /// None where a cell has no surface.
    cells: DashMap<CellKey, Option<Arc<SecondaryRecord>>, FxBuildHasher>,
}

impl SecondaryIrradiance {
    /// Without records yet, for up to `bounces` bounces.
    pub fn new(settings: SecondarySettings, bounces: u32) -> SecondaryIrradiance {
        SecondaryIrradiance {
            settings,
            bounces,
            cells: DashMap::default(),
        }
    }

    /// What decides its records.
    pub fn settings(&self) -> SecondarySettings {
        self.settings
    }

    /// The record of a cell, which stands where `place` says; none if that says so.
    pub fn record(
        &self,
        cell: CellKey,
        place: impl FnOnce() -> Option<SecondaryPlace>,
    ) -> Option<Arc<SecondaryRecord>> {
        if let Some(found) = self.cells.get(&cell) {
            return found.clone();
        }
        let record = place().map(|place| {
            Arc::new(SecondaryRecord {
                place,
                values: (0..self.bounces).map(|_| OnceLock::new()).collect(),
            })
        });
        // Another thread may have been faster, with the same place.
        self.cells.entry(cell).or_insert(record).clone()
    }

    /// The number of records.
    pub fn len(&self) -> usize {
        self.cells.iter().filter(|cell| cell.is_some()).count()
    }

    /// Whether there are no records.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Memory in bytes.
    pub fn memory(&self) -> usize {
        let record = size_of::<SecondaryRecord>()
            + self.bounces as usize * size_of::<OnceLock<Vec3>>()
            + 2 * size_of::<usize>();
        let slot = size_of::<(CellKey, Option<Arc<SecondaryRecord>>)>() + 1;
        self.cells.capacity() * slot + self.len() * record
    }
}

/// What a file keeps of [`SecondaryIrradiance`].
#[derive(Serialize, Deserialize)]
struct StoredRecords {
    settings: SecondarySettings,
    bounces: u32,
    /// In the order of cells.
    cells: Vec<(CellKey, Option<StoredRecord>)>,
}

#[derive(Serialize, Deserialize)]
struct StoredRecord {
    place: SecondaryPlace,
    values: Vec<Option<Vec3>>,
}

impl Serialize for SecondaryIrradiance {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let stored = |record: &Arc<SecondaryRecord>| StoredRecord {
            place: record.place,
            values: record
                .values
                .iter()
                .map(|value| value.get().copied())
                .collect(),
        };
        let cells = self.cells.iter();
        let mut cells: Vec<_> = cells
            .map(|cell| (*cell.key(), cell.value().as_ref().map(stored)))
            .collect();
        cells.sort_by_key(|(key, _)| *key);
        let stored = StoredRecords {
            settings: self.settings,
            bounces: self.bounces,
            cells,
        };
        stored.serialize(serializer)
    }
}

impl From<StoredRecords> for SecondaryIrradiance {
    fn from(stored: StoredRecords) -> SecondaryIrradiance {
        let record = |StoredRecord { place, values }: StoredRecord| {
            let values = values.into_iter();
            Arc::new(SecondaryRecord {
                place,
                values: values
                    .map(|value| value.map_or_else(OnceLock::new, OnceLock::from))
                    .collect(),
            })
        };
        let cells = stored.cells.into_iter();
        SecondaryIrradiance {
            settings: stored.settings,
            bounces: stored.bounces,
            cells: cells.map(|(key, cell)| (key, cell.map(record))).collect(),
        }
    }
}
