//! Error bounds of hit points, so that rays that leave a surface do not hit it again (Waechter and Binder 2019, "A Fast
//! and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems; pbrt 6.8 bounds the error in the same way).

use crate::math::Ray;
use glam::{DVec3, Vec3};

/// A hit point, rounded to single precision towards the ray's origin and moved towards it by a few units of
/// rounding: the space in between is free, but just behind the point there may be a wall, as in a corner.
#[inline(always)]
pub(super) fn round_towards_ray_origin(point: DVec3, ray: &Ray, t: f64) -> Vec3 {
    const ROUNDINGS: f64 = 4.0 * f32::EPSILON as f64;
    let direction = ray.direction.as_dvec3();
    let back = (ROUNDINGS * point.abs().max_element()).min(0.5 * t);
    let point = point - back * direction;
    let nearest = point.as_vec3();
    let beyond = (nearest.as_dvec3() - point) * direction;
    Vec3::new(
        stepped_back(nearest.x, ray.direction.x, beyond.x),
        stepped_back(nearest.y, ray.direction.y, beyond.y),
        stepped_back(nearest.z, ray.direction.z, beyond.z),
    )
}

/// The next float against `direction` if `x` is beyond, else `x`.
#[inline(always)]
fn stepped_back(x: f32, direction: f32, beyond: f64) -> f32 {
    // Branches would be mispredicted half of the time: so there are none.
    let back = 2 * i32::from(direction.is_sign_negative()) - 1;
    stepped(x, back * i32::from(beyond > 0.0))
}

/// The float `steps` representable numbers above `x`; both are finite.
#[inline(always)]
fn stepped(x: f32, steps: i32) -> f32 {
    // The bits without the sign count the representable numbers between 0 and a number.
    let bits = x.to_bits() as i32;
    let sign = bits >> 31;
    let number = (((bits & i32::MAX) ^ sign) - sign) + steps;
    let sign = number >> 31;
    f32::from_bits((((number ^ sign) - sign) | (sign << 31)) as u32)
}

/// The distance from a point along its normal at which rays start, in metres: twice the error bound of the point.
///
/// The point was computed in double precision, so almost all of its error is its rounding to single
/// precision: an ulp in each coordinate. Doubling keeps a ray's origin on its side of the exact surface after the
/// origin, too, is rounded. `magnitude` bounds the coordinates that the point was computed from.
#[inline(always)]
pub(super) fn ray_offset(position: Vec3, normal: Vec3, magnitude: f32) -> f32 {
    const DOUBLE_PRECISION_ERROR: f32 = 32.0 * f64::EPSILON as f32;
    (2.0 * f32::EPSILON * position.abs()).dot(normal.abs()) + DOUBLE_PRECISION_ERROR * magnitude
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_lead_to_the_next_numbers() {
        for x in [0.0, -0.0, 1.0, -1.0, 1.999_999_9, -1e-45, 3e38] {
            assert_eq!(stepped(x, 1), x.next_up());
            assert_eq!(stepped(x, -1), x.next_down());
            assert_eq!(stepped(x, 0), x);
            assert_eq!(stepped_back(x, -0.5, 1.0), x.next_up());
            assert_eq!(stepped_back(x, 0.5, 1.0), x.next_down());
            assert_eq!(stepped_back(x, 0.5, 0.0), x);
        }
    }
}
