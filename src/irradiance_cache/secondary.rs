use super::IrradianceRecords;
use glam::Vec3;

/// The light at what gathered rays hit: coarser than what the camera sees, since many hits are summed up.
#[derive(Debug)]
pub struct SecondaryIrradiance {
    /// Where it is known.
    pub places: IrradianceRecords,
    /// By the number of bounces that are left, less 1, place by place.
    pub levels: Vec<Vec<Vec3>>,
    /// Hits nearer than this to where a ray starts look nothing up: they are too close for places of this
    /// size.
    pub nearest: f32,
}

impl SecondaryIrradiance {
    /// The light at a hit so far away, where `left` bounces are left, one at least; none where it is not
    /// known.
    #[inline]
    pub fn light(&self, position: Vec3, normal: Vec3, left: u32, distance: f32) -> Option<Vec3> {
        let level = self.levels.get(left as usize - 1)?;
        if distance < self.nearest {
            return None;
        }
        self.places
            .mean(position, normal, 1.0, |number| level[number])
    }

    /// Bytes.
    pub fn memory(&self) -> usize {
        let levels = self.levels.iter().map(|level| size_of_val(&**level));
        self.places.memory() + levels.sum::<usize>()
    }
}
