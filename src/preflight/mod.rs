//! Checks of a camera path through a scene before any frame is rendered: cameras inside objects, jumps of the velocity,
//! pans that strobe.
//!
//! Knows nothing of files, terminals or light transport: it looks at the cameras of the frames and at what a few rays
//! of each frame hit.

mod contact;
#[cfg(test)]
mod fixtures;
mod frame_runs;
mod heading;
mod inside;
mod motion;
mod seam;
mod steps;
mod strobing;
mod warning;

pub use frame_runs::FrameRuns;
pub use warning::{PathWarning, WarningKind};

use crate::camera::{CameraPath, FrameCameras};
use crate::scene::Scene;
use glam::DVec2;

/// Warnings about a camera path whose frames have `width` x `height` pixels, the worst kinds first. `near` is the
/// distance in metres that the camera should keep from surfaces.
///
/// Works on the threads of the current pool; the result does not depend on them.
pub fn preflight(
    scene: &Scene,
    path: &CameraPath,
    width: u32,
    height: u32,
    near: f64,
) -> Vec<PathWarning> {
    let frames = FrameCameras::of(path);
    let size = DVec2::new(width.into(), height.into());
    let mut warnings = contact::find(scene, &frames, near);
    warnings.extend(motion::find(&frames, height));
    warnings.extend(heading::find(&frames, path.orientation_mode()));
    warnings.extend(strobing::find(scene, &frames, size));
    warnings.extend(seam::find(&frames));
    warnings
}

#[cfg(test)]
mod tests {
    use super::fixtures::{hall, path, scene, walk};
    use super::*;
    use crate::camera::Interpolation;
    use glam::DVec3;

    #[test]
    fn a_smooth_walk_through_a_hall_gives_no_warnings() {
        let scene = scene(vec![hall()], &[]);
        let at = |x, z| DVec3::new(x, 1.7, z);
        let target = at(0.0, -30.0);
        let keys = [
            (0.0, at(0.0, 4.0), target),
            (2.0, at(1.0, 2.0), target),
            (4.0, at(-1.0, 0.0), target),
            (6.0, at(0.0, -2.0), target),
        ];
        let path = path(Interpolation::CatmullRom, &keys);
        assert_eq!(preflight(&scene, &path, 1280, 720, 0.1), []);
    }

    #[test]
    fn an_empty_scene_gives_no_warnings() {
        let nothing = scene(vec![], &[]);
        let far = DVec3::splat(1e6);
        for path in [walk(far, far), walk(far, far + DVec3::X)] {
            assert_eq!(preflight(&nothing, &path, 1, 1, 0.1), []);
        }
        let still = path(Interpolation::Linear, &[(0.0, far, DVec3::ZERO)]);
        assert_eq!(preflight(&nothing, &still, 1280, 720, 0.1), []);
    }

    #[test]
    fn the_result_does_not_depend_on_threads() {
        let scene = scene(vec![hall()], &[(DVec3::new(0.0, 1.7, 0.0), 0.5)]);
        let path = walk(DVec3::new(-6.0, 1.7, 0.1), DVec3::new(6.0, 1.7, 0.1));
        let findings = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.expect("threads");
            pool.install(|| preflight(&scene, &path, 1280, 720, 0.1))
        });
        assert_eq!(findings[0], findings[1]);
        assert!(findings[0].len() >= 3);
    }
}
