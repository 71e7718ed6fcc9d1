//! How rays change with the position on the film: the differentials of Igehy (1999, "Tracing Ray Differentials").

use super::Ray;
use glam::{Vec2, Vec3};

/// The change of a ray over the footprint of its sample: over the footprint's width and over its height on the film.
///
/// Zero stands for a sample of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayDifferential {
    /// The changes of the origin, in metres.
    pub origin: [Vec3; 2],
    /// The changes of the direction.
    pub direction: [Vec3; 2],
    /// The middle of the footprint as seen from the ray, in widths and heights of the footprint.
    pub middle: Vec2,
}

impl RayDifferential {
    /// That of a ray whose sample stands for a point.
    pub const ZERO: RayDifferential = RayDifferential {
        origin: [Vec3::ZERO; 2],
        direction: [Vec3::ZERO; 2],
        middle: Vec2::ZERO,
    };

    /// The changes of the point where `ray` meets, at parameter `t`, a surface with unit `normal` there; in metres. Not
    /// finite for a ray within the surface.
    #[inline(always)]
    pub fn transfer(&self, ray: &Ray, t: f32, normal: Vec3) -> [Vec3; 2] {
        let along = ray.direction / ray.direction.dot(normal);
        [0, 1].map(|axis| {
            let change = self.origin[axis] + t * self.direction[axis];
            change - along * change.dot(normal)
        })
    }

    /// That of the ray that is reflected at a mirror with unit `normal`, given the changes of the point and the normal
    /// there.
    #[inline(always)]
    pub fn reflect(
        &self,
        direction: Vec3,
        normal: Vec3,
        point_changes: [Vec3; 2],
        normal_changes: [Vec3; 2],
    ) -> RayDifferential {
        let cosine = direction.dot(normal);
        let reflected = |axis: usize| {
            let (change, turn) = (self.direction[axis], normal_changes[axis]);
            let cosine_change = change.dot(normal) + direction.dot(turn);
            change - 2.0 * (cosine_change * normal + cosine * turn)
        };
        RayDifferential {
            origin: point_changes,
            direction: [0, 1].map(reflected),
            middle: self.middle,
        }
    }
}
