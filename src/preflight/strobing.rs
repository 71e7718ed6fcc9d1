//! Strobing: image motion too fast for the frame rate.

use super::steps::measure_steps;
use super::warning::Measured;
use super::{PathWarning, WarningKind};
use crate::accel::QueryState;
use crate::camera::{Camera, FrameCameras};
use crate::math::Ray;
use crate::scene::Scene;
use glam::DVec2;

/// Columns and rows of the grid of image points whose motion is measured.
const POINTS: [usize; 2] = [16, 9];

/// The least number of frames in which the image may move by its own width: 3 s at 24 frames per second. The
/// cinematographers' rule for pans is 7 s, with a 180 degree shutter. Without motion blur single frames become visible
/// below half of that.
const MIN_FRAMES: f64 = 72.0;

pub(super) fn find(scene: &Scene, frames: &FrameCameras, size: DVec2) -> Vec<PathWarning> {
    let limit = size.x / MIN_FRAMES;
    let moved = measure_steps(frames, |from, to| movement(scene, from, to, size));
    let found: Vec<Measured> = (moved.into_iter().enumerate())
        .filter_map(|(frame, pixels)| Some((frame, pixels?)))
        .filter(|(_, pixels)| *pixels > limit)
        .collect();
    let warning = PathWarning::of(&found, |frame, pixels| WarningKind::Strobing {
        frame,
        pixels,
        width: size.x,
        seconds: size.x / (pixels * frames.fps),
        least_seconds: MIN_FRAMES / frames.fps,
    });
    warning.into_iter().collect()
}

/// The median image motion from a frame to the next in pixels, at most the width of the image.
fn movement(scene: &Scene, from: &Camera, to: &Camera, size: DVec2) -> f64 {
    let rays = from.rays(size, scene.origin);
    let [columns, rows] = POINTS;
    let points: Vec<DVec2> = (0..columns * rows)
        .map(|i| DVec2::new((i % columns) as f64 + 0.5, (i / columns) as f64 + 0.5))
        .map(|point| point / DVec2::new(columns as f64, rows as f64) * size)
        .collect();
    let rays: Vec<Ray> = points.iter().map(|point| rays.through(*point)).collect();
    let mut hits = vec![None; rays.len()];
    scene.closest_incoherent(&rays, &mut hits, &mut QueryState::default());
    let seen = points.iter().zip(&rays).zip(&hits);
    let mut moved: Vec<f64> = seen
        .map(|((image_point, ray), hit)| {
            let world_point = match hit {
                Some(hit) => scene.origin + ray.at(hit.t),
                // The background is infinitely far away: only rotation moves it.
                None => to.position + ray.direction.as_dvec3(),
            };
            let next = to.project(size, world_point);
            next.map_or(size.x, |next| next.distance(*image_point).min(size.x))
        })
        .collect();
    moved.sort_unstable_by(f64::total_cmp);
    moved[moved.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{FPS, hall, open_shot, path, scene, still, walk};
    use super::*;
    use crate::camera::Interpolation;
    use glam::DVec3;

    const SIZE: DVec2 = DVec2::new(1280.0, 720.0);

    #[test]
    fn a_wall_moves_in_the_image_by_the_step_of_the_camera() {
        // 5 m in front of the camera the image is 8.29 m wide.
        let wall = scene(vec![hall()], &[]);
        let at = |x: f64| still(DVec3::new(x, 2.0, 0.0), DVec3::NEG_Z);
        let pixel = 2.0 * at(0.0).half_height * 5.0 / SIZE.y;
        // The narrow view shows nothing but that wall.
        let narrow = |x: f64| Camera {
            half_height: 0.2,
            ..at(x)
        };
        let pixels = movement(&wall, &narrow(0.0), &narrow(0.03), SIZE);
        let expected = 0.03 * SIZE.y / (2.0 * 0.2 * 5.0);
        assert!((pixels - expected).abs() < 1e-3, "{pixels}");
        // The background does not move.
        let nothing = scene(vec![], &[]);
        let pixels = movement(&nothing, &at(0.0), &at(100.0 * pixel), SIZE);
        assert!(pixels < 1e-2, "{pixels}");
    }

    #[test]
    fn fast_pans_strobe_and_slow_ones_do_not() {
        let pan = |degrees: f64| {
            let camera = |i: u32| {
                let (sin, cos) = (f64::from(i) * degrees.to_radians() / FPS).sin_cos();
                still(DVec3::Y, DVec3::new(sin, 0.0, -cos))
            };
            find(
                &scene(vec![hall()], &[]),
                &open_shot((0..9).map(camera).collect()),
                SIZE,
            )
        };
        // The image is 79.3 degrees wide.
        assert_eq!(pan(15.0), []);
        let found = pan(60.0);
        assert_eq!(found[0].frames.runs(), [[0, 7]]);
        let WarningKind::Strobing {
            pixels,
            seconds,
            least_seconds,
            ..
        } = found[0].kind
        else {
            panic!("{found:?}")
        };
        // In the middle of the image the focal length times the angle, and more at its sides.
        let focal = 0.5 * SIZE.y / 25.0_f64.to_radians().tan();
        let middle = focal * 2.5_f64.to_radians();
        let side = 1.0 + (0.5 * SIZE.x / focal).powi(2);
        assert!(pixels > middle && pixels < side * middle, "{pixels}");
        assert!((pixels * seconds * FPS - SIZE.x).abs() < 1e-6);
        assert_eq!(least_seconds, 3.0);
    }

    #[test]
    fn turning_away_moves_the_image_by_its_width() {
        let cameras = [DVec3::NEG_Z, DVec3::Z].map(|direction| still(DVec3::Y, direction));
        let found = find(
            &scene(vec![hall()], &[]),
            &open_shot(cameras.to_vec()),
            SIZE,
        );
        let WarningKind::Strobing {
            frame: 0, pixels, ..
        } = found[0].kind
        else {
            panic!("{found:?}")
        };
        assert_eq!(pixels, SIZE.x);
    }

    #[test]
    fn walks_and_jumps_do_not_strobe() {
        let scene = scene(vec![hall()], &[]);
        let at = |z| DVec3::new(0.5, 1.7, z);
        assert_eq!(
            find(&scene, &FrameCameras::of(&walk(at(3.0), at(1.6))), SIZE),
            []
        );
        let around = |x: f64| DVec3::new(x, 1.7, 3.0);
        let keys = [(0.0, around(-1.0), DVec3::Y), (2.0, around(1.0), DVec3::Y)];
        let mut frames = FrameCameras::of(&path(Interpolation::Linear, &keys));
        assert_eq!(find(&scene, &frames, SIZE), []);
        frames.cameras.push(still(at(0.0), DVec3::Z));
        assert_eq!(find(&scene, &frames, SIZE).len(), 1);
        frames.cuts.push(48);
        assert_eq!(find(&scene, &frames, SIZE), []);
    }
}
