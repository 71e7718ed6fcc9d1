use crate::geometry::Hit;
use crate::math::{NO_PRIMITIVE, Ray};
use crate::sampling::Sequence;
use crate::scene::Surface;
use std::f32::consts::PI;

/// The last ray of a light path, and how it came to be.
#[derive(Clone, Copy)]
pub(super) struct Path {
    pub(super) ray: Ray,
    /// The random numbers of its pixel.
    pub(super) sequence: Sequence,
    /// Bounces since the camera.
    pub(super) depth: u32,
    /// Those of them that were diffuse.
    pub(super) diffuse_bounces: usize,
    /// Its number among the paths of this depth in the pixel.
    pub(super) index: u32,
    /// How the direction of the ray was chosen.
    pub(super) choice: Choice,
}

/// How a direction was chosen.
///
/// Where lights throw spots there are two ways to choose it: by the cosine, or towards points that
/// lights see. Whichever is taken, the light that arrives is divided by the density of both together:
/// multiple importance sampling by the balance heuristic (Veach and Guibas 1995), here of the first two
/// vertices of a path from the light (Veach 1997, "Robust Monte Carlo Methods for Light Transport
/// Simulation", chapter 10).
#[derive(Clone, Copy)]
pub(super) enum Choice {
    /// There is but one way.
    Only,
    /// By the cosine.
    Cosine {
        /// Its density.
        density: f32,
    },
    /// Towards a point that a light sees.
    Spot {
        /// The density of the cosine in that direction.
        cosine_density: f32,
        /// What the point lies on.
        primitive: u32,
        /// How far away it is.
        distance: f64,
    },
}

impl Choice {
    /// Towards a point that is not known yet: the ray still leaves the light.
    pub(super) const UNAIMED: Choice = Choice::Spot {
        cosine_density: 0.0,
        primitive: NO_PRIMITIVE,
        distance: 0.0,
    };

    /// The share of directions that are chosen towards spots: see [`Sequence::deal`].
    const SPOT_SHARE: f32 = 0.25;
}

impl Path {
    /// For a path whose ray leaves a light and hits there: the one that goes from `surface` to that point,
    /// or none if the point lies below the horizon.
    pub(super) fn aim(&self, surface: &Surface, hit: &Hit) -> Option<Path> {
        let to_point = self.ray.at(hit.t) - surface.point.position.as_dvec3();
        let distance = to_point.length();
        let direction = (to_point / distance).as_vec3();
        let cosine = direction.dot(surface.point.shading_normal);
        let is_above = cosine > 0.0 && direction.dot(surface.point.geometric_normal) > 0.0;
        is_above.then(|| Path {
            ray: surface.point.spawn_ray(direction),
            choice: Choice::Spot {
                cosine_density: cosine / PI,
                primitive: hit.primitive,
                distance,
            },
            ..*self
        })
    }

    /// The density of the cosine over that of both ways to choose the direction, given what the ray
    /// meets and how many points that lights see there are on a unit of its area. Zero if the ray
    /// was aimed at a point and meets another.
    pub(super) fn weight(&self, met: Option<(&Hit, &Surface)>, seen_by_lights: f32) -> f32 {
        /// Beyond rounding, yet nearer than a sphere's other side, but for its very edge.
        const SAME: f64 = 1e-3;
        let cosine_density = match self.choice {
            Choice::Only => return 1.0,
            Choice::Cosine { density } => density,
            Choice::Spot {
                cosine_density,
                primitive,
                distance,
            } => {
                let is_met = met.is_some_and(|(hit, _)| {
                    hit.primitive == primitive && (hit.t - distance).abs() <= SAME * distance
                });
                if !is_met || seen_by_lights == 0.0 {
                    return 0.0;
                }
                cosine_density
            }
        };
        let spot_density = met.map_or(0.0, |(_, surface)| {
            let distance_squared = (surface.point.position - self.ray.origin).length_squared();
            let cos = -surface.point.geometric_normal.dot(self.ray.direction);
            seen_by_lights * distance_squared / cos
        });
        let both = (1.0 - Choice::SPOT_SHARE) * cosine_density + Choice::SPOT_SHARE * spot_density;
        // A direction along the very horizon has no density at all.
        if both > 0.0 {
            cosine_density / both
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn directions_along_the_horizon_weigh_nothing() {
        let weight = |density| {
            let path = Path {
                ray: Ray::new(Vec3::ZERO, Vec3::X),
                sequence: Sequence::new(0, 0, 0, 0),
                depth: 1,
                diffuse_bounces: 1,
                index: 0,
                choice: Choice::Cosine { density },
            };
            path.weight(None, 0.0)
        };
        assert_eq!(weight(0.0), 0.0);
        assert_eq!(weight(0.3), 1.0 / 0.75);
    }
}
