//! The part of the world that a plot shows.

use super::motion::Motion;
use super::view::View;
use crate::accel::QueryState;
use crate::math::Ray;
use crate::scene::Scene;
use glam::{DVec2, DVec3};

/// The margin around the path within which the scene is shown, relative to its reach; more would make the path too
/// small.
const SURROUNDINGS: f64 = 2.5;

/// The number of frames whose view rays are cast.
const VIEW_RAYS: u32 = 64;

/// The length of view frustums, relative to the longest side of the part that is shown.
const FRUSTUM_LENGTH: f64 = 0.08;

/// The part of the world that is shown.
#[derive(Clone, Debug)]
pub(super) struct Region {
    /// All of it, with a margin.
    pub(super) shown: Cuboid,
    /// The camera's positions.
    pub(super) path: Cuboid,
    /// The length of view frustums, in metres.
    pub(super) frustum_length: f64,
    /// The view of the elevation.
    pub(super) elevation: View,
}

/// An axis-aligned box in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cuboid {
    pub(super) min: DVec3,
    pub(super) max: DVec3,
}

impl Cuboid {
    pub(super) fn around(points: impl IntoIterator<Item = DVec3>) -> Cuboid {
        let mut cuboid = Cuboid {
            min: DVec3::INFINITY,
            max: DVec3::NEG_INFINITY,
        };
        for point in points {
            cuboid.min = cuboid.min.min(point);
            cuboid.max = cuboid.max.max(point);
        }
        cuboid
    }

    pub(super) fn size(&self) -> DVec3 {
        self.max - self.min
    }

    fn grown(&self, margin: f64) -> Cuboid {
        Cuboid {
            min: self.min - margin,
            max: self.max + margin,
        }
    }

    /// The intersection; none if they are disjoint.
    fn intersection(&self, other: &Cuboid) -> Option<Cuboid> {
        let common = Cuboid {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        };
        common.min.cmple(common.max).all().then_some(common)
    }
}

impl Region {
    /// The path, and the scene within a few times its reach: its extent, or the median distance of what the camera
    /// looks at.
    pub(super) fn of(scene: &Scene, motion: &Motion) -> Region {
        let path = Cuboid::around(motion.cameras.iter().map(|camera| camera.position));
        let mut hits = view_hits(scene, motion);
        hits.sort_by(|a, b| a.1.total_cmp(&b.1));
        let distance = hits.get(hits.len() / 2).map_or(0.0, |hit| hit.1);
        // Below this the labels of the axes would be equal.
        let finest = 1e-6 * path.min.abs().max(path.max.abs()).max_element();
        let reach = path.size().max_element().max(distance).max(finest);
        let reach = if reach > 0.0 { reach } else { 1.0 };

        let bounds = scene.bounds();
        let scene = Cuboid {
            min: scene.origin + bounds.min.as_dvec3(),
            max: scene.origin + bounds.max.as_dvec3(),
        };
        let near = scene
            .intersection(&path.grown(SURROUNDINGS * reach))
            .unwrap_or(path);
        let side = Cuboid::around([path.min, path.max, near.min, near.max]).size();
        let frustum_length = FRUSTUM_LENGTH * side.max_element().max(reach);
        // View frustums at the ends of the path fit.
        let (path_shown, near) = (
            path.grown(1.1 * frustum_length),
            near.grown(0.3 * frustum_length),
        );
        let shown = Cuboid::around([path_shown.min, path_shown.max, near.min, near.max]);

        let looked_at = hits.iter().map(|hit| hit.0);
        let of_interest = Cuboid::around(looked_at.chain([path.min, path.max])).size();
        let elevation = if of_interest.x > of_interest.z {
            View::ELEVATION_OF_X
        } else {
            View::ELEVATION_OF_Z
        };
        Region {
            shown,
            path,
            frustum_length,
            elevation,
        }
    }

    /// The depth of the cutting plane of a view: just in front of the path.
    pub(super) fn cut(&self, view: &View) -> f64 {
        let nearest = self
            .path
            .min
            .dot(view.forward)
            .min(self.path.max.dot(view.forward));
        nearest - 0.1 * self.frustum_length
    }
}

