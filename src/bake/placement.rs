use super::gather::{Purpose, numbers_of};
use crate::accel::Traversal;
use crate::irradiance_cache::{IrradianceRecord, IrradianceRecords, OccluderPlanes};
use crate::material::Only;
use crate::math::Ray;
use crate::sampling::uniform_sphere;
use crate::scene::{Scene, SurfacePoint};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// No more places are chosen: some gigabytes. What they do not cover is gathered for in each frame.
const MOST: usize = 1 << 21;

/// How close places lie.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Density {
    /// The radius, as a share of the harmonic mean distance of what a place sees: light changes in
    /// proportion to its inverse (Ward et al. 1988).
    pub(super) radius: f32,
    /// Every point is this share of a radius, at most, from the middle of a place.
    pub(super) spacing: f32,
    /// The angle between normals, in radians, that counts as the radius.
    pub(super) angle: f32,
    /// How many rays look around.
    pub(super) probes: u32,
}

/// A point that should be near a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) point: SurfacePoint,
    /// Its place, if it gets one, is no smaller.
    pub(super) least_radius: f32,
}

/// IrradianceRecords that are being chosen.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Placement {
    density: Density,
    seed: u32,
    pub(super) places: IrradianceRecords,
    /// The points in the middles of the places.
    pub(super) points: Vec<SurfacePoint>,
    /// The harmonic mean distance of what each of them sees.
    distances: Vec<f32>,
}

/// What a point sees.
struct Probe {
    harmonic_mean: f32,
    /// Points and their distances, the nearest first.
    hits: Vec<(SurfacePoint, f32)>,
}

impl Placement {
    /// No places yet.
    pub(super) fn new(scene: &Scene, density: Density, seed: u32) -> Placement {
        Placement {
            density,
            seed,
            places: IrradianceRecords::new(scene.bounds(), density.angle),
            points: Vec::new(),
            distances: Vec::new(),
        }
    }

    /// The median distance of what places see; none if there are none.
    pub(super) fn usual_distance(&self) -> Option<f32> {
        let mut distances = self.distances.clone();
        distances.sort_by(f32::total_cmp);
        distances.get(distances.len() / 2).copied()
    }

    /// The radius of the smallest place; 0 if there are none.
    pub(super) fn least_radius(&self) -> f32 {
        let radii = (0..self.places.len()).map(|number| self.places[number].radius);
        radii.reduce(f32::min).unwrap_or(0.0)
    }

    fn is_covered(&self, candidate: &Candidate) -> bool {
        let SurfacePoint {
            position,
            shading_normal,
            ..
        } = candidate.point;
        self.places
            .cover(position, shading_normal, self.density.spacing)
    }

    fn uncovered(&self, candidates: &[Candidate]) -> Vec<Candidate> {
        let candidates = candidates.par_iter();
        candidates
            .filter(|c| !self.is_covered(c))
            .copied()
            .collect()
    }

    /// Adds places until all candidates are covered, in their order. Returns what the new places see.
    ///
    /// Candidates are looked at in groups: many at once, and yet few that are covered by another one of
    /// their group, for which the work is in vain.
    pub(super) fn cover(&mut self, scene: &Scene, candidates: &[Candidate]) -> Vec<Candidate> {
        let mut hits = Vec::new();
        let uncovered = self.uncovered(candidates);
        let mut rest = &uncovered[..];
        while !rest.is_empty() && self.points.len() < MOST {
            let count = (self.points.len() / 4).clamp(16, 512).min(rest.len());
            let (next, later) = rest.split_at(count);
            let group = self.uncovered(next);
            let probe = |candidate: &Candidate| self.probe(scene, &candidate.point);
            let probes: Vec<Probe> = group.par_iter().map(probe).collect();
            for (candidate, probe) in group.iter().zip(probes) {
                if !self.is_covered(candidate) {
                    self.push(candidate, &probe);
                    hits.extend(probe.secondary());
                }
            }
            rest = later;
        }
        hits
    }

