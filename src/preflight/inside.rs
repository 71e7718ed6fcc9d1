//! Whether the camera is in a body, or in a room.

use super::flight::Flight;
use crate::accel::Traversal;
use crate::camera::Camera;
use crate::geometry::Hit;
use crate::math::Ray;
use crate::sampling::uniform_sphere;
use crate::scene::Scene;
use glam::Vec3;
use std::ops::Range;

/// The directions in which a camera looks around are the square of this.
const DIRECTIONS: usize = 8;

/// A camera inside a body sees surfaces from one side in so many of all directions, or more. Statues may be open
/// at their feet.
const NEARLY_ALL: f64 = 0.8;

/// So many of all directions are most of them.
const MOST: f64 = 0.65;

/// Nobody means to walk with so little room, in metres: a house's walls may face outward, and a sky around it inward.
const NARROW: f64 = 1.0;

/// What there is all around a camera.
pub(super) struct Sight {
    /// In what share of all directions it sees the front of a surface.
    fronts: f64,
    /// The same of backs.
    backs: f64,
    /// In what share of all directions the front of another surface is behind the first if that shows its back.
    fronts_behind_backs: f64,
    /// The harmonic mean of the distances of surfaces, in metres.
    room: f64,
}

impl Sight {
    /// In the picture and all beside it.
    pub(super) fn new(scene: &Scene, camera: &Camera) -> Sight {
        let eye = eye(scene, camera);
        let at = |i: usize| (i as f32 + 0.5) / DIRECTIONS as f32;
        let rays: Vec<Ray> = (0..DIRECTIONS * DIRECTIONS)
            .map(|i| uniform_sphere(at(i % DIRECTIONS), at(i / DIRECTIONS)))
            .map(|direction| Ray::new(eye, direction))
            .collect();
        let met = meet(scene, &rays);
        let (fronts, backs): (Vec<&Met>, _) = met.iter().partition(|met| met.is_front);
        let behind: Vec<Ray> = backs.iter().map(|met| met.onward).collect();
        let behind = meet(scene, &behind);
        let inverses: f64 = met.iter().map(|met| 1.0 / met.distance).sum();
        let count = rays.len() as f64;
        Sight {
            fronts: fronts.len() as f64 / count,
            backs: backs.len() as f64 / count,
            fronts_behind_backs: behind.iter().filter(|met| met.is_front).count() as f64 / count,
            room: count / inverses,
        }
    }
}

/// What a ray meets.
struct Met {
    /// In metres.
    distance: f64,
    is_front: bool,
    /// What goes on behind it.
    onward: Ray,
}

/// What some rays meet, without those that meet nothing.
fn meet(scene: &Scene, rays: &[Ray]) -> Vec<Met> {
    // Of the distance: more than it is rounded by.
    const BEHIND: f64 = 1.0 + 1e-4;
    let mut hits = vec![None; rays.len()];
    scene.closest_incoherent(rays, &mut hits, &mut Traversal::default());
    let met = |(ray, hit): (&Ray, Option<Hit>)| {
        let hit = hit?;
        Some(Met {
            distance: hit.t,
            is_front: scene.is_front(ray, &hit),
            onward: Ray::new(ray.at(BEHIND * hit.t).as_vec3(), ray.direction),
        })
    };
    rays.iter().zip(hits).filter_map(met).collect()
}

/// Frames between passages through surfaces.
struct Stay {
    frames: Range<usize>,
    /// In how many more bodies than in the first frame of the shot, if their faces look outward.
    depth: i32,
    /// The most room that there is.
    room: f64,
}

/// The frames in which the camera is inside a body, given what there is around it in each frame and in how many more
/// bodies it is after the step to the next, if there is a surface on the way.
///
/// There it sees the same side of surfaces all around, but so it does in a room. What tells them apart is what is
/// beyond the surfaces through which it came or goes. A body whose faces look outward shows their backs inside,
/// and is mostly narrower than what it stands in. If it is much narrower, and the camera is outside for longer, its
/// faces may as well look inward.
///
/// Where the camera jumps in and out, or stays, it is inside if it sees nothing but backs, and either few elsewhere
/// on the path or, with little room, the right side of what is behind them.
pub(super) fn frames_inside(
    flight: &Flight,
    sights: &[Sight],
    passages: &[Option<i32>],
) -> Vec<usize> {
    let others = sights.iter().filter(|sight| sight.backs < 0.5).count();
    let sees_backs_seldom = 2 * others > sights.len();
    let mut inside = Vec::new();
    for shot in flight.shots() {
        let sees_backs = |frame: &usize| sights[*frame].backs >= NEARLY_ALL;
        let is_stuck = |sight: &Sight| sight.fronts_behind_backs >= MOST && sight.room < NARROW;
        let faces_outward =
            |frame: usize| sees_backs(&frame) && (sees_backs_seldom || is_stuck(&sights[frame]));
        if shot.clone().all(faces_outward) {
            inside.extend(shot);
            continue;
        }
        let stays = stays(shot, sights, passages);
        for (i, stay) in stays.iter().enumerate() {
            let beyond = [i.wrapping_sub(1), i + 1].map(|i| stays.get(i));
            let is_in = |than: fn(&Stay, &Stay) -> bool| {
                beyond
                    .into_iter()
                    .flatten()
                    .any(|beyond| than(beyond, stay))
            };
            let outward = is_in(|out, own| out.depth < own.depth && 2.0 * out.room > own.room);
            let inward = is_in(|out, own| {
                out.depth > own.depth
                    && out.room > 2.0 * own.room
                    && out.frames.len() > own.frames.len()
            });
            inside.extend(stay.frames.clone().filter(|frame| {
                outward && sees_backs(frame) || inward && sights[*frame].fronts >= NEARLY_ALL
            }));
        }
    }
    inside
}

fn stays(shot: Range<usize>, sights: &[Sight], passages: &[Option<i32>]) -> Vec<Stay> {
    let mut stays: Vec<Stay> = Vec::new();
    let mut depth = 0;
    for frame in shot {
        let room = sights[frame].room;
        match stays.last_mut() {
            Some(stay) if stay.depth == depth => {
                stay.frames.end = frame + 1;
                stay.room = stay.room.max(room);
            }
            _ => stays.push(Stay {
                frames: frame..frame + 1,
                depth,
                room,
            }),
        }
        depth += passages[frame].unwrap_or(0);
    }
    stays
}

/// Where rays of a camera start.
pub(super) fn eye(scene: &Scene, camera: &Camera) -> Vec3 {
    (camera.position - scene.origin).as_vec3()
}
