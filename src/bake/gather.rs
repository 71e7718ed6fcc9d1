use crate::accel::Traversal;
use crate::integrator::{FinalGather, GatherPoint};
use crate::irradiance_cache::SecondaryIrradiance;
use crate::sampling::Sequence;
use crate::scene::SurfacePoint;
use glam::Vec3;
use rayon::prelude::*;

/// So many points are gathered for together.
const BATCH: usize = 16;

/// What random numbers are for: none are used twice.
#[derive(Clone, Copy, Debug)]
pub(super) enum Purpose {
    Probes,
    SecondaryIrradiance,
    PrimaryIrradiance,
}

/// The random numbers of a point: they depend on where it is, not on when it was found.
pub(super) fn numbers_of(point: &SurfacePoint, seed: u32, purpose: Purpose, left: u32) -> Sequence {
    let [x, y, z] = point.position.to_array().map(f32::to_bits);
    let [nx, ny, nz] = point.shading_normal.to_array().map(f32::to_bits);
    let side = nx ^ ny.rotate_left(11) ^ nz.rotate_left(22);
    let purpose = (purpose as u32) << 8 | left;
    Sequence::new(seed ^ side, purpose ^ x.rotate_left(16), y, z)
}

/// How light is gathered at places.
pub(super) struct Gathering<'a> {
    pub(super) final_gather: &'a FinalGather<'a>,
    /// How many bounces are left there.
    pub(super) left: u32,
    pub(super) paths: u32,
    pub(super) purpose: Purpose,
    pub(super) seed: u32,
}

impl Gathering<'_> {
    /// The light at each point; `done` is told of each.
    pub(super) fn light(
        &self,
        points: &[SurfacePoint],
        known: &SecondaryIrradiance,
        done: &(dyn Fn() + Sync),
    ) -> Vec<Vec3> {
        let of_batch = |points: &[SurfacePoint]| {
            let gather_point = |point: &SurfacePoint| GatherPoint {
                point: *point,
                sequence: numbers_of(point, self.seed, self.purpose, self.left),
                index: 0,
            };
            let points: Vec<GatherPoint> = points.iter().map(gather_point).collect();
            let mut traversal = Traversal::default();
            let light = self.final_gather.gather(
                &points,
                self.left,
                self.paths,
                Some(known),
                &mut traversal,
            );
            points.iter().for_each(|_| done());
            light
        };
        points.par_chunks(BATCH).flat_map_iter(of_batch).collect()
    }
}
