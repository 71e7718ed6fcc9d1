//! Checks of a scene and a camera path before any frame is rendered: lights in closed bodies, surfaces that coincide,
//! cameras inside objects, jumps of the velocity, pans that strobe.
//!
//! Knows nothing of files, terminals or light transport: it looks at shapes, at the cameras of the frames and at what a
//! few rays of each frame hit.

mod closed_bodies;
mod contact;
mod duplicates;
#[cfg(test)]
mod fixtures;
mod frame_runs;
mod heading;
mod inside;
mod lights;
mod materials;
mod motion;
mod nothing;
mod overlaps;
mod scene_warning;
mod sealed_lights;
mod seam;
mod steps;
mod strobing;
mod timing;
mod warning;

pub use frame_runs::FrameRuns;
pub use scene_warning::SceneWarning;
pub use warning::{PathWarning, WarningKind};

use crate::camera::{CameraPath, FrameCameras};
use crate::integrator::IntegratorSettings;
use crate::scene::{Scene, SceneNames};
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
    let mut warnings = timing::find(path);
    warnings.extend(nothing::find(scene, &frames, size));
    warnings.extend(contact::find(scene, &frames, near));
    warnings.extend(motion::find(&frames, height));
    warnings.extend(heading::find(&frames, path.orientation_mode()));
    warnings.extend(strobing::find(scene, &frames, size));
    warnings.extend(seam::find(&frames));
    warnings
}

/// Warnings about a scene that is rendered along a path: lights, materials, surfaces.
///
/// Works on the threads of the current pool; the result does not depend on them.
pub fn check_scene(
    scene: &Scene,
    names: &SceneNames,
    path: &CameraPath,
    integrator: &IntegratorSettings,
) -> Vec<SceneWarning> {
    let frames = FrameCameras::of(path);
    let mut warnings = lights::find(scene, names, integrator);
    warnings.extend(sealed_lights::find(scene, names, &frames));
    warnings.extend(materials::find(scene, names));
    warnings.extend(duplicates::find(scene, names));
    warnings.extend(overlaps::find(scene, names, &frames));
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
    fn of_an_empty_scene_nothing_is_seen() {
        let nothing = scene(vec![], &[]);
        let far = DVec3::splat(1e6);
        let only_nothing = |path: &CameraPath, frames: u32| {
            let found = preflight(&nothing, path, 1280, 720, 0.1);
            assert_eq!(found.len(), 1, "{found:?}");
            assert_eq!(found[0].kind, WarningKind::EmptyScene);
            assert_eq!(found[0].frames, FrameRuns::of(0..frames));
        };
        for path in [walk(far, far), walk(far, far + DVec3::X)] {
            only_nothing(&path, 25);
        }
        only_nothing(&path(Interpolation::Linear, &[(0.0, far, DVec3::ZERO)]), 1);
        let integrator = IntegratorSettings::Whitted { bounces: 4 };
        let path = walk(far, far);
        let found = check_scene(&nothing, &SceneNames::default(), &path, &integrator);
        assert_eq!(found, []);
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