    /// Adds a place.
    ///
    /// It reaches no farther than the nearest thing that it sees, or at least not behind it; and as the distance of things changes from
    /// place to place by no more than what lies between them, neighbours tell each other of things that
    /// their own rays have missed (Krivanek et al. 2006, "Making Radiance and Irradiance Caching Practical:
    /// Adaptive Caching and Neighbor Clamping").
    fn push(&mut self, candidate: &Candidate, probe: &Probe) {
        let share = self.density.radius;
        let SurfacePoint {
            position,
            shading_normal,
            ..
        } = candidate.point;
        let mut around = Vec::new();
        self.places
            .visit(position, shading_normal, 1.0, |number, _| {
                around.push((number, (self.places[number].position - position).length()));
            });
        let nearest = probe.hits.first().map_or(f32::INFINITY, |hit| hit.1);
        let mut radius = (share * probe.harmonic_mean).min(nearest);
        for &(number, distance) in &around {
            radius = radius.min(self.places[number].radius + share * distance);
        }
        let radius = radius.max(candidate.least_radius);
        for (number, distance) in around {
            self.places.shrink(number, radius + share * distance);
        }
        self.places.push(IrradianceRecord {
            position,
            normal: shading_normal,
            radius,
            walls: probe.walls(&candidate.point, radius),
        });
        self.points.push(candidate.point);
        self.distances.push(probe.harmonic_mean);
    }

    /// Looks around, evenly: what is near the horizon matters, too.
    fn probe(&self, scene: &Scene, point: &SurfacePoint) -> Probe {
        let numbers = numbers_of(point, self.seed, Purpose::Probes, 0);
        let ray = |index| {
            let [u, v] = numbers.sample_2d(index, 0);
            let direction = uniform_sphere(u, v);
            let is_above = direction.dot(point.geometric_normal) >= 0.0;
            point.spawn_ray(if is_above { direction } else { -direction })
        };
        let rays: Vec<Ray> = (0..self.density.probes).map(ray).collect();
        let mut hits = vec![None; rays.len()];
        let traversal = &mut Traversal::default();
        scene.closest_incoherent(&rays, &mut hits, traversal);
        let seen = rays.iter().zip(&hits);
        let seen: Vec<_> = seen
            .filter_map(|(ray, hit)| Some((ray, hit.as_ref()?)))
            .collect();
        let inverses: f64 = seen.iter().map(|(_, hit)| 1.0 / hit.t).sum();
        let harmonic_mean = f64::from(self.density.probes) / inverses;
        // Under an open sky light changes as slowly as can be.
        let size = scene.bounds().extent().max_element();
        let hits = seen.iter().map(|(ray, hit)| {
            let point = scene.surface::<Only<0>>(ray, hit).point;
            (point, hit.t as f32)
        });
        let mut hits: Vec<(SurfacePoint, f32)> = hits.collect();
        hits.sort_by(|a, b| a.1.total_cmp(&b.1));
        Probe {
            harmonic_mean: (harmonic_mean as f32).min(size),
            hits,
        }
    }
}

impl Probe {
    /// One in four hits, near and far, is enough to know what secondary rays will see.
    fn secondary(&self) -> impl Iterator<Item = Candidate> {
        self.hits.iter().step_by(4).map(|(point, _)| Candidate {
            point: *point,
            least_radius: 0.0,
        })
    }

    /// What a place of this radius at a point does not reach behind.
    fn walls(&self, place: &SurfacePoint, radius: f32) -> OccluderPlanes {
        /// What rays have hit of a wall is mostly nearer elsewhere.
        const REACH: f32 = 3.0;
        /// The cosine between normals of walls that rather go on from the surface than stand on it.
        const ALONG: f32 = 0.8;
        let mut walls = OccluderPlanes::default();
        for (point, distance) in &self.hits {
            if *distance >= REACH * radius {
                break;
            }
            let normal = point.geometric_normal;
            let is_near = (place.position - point.position).dot(normal) < radius;
            if is_near && normal.dot(place.shading_normal) < ALONG {
                walls.add(point.position, normal, *distance);
            }
        }
        walls
    }
}
