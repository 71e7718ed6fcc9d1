//! Places records where no record covers a surface yet. Radii follow the harmonic mean distance of visible surfaces
//! (Ward et al. 1988) and are limited by those of neighbours (Krivanek et al. 2006, "Making Radiance and Irradiance
//! Caching Practical: Adaptive Caching and Neighbor Clamping"; also Krivanek and Gautron 2009, "Practical Global
//! Illumination with Irradiance Caching").

use super::gather::{RandomStream, sequence_of};
use crate::accel::QueryState;
use crate::irradiance_cache::{IrradianceRecord, IrradianceRecords, OccluderPlanes};
use crate::material::FeatureMask;
use crate::math::Ray;
use crate::sampling::uniform_sphere;
use crate::scene::{Scene, SurfacePoint};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// The largest number of records, which limits memory to some gigabytes. Surfaces that they do not cover are
/// gathered for in each frame.
const MAX_RECORDS: usize = 1 << 21;

/// How densely records are placed.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Spacing {
    /// The radius of a record relative to the harmonic mean distance of the surfaces around it: irradiance
    /// changes in proportion to the inverse of that (Ward et al. 1988).
    pub(super) relative_radius: f32,
    /// The largest distance of a surface point from the nearest record, relative to the radius of the record.
    pub(super) max_distance: f32,
    /// The angle between normals, in radians, up to which a record is valid.
    pub(super) max_angle: f32,
    /// Rays per hemisphere probe.
    pub(super) probe_rays: u32,
}

/// A surface point that a record should cover.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) point: SurfacePoint,
    /// The smallest radius of a record here, in metres.
    pub(super) min_radius: f32,
}

/// Records as they are placed.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Placement {
    spacing: Spacing,
    seed: u32,
    pub(super) records: IrradianceRecords,
    /// The surface point of each record.
    pub(super) points: Vec<SurfacePoint>,
    /// The harmonic mean distance of the surfaces around each record, in metres.
    distances: Vec<f32>,
}

/// The surfaces around a point, found by rays over the hemisphere.
struct Probe {
    /// Harmonic mean of their distances, in metres.
    harmonic_mean: f32,
    /// Hit points and their distances, nearest first.
    hits: Vec<(SurfacePoint, f32)>,
}

impl Placement {
    /// Without records.
    pub(super) fn new(scene: &Scene, spacing: Spacing, seed: u32) -> Placement {
        Placement {
            spacing,
            seed,
            records: IrradianceRecords::new(scene.bounds(), spacing.max_angle),
            points: Vec::new(),
            distances: Vec::new(),
        }
    }

    /// The median over the records of the harmonic mean distance; none without records.
    pub(super) fn median_distance(&self) -> Option<f32> {
        let mut distances = self.distances.clone();
        distances.sort_by(f32::total_cmp);
        distances.get(distances.len() / 2).copied()
    }

    /// The smallest radius of a record; 0 without records.
    pub(super) fn min_radius(&self) -> f32 {
        let radii = (0..self.records.len()).map(|index| self.records[index].radius);
        radii.reduce(f32::min).unwrap_or(0.0)
    }

    fn is_covered(&self, candidate: &Candidate) -> bool {
        let SurfacePoint {
            position,
            shading_normal,
            ..
        } = candidate.point;
        self.records
            .covers(position, shading_normal, self.spacing.max_distance)
    }

    fn uncovered(&self, candidates: &[Candidate]) -> Vec<Candidate> {
        let candidates = candidates.par_iter();
        candidates
            .filter(|c| !self.is_covered(c))
            .copied()
            .collect()
    }

