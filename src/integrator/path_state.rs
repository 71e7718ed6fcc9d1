//! One path of the path tracer: its last ray, how that was sampled, and the weight of multiple importance sampling
//! (Veach and Guibas 1995, "Optimally Combining Sampling Techniques for Monte Carlo Rendering").

use super::sampled_lights::balance_heuristic;
use super::sky_sampler::SkySampler;
use crate::geometry::Hit;
use crate::math::{NO_PRIMITIVE, Ray};
use crate::sampling::SobolSequence;
use crate::scene::{Scene, SurfaceInteraction};
use glam::Vec3;
use std::f32::consts::PI;

/// A path up to its last ray.
#[derive(Clone, Copy)]
pub(super) struct PathState {
    pub(super) ray: Ray,
    /// The random numbers of its film position.
    pub(super) sequence: SobolSequence,
    /// Bounces since the camera.
    pub(super) depth: u32,
    /// Diffuse bounces among them.
    pub(super) diffuse_bounces: usize,
    /// Its index among the paths of this depth with the same sequence.
    pub(super) index: u32,
    /// How the direction of the ray was sampled.
    pub(super) technique: Technique,
    /// How much of the light counts that the ray finds an emitter to send out.
    pub(super) emission: Emission,
    /// How much of the light of the sky counts along the ray.
    pub(super) sky: Emission,
}

/// How much of the light counts that an emitter or the sky sends along the last ray of a path.
#[derive(Clone, Copy)]
pub(super) enum Emission {
    /// All: camera and mirror rays.
    Seen,
    /// None: shadow rays alone count it.
    Sampled,
    /// A part, as shadow rays may have been sampled in its direction, too.
    Weighted {
        /// How many rays leave the surface as this one does, by the cosine.
        rays: f32,
    },
}

impl Emission {
    /// The weight of the light along a ray with this cosine to the shading normal that it leaves, by the balance heuristic.
    /// `shadow_density` gives the pdf of shadow rays in its direction, over solid angle, times their number.
    fn weight(self, cosine: f32, shadow_density: impl FnOnce() -> f32) -> f32 {
        match self {
            Emission::Seen => 1.0,
            Emission::Sampled => 0.0,
            Emission::Weighted { rays } => {
                balance_heuristic(rays, cosine.max(0.0) / PI, 1.0, shadow_density())
            }
        }
    }
}

/// How a direction was sampled.
///
/// Near lights there are two techniques: by the cosine, or towards points that are traced from lights. Light is
/// divided by the pdf of the mixture, whichever technique was chosen: multiple importance sampling by the balance
/// heuristic, here of the first two vertices of a path from the light (Veach 1997, "Robust Monte Carlo Methods for
/// Light Transport Simulation", chapter 10).
#[derive(Clone, Copy)]
pub(super) enum Technique {
    /// The only technique: camera and mirror rays, and diffuse rays without guiding lights.
    Single,
    /// By the cosine, one of two techniques.
    Cosine {
        /// Its pdf over solid angle.
        pdf: f32,
    },
    /// Towards a point that is traced from a light.
    Guided {
        /// The pdf of cosine sampling in that direction, over solid angle.
        cosine_pdf: f32,
        /// The primitive of the point.
        primitive: u32,
        /// The distance to the point.
        distance: f64,
    },
}

impl Technique {
    /// Guided, before the point is known: the ray still leaves the light.
    pub(super) const UNCONNECTED: Technique = Technique::Guided {
        cosine_pdf: 0.0,
        primitive: NO_PRIMITIVE,
        distance: 0.0,
    };

    /// The probability of the guided technique: see [`SobolSequence::choose_technique`].
    const GUIDE_FRACTION: f32 = 0.25;
}

impl PathState {
    /// Connects `surface` to the point where this path's ray, which leaves a light, hits. None if the point lies
    /// below the surface's horizon.
    pub(super) fn connect(&self, surface: &SurfaceInteraction, hit: &Hit) -> Option<PathState> {
        let to_point = self.ray.at(hit.t) - surface.point.position.as_dvec3();
        let distance = to_point.length();
        let direction = (to_point / distance).as_vec3();
        let cosine = direction.dot(surface.point.shading_normal);
        let is_above = cosine > 0.0 && direction.dot(surface.point.geometric_normal) > 0.0;
        is_above.then(|| PathState {
            ray: surface.point.spawn_ray(direction),
            technique: Technique::Guided {
                cosine_pdf: cosine / PI,
                primitive: hit.primitive,
                distance,
            },
            ..*self
        })
    }