/// The hits of the rays through the middles of some frames: points and distances.
fn view_hits(scene: &Scene, motion: &Motion) -> Vec<(DVec3, f64)> {
    let film = DVec2::ONE;
    let ray = |frame| {
        motion
            .camera(frame)
            .rays(film, scene.origin)
            .through(0.5 * film)
    };
    let rays: Vec<Ray> = motion
        .timeline
        .spread(VIEW_RAYS)
        .into_iter()
        .map(ray)
        .collect();
    let mut hits = vec![None; rays.len()];
    scene.closest_incoherent(&rays, &mut hits, &mut QueryState::default());
    let pairs = rays.iter().zip(hits);
    let points =
        pairs.filter_map(|(ray, hit)| hit.map(|hit| (scene.origin + ray.at(hit.t), hit.t)));
    points.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{
        CameraPath, CameraPathTiming, Interpolation, Keyframe, Orientation, Segment,
    };
    use crate::geometry::Sphere;
    use crate::material::Material;
    use crate::scene::SceneBuilder;
    use glam::Vec3;

    fn region(spheres: &[(DVec3, f64)], ends: [DVec3; 2]) -> Region {
        let builder = SceneBuilder {
            materials: vec![Material::lambert(Vec3::ONE)],
            spheres: spheres
                .iter()
                .map(|&(center, radius)| (Sphere::new(center, radius), 0))
                .collect(),
            ..SceneBuilder::default()
        };
        // Looks along -z.
        let key = |(time, position): (f64, DVec3)| Keyframe {
            time,
            position,
            orientation: Orientation::Rotation(glam::DQuat::IDENTITY),
            field_of_view: 1.0,
            segment: Segment::of(Interpolation::Linear),
        };
        let keys = [(0.0, ends[0]), (1.0, ends[1])].map(key);
        let path = CameraPath::new(10.0, &keys, &CameraPathTiming::BY_KEYS).expect("two keys");
        Region::of(&builder.build().0, &Motion::of(&path, 1.0))
    }

    fn holds(region: &Region, point: DVec3) -> bool {
        let Cuboid { min, max } = region.shown;
        min.cmplt(point).all() && point.cmplt(max).all()
    }

    #[test]
    fn what_the_camera_looks_at_is_shown_and_what_is_far_away_is_not() {
        // A standing camera 10 m before a ball, on a globe.
        let globe = (DVec3::new(0.0, -6e6, 0.0), 6e6 - 2.0);
        let ball = (DVec3::new(0.0, 0.0, -11.0), 1.0);
        let seen = region(&[globe, ball], [DVec3::ZERO; 2]);
        assert!(holds(&seen, DVec3::ZERO) && holds(&seen, ball.0 - 1.0));
        assert!(seen.shown.size().max_element() < 100.0);
        assert_eq!(seen.elevation, View::ELEVATION_OF_Z);
        // One that goes 4 m aside, with the ball behind it and out of sight, far away.
        let behind = (DVec3::new(0.0, 0.0, 100.0), 1.0);
        let alone = region(&[behind], [DVec3::ZERO, 4.0 * DVec3::X]);
        assert!(!holds(&alone, behind.0));
        assert!(holds(&alone, DVec3::ZERO) && holds(&alone, 4.0 * DVec3::X));
        assert!(alone.shown.size().max_element() < 6.0);
        assert_eq!(alone.elevation, View::ELEVATION_OF_X);
    }

    #[test]
    fn views_are_cut_just_before_the_nearest_camera() {
        let ends = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(5.0, 4.0, -3.0)];
        let region = region(&[], ends);
        for (view, nearest) in [
            (View::PLAN, -4.0),
            (View::ELEVATION_OF_X, -3.0),
            (View::ELEVATION_OF_Z, 1.0),
        ] {
            let cut = region.cut(&view);
            assert!(cut < nearest && nearest - cut < 0.1, "{cut}");
        }
    }

    #[test]
    fn a_standing_camera_in_nothing_has_room_around() {
        for at in [DVec3::ZERO, DVec3::splat(1e6)] {
            let region = region(&[], [at; 2]);
            assert!(holds(&region, at) && region.frustum_length > 0.0);
            let sides = region.shown.size() / at.abs().max_element().max(1.0);
            assert!(sides.min_element() > 1e-8);
        }
    }
}
