//! What a light tree knows of a set of emitters.

use crate::light::LightBounds;
use crate::math::Aabb;
use glam::{DVec3, Vec3};

/// Bounds of a set of emitters, which hold in spite of rounding.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeBounds {
    /// The centre of a box that holds them, and half of its edges.
    pub center: Vec3,
    pub half_extent: Vec3,
    /// The axis of a cone that holds all normals, and its half angle.
    pub axis: Vec3,
    pub cos_theta_o: f32,
    pub sin_theta_o: f32,
    pub cos_theta_e: f32,
    pub is_two_sided: bool,
    pub power: f32,
}

impl NodeBounds {
    /// The bounds of one or more emitters.
    pub(super) fn of<'a>(lights: impl Iterator<Item = &'a LightBounds> + Clone) -> NodeBounds {
        let all = || lights.clone();
        let bounds = all().fold(Aabb::EMPTY, |all, light| all.union(light.bounds));
        let center = bounds.center();
        // Of the emitters that emit from both sides, those sides count that face like the first.
        let first = all().next().map_or(Vec3::Z, |light| light.axis);
        let facing = |light: &LightBounds| match light.is_two_sided && light.axis.dot(first) < 0.0 {
            true => -light.axis,
            false => light.axis,
        };
        // In the middle between the extremes, however many emitters are at either.
        let axis = Aabb::of(all().map(facing)).center().normalize_or(first);
        let (cos_theta_o, sin_theta_o) = all()
            .map(|light| farthest_normal(axis.as_dvec3(), facing(light).as_dvec3(), light))
            .fold((1.0, 0.0), |a, b| if b.0 < a.0 { b } else { a });
        NodeBounds {
            center,
            half_extent: (bounds.max - center).max(center - bounds.min),
            axis,
            cos_theta_o: cos_theta_o as f32,
            sin_theta_o: sin_theta_o as f32,
            cos_theta_e: all().map(|light| light.cos_theta_e).fold(1.0, f32::min),
            is_two_sided: all().any(|light| light.is_two_sided),
            power: all().map(|light| f64::from(light.power)).sum::<f64>() as f32,
        }
    }
}

/// The cosine and the sine of the largest angle between `axis` and a normal of `light`, whose cone is around `other`.
fn farthest_normal(axis: DVec3, other: DVec3, light: &LightBounds) -> (f64, f64) {
    let cos_o = f64::from(light.cos_theta_o);
    let sin_o = (1.0 - cos_o * cos_o).max(0.0).sqrt();
    // Lengths of 1 but for rounding.
    let scale = (axis.length_squared() * other.length_squared())
        .sqrt()
        .recip();
    let cos = scale * axis.dot(other);
    let sin = scale * axis.cross(other).length();
    // The sum of both angles, at most pi.
    if cos <= -cos_o {
        (-1.0, 0.0)
    } else {
        (cos * cos_o - sin * sin_o, sin * cos_o + cos * sin_o)
    }
}
