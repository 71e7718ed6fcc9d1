//! Spheres.

use crate::math::{Aabb, Ray};
use glam::{DMat3, DVec3, Vec2, Vec3};

/// A sphere, kept in double precision: a small sphere far away and a point on a
/// huge one both need it (Haines et al. 2019, "Precision Improvements for Ray/Sphere
/// Intersection", Ray Tracing Gems, chapter 7).
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    /// The centre, in metres.
    pub center: DVec3,
    /// The radius in metres; above 0.
    pub radius: f64,
    /// Object to world: it rotates the texture.
    pub rotation: DMat3,
}

impl Sphere {
    /// A sphere without rotation.
    pub fn new(center: DVec3, radius: f64) -> Sphere {
        Sphere {
            center,
            radius,
            rotation: DMat3::IDENTITY,
        }
    }

    /// The nearest ray parameter inside the ray's interval, or none.
    pub fn intersect(&self, ray: &Ray) -> Option<f64> {
        let direction = ray.direction.as_dvec3();
        let from_center = ray.origin.as_dvec3() - self.center;
        let a = direction.length_squared();
        let half_b = from_center.dot(direction);
        let depth = self.depth(ray.origin.as_dvec3().to_array(), direction.to_array());
        if depth < 0.0 {
            return None;
        }
        let root = (a * depth).sqrt();
        let q = -half_b - root.copysign(half_b);
        let c = (from_center.length() - self.radius) * (from_center.length() + self.radius);
        let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
        [t0.min(t1), t0.max(t1)]
            .into_iter()
            .find(|&t| t > 0.0 && t < f64::from(ray.t_max))
    }

    /// The squared radius minus the squared distance of a line from the centre: the discriminant, up to a
    /// factor; negative for a line that misses the sphere.
    #[inline(always)]
    pub fn depth(&self, [ox, oy, oz]: [f64; 3], [dx, dy, dz]: [f64; 3]) -> f64 {
        // Not from b^2 - ac, which cancels. Scalars, so that loops over rays are vectorised.
        let DVec3 { x, y, z } = self.center;
        let (x, y, z) = (ox - x, oy - y, oz - z);
        let along = (x * dx + y * dy + z * dz) / (dx * dx + dy * dy + dz * dz);
        let (x, y, z) = (x - dx * along, y - dy * along, z - dz * along);
        self.radius * self.radius - (x * x + y * y + z * z)
    }

    /// The distance from a point, inside or outside, to the sphere's surface.
    pub fn distance(&self, point: DVec3) -> f64 {
        (point.distance(self.center) - self.radius).abs()
    }

    /// The texture coordinates of the point with outward unit `normal`.
    ///
    /// From the direction d to the centre, turned back by the object's rotation:
    /// u = 1/2 + atan2(-d.x, -d.z) / 2 pi, v = 1/2 - asin(d.y) / pi. So v is 0 at the south pole and
    /// 1 at the north pole (+Y), and from outside u grows to the right, with the picture's middle
    /// towards +Z.
    pub fn uv(&self, normal: DVec3) -> Vec2 {
        let local = self.rotation.transpose() * normal;
        let u = 0.5 + libm::atan2(local.x, local.z) / std::f64::consts::TAU;
        let v = 0.5 + libm::asin(local.y.clamp(-1.0, 1.0)) / std::f64::consts::PI;
        Vec2::new(u as f32, v as f32)
    }

    /// The change of [`Sphere::uv`] of the point with outward unit `normal` where that changes by `turn`: at most one
    /// turn around the axis, however close the poles are.
    pub fn uv_change(&self, normal: DVec3, turn: DVec3) -> Vec2 {
        let local = self.rotation.transpose() * normal;
        let turn = self.rotation.transpose() * turn;
        // The distance from the axis; the bound is far below what a normal can tell apart.
        let from_axis = (local.x * local.x + local.z * local.z).sqrt().max(1e-12);
        let around = (local.z * turn.x - local.x * turn.z) / (from_axis * from_axis);
        let u = (around / std::f64::consts::TAU).clamp(-1.0, 1.0);
        let v = turn.y / from_axis / std::f64::consts::PI;
        Vec2::new(u as f32, v as f32)
    }

    /// The smallest box around the sphere, rounded outwards.
    pub fn bounds(&self) -> Aabb {
        let radius = DVec3::splat(self.radius);
        let down = |v: DVec3| Vec3::from_array(v.to_array().map(|x| (x as f32).next_down()));
        let up = |v: DVec3| Vec3::from_array(v.to_array().map(|x| (x as f32).next_up()));
        Aabb {
            min: down(self.center - radius),
            max: up(self.center + radius),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_sphere_far_away_is_hit_exactly() {
        // Radius 1e-6 at distance 10, ray offset by 0.6 r: t = 10 - 0.8 r.
        let s = Sphere::new(DVec3::new(0.6e-6, 0.0, -10.0), 1e-6);
        let t = s.intersect(&Ray::new(Vec3::ZERO, Vec3::NEG_Z));
        assert!((t.unwrap_or(0.0) - (10.0 - 0.8e-6)).abs() < 1e-12);
    }

    #[test]
    fn uv_follows_the_documented_directions() {
        let s = Sphere::new(DVec3::ZERO, 1.0);
        let close = |n: DVec3, u: f32, v: f32| (s.uv(n) - Vec2::new(u, v)).length() < 1e-6;
        assert!(close(DVec3::Z, 0.5, 0.5));
        assert!(close(DVec3::X, 0.75, 0.5));
        assert!(close(DVec3::NEG_X, 0.25, 0.5));
        assert_eq!(s.uv(DVec3::Y).y, 1.0);
        assert_eq!(s.uv(DVec3::NEG_Y).y, 0.0);
        // Turning the object a quarter about Y carries the middle of the picture from +Z to +X.
        let turned = Sphere {
            rotation: DMat3::from_rotation_y(std::f64::consts::FRAC_PI_2),
            ..s
        };
        assert!((turned.uv(DVec3::X) - Vec2::new(0.5, 0.5)).length() < 1e-6);
    }
}
