//! Irradiance at the second and later vertices of a path, coarser than what the camera sees because each gathered
//! value averages many of them (the idea of Tabellion and Lamorlette 2004, "An Approximate Global Illumination
//! System for Computer Generated Films").

use super::records::IrradianceRecords;
use glam::Vec3;

/// Mean incident radiance at surfaces that gathered rays hit.
#[derive(Debug)]
pub struct SecondaryIrradiance {
    /// The records.
    pub records: IrradianceRecords,
    /// E / π in W/(sr m²), indexed by the number of bounces left, less 1, and by record.
    pub values: Vec<Vec<Vec3>>,
    /// Hits closer than this to the origin of their ray, in metres, are not looked up: they are too close for
    /// records of this size.
    pub min_distance: f32,
}

impl SecondaryIrradiance {
    /// The interpolated value at a hit at `distance` from the origin of its ray, where `bounces_left` bounces, at
    /// least one, are left; none where no record covers it.
    #[inline]
    pub fn mean_radiance(
        &self,
        position: Vec3,
        normal: Vec3,
        bounces_left: u32,
        distance: f32,
    ) -> Option<Vec3> {
        let values = self.values.get(bounces_left as usize - 1)?;
        if distance < self.min_distance {
            return None;
        }
        self.records
            .mean(position, normal, 1.0, |index| values[index])
    }

    /// Memory in bytes.
    pub fn memory(&self) -> usize {
        let values = self.values.iter().map(|values| size_of_val(&**values));
        self.records.memory() + values.sum::<usize>()
    }
}