    /// Adds records, in the order of the candidates, until all candidates are covered. Returns candidates for
    /// secondary records: surfaces around the new records.
    ///
    /// Candidates are probed in groups: large enough for all threads, and small enough that few of a group are
    /// covered by another record of it, which wastes their probe.
    pub(super) fn place_until_covered(
        &mut self,
        scene: &Scene,
        candidates: &[Candidate],
    ) -> Vec<Candidate> {
        let mut hits = Vec::new();
        let uncovered = self.uncovered(candidates);
        let mut rest = &uncovered[..];
        while !rest.is_empty() && self.points.len() < MAX_RECORDS {
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

    /// Adds a record.
    ///
    /// Its radius is limited by the nearest surface seen. As the distance of a surface changes from point to point
    /// by no more than the distance of the points, it is also limited by the radii of neighbours, and theirs by it:
    /// so surfaces that some probes miss are found by others (neighbour clamping, Krivanek et al. 2006).
    fn push(&mut self, candidate: &Candidate, probe: &Probe) {
        let relative_radius = self.spacing.relative_radius;
        let SurfacePoint {
            position,
            shading_normal,
            ..
        } = candidate.point;
        let mut neighbours = Vec::new();
        self.records
            .visit(position, shading_normal, 1.0, |index, _| {
                let distance = (self.records[index].position - position).length();
                neighbours.push((index, distance));
            });
        let nearest = probe.hits.first().map_or(f32::INFINITY, |hit| hit.1);
        let mut radius = (relative_radius * probe.harmonic_mean).min(nearest);
        for &(index, distance) in &neighbours {
            radius = radius.min(self.records[index].radius + relative_radius * distance);
        }
        let radius = radius.max(candidate.min_radius);
        for (index, distance) in neighbours {
            self.records
                .shrink(index, radius + relative_radius * distance);
        }
        self.records.push(IrradianceRecord {
            position,
            normal: shading_normal,
            radius,
            occluders: probe.occluders(&candidate.point, radius),
        });
        self.points.push(candidate.point);
        self.distances.push(probe.harmonic_mean);
    }

    /// Probes the hemisphere with uniform directions, not cosine-weighted: surfaces near the horizon matter, too.
    fn probe(&self, scene: &Scene, point: &SurfacePoint) -> Probe {
        let sequence = sequence_of(point, self.seed, RandomStream::Probe, 0);
        let ray = |index| {
            let [u, v] = sequence.sample_2d(index, 0);
            let direction = uniform_sphere(u, v);
            let is_above = direction.dot(point.geometric_normal) >= 0.0;
            point.spawn_ray(if is_above { direction } else { -direction })
        };
        let rays: Vec<Ray> = (0..self.spacing.probe_rays).map(ray).collect();
        let mut hits = vec![None; rays.len()];
        let query_state = &mut QueryState::default();
        scene.closest_incoherent(&rays, &mut hits, query_state);
        let seen = rays.iter().zip(&hits);
        let seen: Vec<_> = seen
            .filter_map(|(ray, hit)| Some((ray, hit.as_ref()?)))
            .collect();
        let inverses: f64 = seen.iter().map(|(_, hit)| 1.0 / hit.t).sum();
        let harmonic_mean = f64::from(self.spacing.probe_rays) / inverses;
        // Infinite if all rays leave the scene.
        let size = scene.bounds().extent().max_element();
        let hits = seen.iter().map(|(ray, hit)| {
            let point = scene.surface::<FeatureMask<0>>(ray, hit).point;
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
    /// Candidates for secondary records: one in four hits, at all distances, samples well enough what gathered rays
    /// will hit.
    fn secondary(&self) -> impl Iterator<Item = Candidate> {
        self.hits.iter().step_by(4).map(|(point, _)| Candidate {
            point: *point,
            min_radius: 0.0,
        })
    }

    /// The planes of the surfaces that a record of this radius at a point must not reach behind.
    fn occluders(&self, record: &SurfacePoint, radius: f32) -> OccluderPlanes {
        /// Hits up to this distance, in radii, count: most parts of a surface are nearer than the hit.
        const MAX_DISTANCE: f32 = 3.0;
        /// Surfaces whose normals differ by a smaller angle (its cosine) continue the record's own surface.
        const MAX_COSINE: f32 = 0.8;
        let mut occluders = OccluderPlanes::default();
        for (point, distance) in &self.hits {
            if *distance >= MAX_DISTANCE * radius {
                break;
            }
            let normal = point.geometric_normal;
            let is_near = (record.position - point.position).dot(normal) < radius;
            if is_near && normal.dot(record.shading_normal) < MAX_COSINE {
                occluders.add(point.position, normal, *distance);
            }
        }
        occluders
    }
}
