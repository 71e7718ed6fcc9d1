//! Gathers the values of records: a final gather at each of them.

use crate::accel::QueryState;
use crate::integrator::{FinalGather, GatherPaths, GatherPoint};
use crate::irradiance_cache::SecondaryIrradiance;
use crate::sampling::SobolSequence;
use crate::scene::SurfacePoint;
use glam::Vec3;
use rayon::prelude::*;

/// Points that are gathered for together.
const BATCH: usize = 16;

/// What samples are for. Samples of different purposes are independent.
#[derive(Clone, Copy, Debug)]
pub(super) enum RandomStream {
    Probe,
    Secondary,
    Primary,
}

/// The samples of a point. They depend on its position and normal, not on when it was found.
pub(super) fn sequence_of(
    point: &SurfacePoint,
    seed: u32,
    stream: RandomStream,
    bounces_left: u32,
) -> SobolSequence {
    let [x, y, z] = point.position.to_array().map(f32::to_bits);
    let [nx, ny, nz] = point.shading_normal.to_array().map(f32::to_bits);
    let side = nx ^ ny.rotate_left(11) ^ nz.rotate_left(22);
    let stream = (stream as u32) << 8 | bounces_left;
    SobolSequence::new(seed ^ side, stream ^ x.rotate_left(16), y, z)
}

/// How the values of records are gathered.
pub(super) struct GatherPass<'a> {
    pub(super) final_gather: &'a FinalGather<'a>,
    /// How many bounces are left at the records, at least one.
    pub(super) bounces_left: u32,
    /// Paths per record.
    pub(super) paths: u32,
    pub(super) stream: RandomStream,
    pub(super) seed: u32,
}

impl GatherPass<'_> {
    /// Mean incident radiance at each point, E / π in W/(sr m²). Paths end at the first hit that the secondary
    /// records cover. `on_point` is called once per finished point.
    pub(super) fn mean_radiance(
        &self,
        points: &[SurfacePoint],
        secondary: &SecondaryIrradiance,
        on_point: &(dyn Fn() + Sync),
    ) -> Vec<Vec3> {
        let of_batch = |points: &[SurfacePoint]| {
            let gather_point = |point: &SurfacePoint| GatherPoint {
                point: *point,
                sequence: sequence_of(point, self.seed, self.stream, self.bounces_left),
                index: 0,
            };
            let points: Vec<GatherPoint> = points.iter().map(gather_point).collect();
            let mut query_state = QueryState::default();
            let mean_radiance = self.final_gather.gather(
                &points,
                GatherPaths {
                    bounces_left: self.bounces_left,
                    count: self.paths,
                    // What a camera sees gets that by shadow rays.
                    include_sky: matches!(self.stream, RandomStream::Secondary),
                },
                Some(secondary),
                &mut query_state,
            );
            points.iter().for_each(|_| on_point());
            mean_radiance
        };
        points.par_chunks(BATCH).flat_map_iter(of_batch).collect()
    }
}
