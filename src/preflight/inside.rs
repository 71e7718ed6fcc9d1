//! Whether the camera is inside a solid object or in a room, from rays in all directions.

use crate::accel::QueryState;
use crate::camera::{Camera, FrameCameras};
use crate::geometry::Hit;
use crate::math::Ray;
use crate::sampling::uniform_sphere;
use crate::scene::Scene;
use glam::Vec3;
use std::ops::Range;

/// The square root of the number of directions of a probe.
const DIRECTIONS: usize = 8;

/// The least fraction of directions in which the same side of surfaces is seen from inside a solid. Not all of them, as
/// statues may be open at their feet.
const NEARLY_ALL: f64 = 0.8;

/// The least fraction of directions with fronts behind backs that shows a solid among other surfaces.
const MIN_FRONTS_BEHIND: f64 = 0.65;

/// The mean distance of surfaces, in metres, below which the camera is in a solid, not in a room. A house whose walls
/// face outward, under a sky that faces inward, is told from a solid by nothing else.
const NARROW: f64 = 1.0;

/// What rays in all directions from a camera hit.
pub(super) struct Probe {
    /// The fraction of directions in which the front of a surface is seen.
    fronts: f64,
    /// The fraction of directions in which the back of a surface is seen.
    backs: f64,
    /// The fraction of directions in which the first surface is seen from the back and the next from the front.
    fronts_behind_backs: f64,
    /// The harmonic mean of the distances of surfaces, in metres.
    mean_distance: f64,
}

impl Probe {
    pub(super) fn new(scene: &Scene, camera: &Camera) -> Probe {
        let eye = eye(scene, camera);
        let at = |i: usize| (i as f32 + 0.5) / DIRECTIONS as f32;
        let rays: Vec<Ray> = (0..DIRECTIONS * DIRECTIONS)
            .map(|i| uniform_sphere(at(i % DIRECTIONS), at(i / DIRECTIONS)))
            .map(|direction| Ray::new(eye, direction))
            .collect();
        let hits = cast(scene, &rays);
        let (fronts, backs): (Vec<&ProbeHit>, _) = hits.iter().partition(|hit| hit.is_front);
        let behind: Vec<Ray> = backs.iter().map(|hit| hit.onward).collect();
        let behind = cast(scene, &behind);
        let inverses: f64 = hits.iter().map(|hit| 1.0 / hit.distance).sum();
        let count = rays.len() as f64;
        Probe {
            fronts: fronts.len() as f64 / count,
            backs: backs.len() as f64 / count,
            fronts_behind_backs: behind.iter().filter(|hit| hit.is_front).count() as f64 / count,
            mean_distance: count / inverses,
        }
    }
}

/// What a ray of a probe hits.
struct ProbeHit {
    /// In metres.
    distance: f64,
    is_front: bool,
    /// The ray that continues behind the surface.
    onward: Ray,
}

/// What rays hit, without those that hit nothing.
fn cast(scene: &Scene, rays: &[Ray]) -> Vec<ProbeHit> {
    /// Where the onward ray starts, relative to the distance: beyond its rounding.
    const BEHIND: f64 = 1.0 + 1e-4;
    let mut hits = vec![None; rays.len()];
    scene.closest_incoherent(rays, &mut hits, &mut QueryState::default());
    let probe_hit = |(ray, hit): (&Ray, Option<Hit>)| {
        let hit = hit?;
        Some(ProbeHit {
            distance: hit.t,
            is_front: scene.is_front(ray, &hit),
            onward: Ray::new(ray.at(BEHIND * hit.t).as_vec3(), ray.direction),
        })
    };
    rays.iter().zip(hits).filter_map(probe_hit).collect()
}

/// Frames between crossings of surfaces.
struct Interval {
    frames: Range<usize>,
    /// The number of solids that contain the camera, relative to the first frame of the shot, if faces point outward.
    depth: i32,
    /// The greatest mean distance of surfaces.
    mean_distance: f64,
}

/// The frames in which the camera is inside a solid object, from the probe of each frame and the change of depth over
/// the step to the next frame, if that crosses a surface.
///
/// Inside a solid the camera sees the same side of surfaces all around, but so it does in a room. The spaces beyond the
/// surfaces that it crosses distinguish them. A solid whose faces point outward shows their backs inside, and is mostly
/// narrower than its surroundings. If it is much narrower, and the camera is outside for longer, its faces may as well
/// point inward.
///
/// Where the camera cuts in and out, or never leaves, it is inside if it sees nothing but backs, and either backs are
/// rare on the rest of the path, or the space is narrow and fronts are behind the backs.
pub(super) fn frames_inside(
    frames: &FrameCameras,
    probes: &[Probe],
    crossings: &[Option<i32>],
) -> Vec<usize> {
    let without_backs = probes.iter().filter(|probe| probe.backs < 0.5).count();
    let backs_are_rare = 2 * without_backs > probes.len();
    let mut inside = Vec::new();
    for shot in frames.shots() {
        let sees_backs = |frame: &usize| probes[*frame].backs >= NEARLY_ALL;
        let is_narrow = |probe: &Probe| {
            probe.fronts_behind_backs >= MIN_FRONTS_BEHIND && probe.mean_distance < NARROW
        };
        let is_in_solid =
            |frame: usize| sees_backs(&frame) && (backs_are_rare || is_narrow(&probes[frame]));
        if shot.clone().all(is_in_solid) {
            inside.extend(shot);
            continue;
        }
        let intervals = intervals(shot, probes, crossings);
        for (i, interval) in intervals.iter().enumerate() {
            let beside = [i.wrapping_sub(1), i + 1].map(|i| intervals.get(i));
            let any_beside = |is_outside: fn(&Interval, &Interval) -> bool| {
                beside
                    .into_iter()
                    .flatten()
                    .any(|beside| is_outside(beside, interval))
            };
            let outward = any_beside(|outside, solid| {
                outside.depth < solid.depth && 2.0 * outside.mean_distance > solid.mean_distance
            });
            let inward = any_beside(|outside, solid| {
                outside.depth > solid.depth
                    && outside.mean_distance > 2.0 * solid.mean_distance
                    && outside.frames.len() > solid.frames.len()
            });
            inside.extend(interval.frames.clone().filter(|frame| {
                outward && sees_backs(frame) || inward && probes[*frame].fronts >= NEARLY_ALL
            }));
        }
    }
    inside
}

fn intervals(shot: Range<usize>, probes: &[Probe], crossings: &[Option<i32>]) -> Vec<Interval> {
    let mut intervals: Vec<Interval> = Vec::new();
    let mut depth = 0;
    for frame in shot {
        let mean_distance = probes[frame].mean_distance;
        match intervals.last_mut() {
            Some(interval) if interval.depth == depth => {
                interval.frames.end = frame + 1;
                interval.mean_distance = interval.mean_distance.max(mean_distance);
            }
            _ => intervals.push(Interval {
                frames: frame..frame + 1,
                depth,
                mean_distance,
            }),
        }
        depth += crossings[frame].unwrap_or(0);
    }
    intervals
}

/// The origin of the rays of a camera.
pub(super) fn eye(scene: &Scene, camera: &Camera) -> Vec3 {
    (camera.position - scene.origin).as_vec3()
}
