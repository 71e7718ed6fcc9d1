//! Cells of space, in which records stand: where a record is depends on the scene and its cell alone, not on who asked
//! for it first (as the cells of Binder, Fricke and Keller 2018, "Fast Path Space Filtering by Jittered Spatial Hashing").

use crate::math::Aabb;
use glam::{IVec3, Vec3};
use serde::{Deserialize, Serialize};
use std::f32::consts::FRAC_PI_4;

/// A cube whose side is a power of two, and the surfaces in it that face one way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct CellKey {
    /// The binary logarithm of the side in metres.
    level: i8,
    /// The way that its surfaces face: see [`facing`] and [`narrow_facing`].
    facing: u8,
    /// The numbers of cells between it and the origin.
    index: [i32; 3],
}

/// Where cells start, in sides: not on round coordinates, where walls stand.
const SHIFT: f32 = 0.381_966;

/// Axes whose weights differ tell normals between two axes apart whatever their rounding error.
const AXIS_WEIGHTS: Vec3 = Vec3::new(1.0, 0.97, 0.94);

/// Ways that cells face: one for each half of an axis; and narrow ones, squares on the faces of a cube around the origin, so
/// many along each edge.
const WIDE_FACINGS: u8 = 6;
const NARROW: u8 = 4;

impl CellKey {
    /// The cell of a level that contains a surface point with a unit normal. The level is raised where the coordinates
    /// are too coarse for it.
    pub fn containing(position: Vec3, normal: Vec3, level: i32) -> CellKey {
        CellKey::of_facing(position, facing(normal), level)
    }

    /// The same of cells whose surfaces all face about the same way: where surfaces are so curved or small that those of one
    /// axis differ.
    pub fn narrow(position: Vec3, normal: Vec3, level: i32) -> CellKey {
        CellKey::of_facing(position, narrow_facing(normal), level)
    }

    fn of_facing(position: Vec3, facing: u8, level: i32) -> CellKey {
        let level = level.max(finest_level(position));
        let side = side(level);
        let index = (position / side + SHIFT).floor().as_ivec3();
        CellKey {
            level: level as i8,
            facing,
            index: index.to_array(),
        }
    }

    /// The level of cells with this side, in metres, or the next smaller one.
    pub fn level_of_side(side: f32) -> i32 {
        (libm::log2f(side).floor() as i32).clamp(-60, 60)
    }

    /// The binary logarithm of the side.
    pub fn level(&self) -> i32 {
        i32::from(self.level)
    }

    /// The side in metres.
    pub fn side(&self) -> f32 {
        side(self.level())
    }

    /// The cube.
    pub fn bounds(&self) -> Aabb {
        let min = (IVec3::from_array(self.index).as_vec3() - SHIFT) * self.side();
        Aabb {
            min,
            max: min + self.side(),
        }
    }

    /// The axis that normals are nearest to.
    pub fn axis(&self) -> Vec3 {
        let facing = match self.facing.checked_sub(WIDE_FACINGS) {
            Some(narrow) => narrow / (NARROW * NARROW),
            None => self.facing,
        };
        let mut axis = Vec3::ZERO;
        axis[usize::from(facing / 2)] = if facing.is_multiple_of(2) { 1.0 } else { -1.0 };
        axis
    }

    /// Whether surfaces with this normal belong to the cell.
    pub fn faces(&self, normal: Vec3) -> bool {
        let facing = if self.facing < WIDE_FACINGS {
            facing(normal)
        } else {
            narrow_facing(normal)
        };
        facing == self.facing
    }

    /// Four words that tell it from other cells.
    pub fn words(&self) -> [u32; 4] {
        let [x, y, z] = self.index.map(|index| index as u32);
        let level = u32::from(self.level as u8);
        [level << 8 | u32::from(self.facing), x, y, z]
    }
}

/// Of a level in -60..=60: exact.
fn side(level: i32) -> f32 {
    const BIAS: i32 = 127;
    f32::from_bits(((level + BIAS) as u32) << (f32::MANTISSA_DIGITS - 1))
}

/// Single precision has 24 bits: cells below keep five of them.
fn finest_level(position: Vec3) -> i32 {
    const BITS: i32 = 19;
    const BIAS: i32 = 127;
    let exponent = position.abs().max_element().to_bits() >> (f32::MANTISSA_DIGITS - 1);
    (exponent as i32 - BIAS + 1 - BITS).clamp(-60, 60)
}

/// The axis that a normal is nearest to, times two; one more if it is the negative one.
fn facing(normal: Vec3) -> u8 {
    let weighted = normal.abs() * AXIS_WEIGHTS;
    let axis = weighted.max_position();
    2 * axis as u8 + u8::from(normal[axis] < 0.0)
}

/// The same, in squares of the cube's face: after the wide ones.
fn narrow_facing(normal: Vec3) -> u8 {
    let face = facing(normal);
    let axis = usize::from(face / 2);
    let square = |along: usize| {
        let tangent = normal[(axis + along) % 3] / normal[axis].abs();
        let angle = libm::atanf(tangent) / FRAC_PI_4;
        let square = (0.5 * (angle + 1.0) * f32::from(NARROW)) as u8;
        square.min(NARROW - 1)
    };
    WIDE_FACINGS + (face * NARROW + square(1)) * NARROW + square(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;
    use glam::Vec3Swizzles;

    #[test]
    fn cells_contain_their_points() {
        let mut random = Random::new(8);
        for _ in 0..20_000 {
            let position = random.vector(10.0);
            let normal = random.vector(1.0).normalize();
            let level = random.below(14) as i32 - 11;
            let cell = CellKey::containing(position, normal, level);
            assert_eq!(cell.level(), level);
            let bounds = cell.bounds();
            let rounding = Vec3::splat(2e-6);
            let is_inside =
                position.cmpge(bounds.min - rounding) & position.cmple(bounds.max + rounding);
            assert!(is_inside.all(), "{position} {cell:?}");
            assert!(cell.axis().dot(normal) >= 0.94 / 3_f32.sqrt());
            assert!(cell.faces(normal) && !cell.faces(-normal));
            // Neighbours in every direction are others.
            let beside = position + cell.axis().zxy() * 1.01 * cell.side();
            assert_ne!(
                CellKey::containing(beside, normal, level).words(),
                cell.words()
            );
        }
    }

    /// What a narrow cell holds faces about the same way, and along the axis of the wide one.
    #[test]
    fn narrow_cells_face_one_way() {
        let mut random = Random::new(3);
        let mut seen = 0;
        for _ in 0..40_000 {
            let normal = random.vector(1.0).normalize();
            let other = (normal + random.vector(0.5)).normalize();
            let [narrow, wide] = [CellKey::narrow, CellKey::containing]
                .map(|cell_of| cell_of(Vec3::ZERO, normal, 0));
            assert_eq!(narrow.axis(), wide.axis());
            assert_ne!(narrow, wide);
            assert!(narrow.faces(normal));
            if narrow.faces(other) {
                seen += 1;
                assert!(wide.faces(other));
                assert!(normal.dot(other) > 32_f32.to_radians().cos());
            }
        }
        assert!(seen > 4_000, "{seen}");
    }

    #[test]
    fn sides_are_powers_of_two() {
        for (side, level) in [(1.0, 0), (0.99, -1), (0.5, -1), (3.0, 1), (0.0, -60)] {
            assert_eq!(CellKey::level_of_side(side), level);
        }
        let far = CellKey::containing(Vec3::splat(1e6), Vec3::X, -30);
        assert!(far.side() > 1.0 && far.side() < 8.0);
    }
}
