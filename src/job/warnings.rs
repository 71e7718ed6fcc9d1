//! What may be wrong with the inputs of a job, found before any frame is rendered.

use super::resolved_job::Job;
use crate::input::{IgnoredSetting, SettingsError, ignored_settings};
use crate::preflight::{FrameRuns, SceneWarning, check_scene, preflight};

impl Job {
    /// Warnings about the files of the scene, the settings, the scene and the camera path, each a line. `near` is the
    /// distance in metres that the camera should keep from surfaces. Of the warnings about frames those are left out
    /// that are about none of `frames`, in rising order.
    ///
    /// Takes about as long as loading the scene; the result does not depend on threads.
    pub fn warnings(&self, near: f64, frames: &[u32]) -> Vec<String> {
        let inputs = self.inputs();
        let (settings, scene) = (self.settings(), &inputs.scene);
        let is_wanted = |runs: &FrameRuns| {
            let is_any = |&[first, last]: &[u32; 2]| {
                let next = frames.partition_point(|&frame| frame < first);
                frames.get(next).is_some_and(|&frame| frame <= last)
            };
            runs.runs().iter().any(is_any)
        };
        let (width, height) = (settings.width, settings.height);
        let path = &inputs.path.path;
        let (of_scene, of_path) = inputs.pool.install(|| {
            (
                check_scene(&scene.scene, &scene.names, path, &settings.integrator),
                preflight(&scene.scene, path, width, height, near),
            )
        });
        let of_path = of_path
            .into_iter()
            .filter(|warning| is_wanted(&warning.frames));
        let mut warnings = scene.warnings.clone();
        warnings.extend(self.ignored_settings());
        // A headlight shows what nothing else lights.
        let is_lit = |warning: &&SceneWarning| {
            let is_dark = matches!(
                warning,
                SceneWarning::Black | SceneWarning::BlackSurfaces | SceneWarning::AmbientOnly
            );
            !(is_dark && settings.headlight > 0.0)
        };
        warnings.extend(of_scene.iter().filter(is_lit).map(|warning| {
            let file = self.spec().scene.display();
            format!("{file}: {warning}")
        }));
        warnings.extend(of_path.map(|warning| warning.to_string()));
        warnings
    }

    /// Settings that make no difference. A preview ignores most of them by intention.
    fn ignored_settings(&self) -> Vec<String> {
        let (spec, inputs) = (self.spec(), self.inputs());
        if spec.preview {
            return Vec::new();
        }
        let of_command = spec.settings.clone();
        let sources = [
            of_command,
            inputs.path.settings.clone(),
            inputs.scene.settings.clone(),
        ];
        let line = |(source, ignored): (usize, IgnoredSetting)| {
            let IgnoredSetting { key, reason } = ignored;
            let file = match source {
                0 => {
                    let message = format!("makes no difference: {reason}");
                    return SettingsError { key, message }.of_flag();
                }
                1 => &spec.path,
                _ => &spec.scene,
            };
            format!(
                "{}: settings.{key}: makes no difference: {reason}",
                file.display()
            )
        };
        let ignored = ignored_settings(&sources, &inputs.scene.scene, self.frame_count());
        ignored.into_iter().map(line).collect()
    }
}
