//! Indirect diffuse light from the irradiance cache.

use super::cached_light::CachedLight;
use super::camera_sample::CameraSample;
use super::cell_light::CellLight;
use super::cell_place::sight_ray;
use super::final_gather::{FinalGather, GatherPaths, GatherPoint, gather_for};
use super::hit_surfaces::ambient;
use super::secondary_light::SecondaryLight;
use super::whitted::Wavefront;
use crate::accel::QueryState;
use crate::irradiance_cache::{CellKey, IrradianceCache};
use crate::material::Features;
use crate::math::Ray;
use crate::scene::{Scene, SurfaceInteraction};
use glam::Vec3;

/// Paths of a final gather: few points need one, and every camera sample has its own.
const GATHER_PATHS: u32 = 16;

/// Sizes of cells where no record is valid, each half the last.
const SIZES: i32 = 3;

/// The random numbers that choose between these.
const DIMENSION: u32 = 1 << 17;

/// The indirect light of camera samples, from a cache.
pub(super) struct CachedIrradiance<'a> {
    pub(super) cache: &'a IrradianceCache,
    pub(super) final_gather: &'a FinalGather<'a>,
    pub(super) samples: &'a [CameraSample],
}

impl CachedIrradiance<'_> {
    /// The cosine-weighted mean radiance that arrives at each diffuse surface of a wavefront; black at others.
    pub(super) fn indirect<F: Features>(
        &self,
        wavefront: &Wavefront,
        query_state: &mut QueryState,
    ) -> Vec<Vec3> {
        let bounces_left = wavefront.bounces_left;
        if bounces_left == 0 {
            return vec![ambient(self.final_gather.scene()); wavefront.surfaces.len()];
        }
        let has_diffuse = |surface: &&SurfaceInteraction| surface.bsdf.has_diffuse::<F>();
        let surface = |index: usize| wavefront.surfaces[index].as_ref().filter(has_diffuse);
        let count = wavefront.surfaces.len();
        let (mut indices, mut points) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for index in 0..count {
            if let Some(SurfaceInteraction { point, .. }) = surface(index) {
                indices.push(index);
                points.push(point);
            }
        }
        let scene = self.final_gather.scene();
        let primary = &self.cache.primary[bounces_left as usize - 1];
        let mut indirect = vec![Vec3::ZERO; count];
        let mut missed = Vec::new();
        let places: Vec<(Vec3, Vec3)> = points
            .iter()
            .map(|point| (point.position, point.shading_normal))
            .collect();
        let blocked = |pairs: &[(u32, Vec3)]| {
            let sight = |&(number, eye): &(u32, Vec3)| sight_ray(points[number as usize], eye);
            occluded_or_none(scene, pairs.iter().map(sight), query_state)
        };
        let found = primary.mean_radiance(&places, scene.kernel(), blocked);
        for (index, light) in indices.into_iter().zip(found) {
            match light {
                Some(light) => indirect[index] = light,
                None => missed.push(index),
            }
        }
        for index in missed {
            let sample = &self.samples[wavefront.samples[index]];
            if let Some(surface) = surface(index) {
                let nearby_radius = primary.records.smallest_near(surface.point.position);
                let place = GatherPoint {
                    point: surface.point,
                    sequence: sample.sequence,
                    index: sample.index,
                };
                indirect[index] =
                    self.uncovered::<F>(&place, nearby_radius, bounces_left, query_state);
            }
        }
        indirect
    }

    /// The cosine-weighted mean radiance that arrives at a point where no primary record is valid: that of its cell, about as
    /// small as records are there, or smaller; if that is not valid either, gathered for this point alone.
    fn uncovered<F: Features>(
        &self,
        place: &GatherPoint,
        nearby_radius: Option<f32>,
        bounces_left: u32,
        query_state: &mut QueryState,
    ) -> Vec3 {
        let (final_gather, cells) = (self.final_gather, &*self.cache.uncovered);
        let secondary = SecondaryLight::<F>::new(final_gather, &self.cache.secondary);
        let light = CellLight {
            final_gather,
            cells,
            only_free: false,
            include_sky: false,
        };
        let normal = place.point.shading_normal;
        let largest = i32::from(cells.settings().level);
        let largest = nearby_radius.map_or(largest, |r| largest.min(CellKey::level_of_side(r)));
        let numbers = place.sequence.sample_2d(place.index, DIMENSION);
        for below in 0..SIZES {
            let cell_at = |position: Vec3| match below {
                0 => CellKey::containing(position, normal, largest),
                _ => CellKey::narrow(position, normal, largest - below),
            };
            let (point, ends) = (&place.point, &secondary);
            let value =
                light.value_around::<F>(point, cell_at, bounces_left, numbers, ends, query_state);
            if let Some(value) = value {
                return value;
            }
        }
        let paths = GatherPaths {
            bounces_left,
            count: GATHER_PATHS,
            include_sky: false,
        };
        let ends: &dyn CachedLight = &secondary;
        gather_for::<F>(final_gather, &[*place], paths, Some(ends), query_state)[0]
    }
}

/// The mask of up to sixteen coherent rays that are occluded, or are none.
fn occluded_or_none(
    scene: &Scene,
    rays: impl Iterator<Item = Option<Ray>>,
    query_state: &mut QueryState,
) -> u32 {
    let traced = (0..).zip(rays);
    let traced = traced.filter_map(|(lane, ray): (u32, _)| Some((lane, ray?)));
    let (lanes, traced): (Vec<u32>, Vec<Ray>) = traced.unzip();
    let mut blocked = u32::MAX;
    if !traced.is_empty() {
        let occluded = scene.occluded_mask(&traced, query_state);
        for (bit, lane) in lanes.into_iter().enumerate() {
            blocked &= !((!occluded >> bit & 1) << lane);
        }
    }
    blocked
}
