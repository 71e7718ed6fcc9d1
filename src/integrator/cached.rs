//! Indirect diffuse light from the irradiance cache, with a final gather where no record is near.

use super::camera_sample::CameraSample;
use super::final_gather::{FinalGather, GatherPaths, GatherPoint};
use super::hit_surfaces::ambient;
use super::secondary_light::gather_cached;
use super::whitted::Wavefront;
use crate::accel::QueryState;
use crate::irradiance_cache::IrradianceCache;
use crate::material::Features;
use crate::scene::{SurfaceInteraction, SurfacePointPacket};
use glam::Vec3;

/// Paths of a final gather: few points need one, and every camera sample has its own.
const GATHER_PATHS: u32 = 16;

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
        if wavefront.bounces_left == 0 {
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
        let primary = &self.cache.primary[wavefront.bounces_left as usize - 1];
        let mut indirect = vec![Vec3::ZERO; count];
        let mut missed = Vec::new();
        let places: Vec<(Vec3, Vec3)> = points
            .iter()
            .map(|point| (point.position, point.shading_normal))
            .collect();
        let blocked = |numbers: &[u32], eye: Vec3| {
            let mut packet = SurfacePointPacket::default();
            for &number in numbers {
                packet.push(points[number as usize]);
            }
            let shadow_rays = scene.shadow_rays_to(&packet, eye);
            scene.occluded_coherent(&shadow_rays, query_state) | !shadow_rays.facing()
        };
        let found = primary.mean_radiance(&places, scene.kernel(), blocked);
        for (index, light) in indices.into_iter().zip(found) {
            match light {
                Some(light) => indirect[index] = light,
                None => missed.push(index),
            }
        }
        if missed.is_empty() {
            return indirect;
        }
        let point = |&index: &usize| {
            let sample = &self.samples[wavefront.samples[index]];
            Some(GatherPoint {
                point: surface(index)?.point,
                sequence: sample.sequence,
                index: sample.index,
            })
        };
        let points: Vec<GatherPoint> = missed.iter().filter_map(point).collect();
        let gathered = gather_cached::<F>(
            self.final_gather,
            &points,
            GatherPaths {
                bounces_left: wavefront.bounces_left,
                count: GATHER_PATHS,
                include_sky: false,
            },
            &self.cache.secondary,
            query_state,
        );
        for (index, light) in missed.into_iter().zip(gathered) {
            indirect[index] = light;
        }
        indirect
    }
}
