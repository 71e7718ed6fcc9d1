//! Irradiance in cells of space: one record in each, which is gathered when it is first asked for, and is the same whoever
//! asks.
//!
//! So it is kept for the second and later vertices of a path, coarser than what the camera sees because each gathered
//! value averages many of them (the idea of Tabellion and Lamorlette 2004, "An Approximate Global Illumination
//! System for Computer Generated Films"); and for the few points that a camera sees where no primary record is.

use super::cell::CellKey;
use super::record::IrradianceRecord;
use dashmap::DashMap;
use glam::Vec3;
use rustc_hash::FxBuildHasher;
use serde::{Deserialize, Serialize, Serializer};
use std::sync::{Arc, OnceLock};

/// What decides the records of cells, beside the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellSettings {
    /// The level of their largest cells.
    pub level: i8,
    /// Paths that gather a value.
    pub paths: u32,
    /// Seed of the random numbers.
    pub seed: u32,
}

/// The record of a cell.
#[derive(Debug)]
pub struct CellRecord {
    /// Where it stands.
    pub place: IrradianceRecord,
    /// E / π in W/(sr m²), by the number of bounces left, less 1; unset until they are asked for.
    pub values: Vec<OnceLock<Vec3>>,
}

/// Mean incident radiance in cells.
#[derive(Debug, Deserialize)]
#[serde(from = "StoredRecords")]
pub struct CellIrradiance {
    settings: CellSettings,
    /// The most bounces left.
    bounces: u32,
    /// None where a cell has no surface.
    cells: DashMap<CellKey, Option<Arc<CellRecord>>, FxBuildHasher>,
}

impl CellIrradiance {
    /// Without records yet, for up to `bounces` bounces.
    pub fn new(settings: CellSettings, bounces: u32) -> CellIrradiance {
        CellIrradiance {
            settings,
            bounces,
            cells: DashMap::default(),
        }
    }

    /// What decides its records.
    pub fn settings(&self) -> CellSettings {
        self.settings
    }

    /// What is known of a cell: its record, if it has one, and the value of that with so many bounces left; none if nobody has
    /// asked for it.
    pub fn known(
        &self,
        cell: &CellKey,
        bounces_left: u32,
    ) -> Option<Option<(IrradianceRecord, Option<Vec3>)>> {
        let found = self.cells.get(cell)?;
        let value = |record: &Arc<CellRecord>| {
            let value = record.values.get(bounces_left as usize - 1);
            (record.place, value.and_then(|value| value.get().copied()))
        };
        Some(found.as_ref().map(value))
    }

    /// The record of a cell, which stands where `place` says; none if that says so.
    pub fn record(
        &self,
        cell: CellKey,
        place: impl FnOnce() -> Option<IrradianceRecord>,
    ) -> Option<Arc<CellRecord>> {
        if let Some(found) = self.cells.get(&cell) {
            return found.clone();
        }
        let record = place().map(|place| {
            Arc::new(CellRecord {
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
        let record = size_of::<CellRecord>()
            + self.bounces as usize * size_of::<OnceLock<Vec3>>()
            + 2 * size_of::<usize>();
        let slot = size_of::<(CellKey, Option<Arc<CellRecord>>)>() + 1;
        self.cells.capacity() * slot + self.len() * record
    }
}

/// What a file keeps of [`CellIrradiance`].
#[derive(Serialize, Deserialize)]
struct StoredRecords {
    settings: CellSettings,
    bounces: u32,
    /// In the order of cells.
    cells: Vec<(CellKey, Option<StoredRecord>)>,
}

#[derive(Serialize, Deserialize)]
struct StoredRecord {
    place: IrradianceRecord,
    values: Vec<Option<Vec3>>,
}

impl Serialize for CellIrradiance {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let stored = |record: &Arc<CellRecord>| StoredRecord {
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

impl From<StoredRecords> for CellIrradiance {
    fn from(stored: StoredRecords) -> CellIrradiance {
        let record = |StoredRecord { place, values }: StoredRecord| {
            let values = values.into_iter();
            Arc::new(CellRecord {
                place,
                values: values
                    .map(|value| value.map_or_else(OnceLock::new, OnceLock::from))
                    .collect(),
            })
        };
        let cells = stored.cells.into_iter();
        CellIrradiance {
            settings: stored.settings,
            bounces: stored.bounces,
            cells: cells.map(|(key, cell)| (key, cell.map(record))).collect(),
        }
    }
}