    /// The weight of the light that an emitter sends along the last ray, given its hit, the shading normal that the ray leaves,
    /// and how many shadow rays for emitters do.
    pub(super) fn emission_weight(
        &self,
        scene: &Scene,
        hit: &Hit,
        shading_normal: Vec3,
        shadow_rays: u32,
    ) -> f32 {
        let cosine = shading_normal.dot(self.ray.direction);
        let shadow_pdf = || scene.emitter_pdf(shading_normal, &self.ray, hit);
        self.emission
            .weight(cosine, || shadow_rays as f32 * shadow_pdf())
    }

    /// The weight of the light of the sky along the last ray, which leaves the scene, given the shading normal that the ray
    /// leaves, what samples the sky by shadow rays, and how many of them there are.
    pub(super) fn sky_weight(
        &self,
        scene: &Scene,
        sky: Option<&SkySampler>,
        shading_normal: Vec3,
        shadow_rays: u32,
    ) -> f32 {
        let Ray {
            origin, direction, ..
        } = self.ray;
        let cosine = shading_normal.dot(direction);
        let shadow_pdf =
            |sky: &SkySampler| sky.techniques(scene, origin, shading_normal).pdf(direction);
        self.sky
            .weight(cosine, || shadow_rays as f32 * sky.map_or(0.0, shadow_pdf))
    }

    /// The weight of multiple importance sampling by the balance heuristic: the pdf of cosine sampling over that of the
    /// mixture. `hit` is what the ray hits, `light_pdf_area` the pdf, over area, of rays from lights there. Zero if the
    /// ray was connected to a point and hits another.
    pub(super) fn mis_weight(
        &self,
        hit: Option<(&Hit, &SurfaceInteraction)>,
        light_pdf_area: f32,
    ) -> f32 {
        /// Relative tolerance: more than rounding, less than the distance to a sphere's far side except at its
        /// silhouette.
        const CONNECTION_TOLERANCE: f64 = 1e-3;
        let cosine_pdf = match self.technique {
            Technique::Single => return 1.0,
            Technique::Cosine { pdf } => pdf,
            Technique::Guided {
                cosine_pdf,
                primitive,
                distance,
            } => {
                let is_connected = hit.is_some_and(|(hit, _)| {
                    hit.primitive == primitive
                        && (hit.t - distance).abs() <= CONNECTION_TOLERANCE * distance
                });
                if !is_connected || light_pdf_area == 0.0 {
                    return 0.0;
                }
                cosine_pdf
            }
        };
        let light_pdf = hit.map_or(0.0, |(_, surface)| {
            let distance_squared = (surface.point.position - self.ray.origin).length_squared();
            let cos = -surface.point.geometric_normal.dot(self.ray.direction);
            light_pdf_area * distance_squared / cos
        });
        let mixture_pdf =
            (1.0 - Technique::GUIDE_FRACTION) * cosine_pdf + Technique::GUIDE_FRACTION * light_pdf;
        // The pdf of a direction along the horizon is zero.
        if mixture_pdf > 0.0 {
            cosine_pdf / mixture_pdf
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_along_the_horizon_have_no_weight() {
        let mis_weight = |pdf| {
            let path = PathState {
                emission: Emission::Seen,
                sky: Emission::Seen,
                ray: Ray::new(Vec3::ZERO, Vec3::X),
                sequence: SobolSequence::new(0, 0, 0, 0),
                depth: 1,
                diffuse_bounces: 1,
                index: 0,
                technique: Technique::Cosine { pdf },
            };
            path.mis_weight(None, 0.0)
        };
        assert_eq!(mis_weight(0.0), 0.0);
        assert_eq!(mis_weight(0.3), 1.0 / 0.75);
    }
}
