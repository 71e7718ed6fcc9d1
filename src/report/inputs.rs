//! What a report is made from.

use crate::camera::CameraPath;
use crate::input::Settings;
use crate::render::RenderSettings;
use crate::scene::Scene;
use std::path::Path;

/// What a report is made from.
#[derive(Debug)]
pub struct Inputs<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The camera path.
    pub path: &'a CameraPath,
    /// What files and command line set for the sequence; techniques override mode, samples, splits, target error and
    /// gi.
    pub given: Settings,
    /// A hash of the input files and of the program: references of another one are not used.
    pub fingerprint: String,
    /// The frames that are rendered; at least one.
    pub frames: Vec<u32>,
    /// Their columns and rows.
    pub size: (u32, u32),
    /// How often each technique renders each frame, each time with another seed; at least 2.
    pub seeds: u32,
    /// The relMSE of the references.
    pub reference_error: f64,
    /// The folder of the report's files.
    pub folder: &'a Path,
    /// The title of the report.
    pub title: String,
}

impl Inputs<'_> {
    /// The exposure in stops.
    pub(super) fn exposure(&self) -> f32 {
        self.given.exposure.unwrap_or(0.0)
    }

    /// Settings of frames of the sequence.
    pub(super) fn resolve(&self, settings: &Settings) -> RenderSettings {
        settings.resolve(self.path.timeline().frame_count())
    }

    /// A warning of settings in the files that a technique's flags do not override; none if there are none.
    pub(super) fn caveat(&self) -> Option<String> {
        let Settings {
            samples,
            splits,
            target_error,
            gi,
            ..
        } = &self.given;
        let set = [
            ("samples", samples.is_some()),
            ("splits", splits.is_some()),
            ("target_error", target_error.is_some()),
            ("gi", gi.is_some()),
        ];
        let names = set.iter().filter(|(_, is_set)| *is_set);
        let names: Vec<&str> = names.map(|(name, _)| *name).collect();
        (!names.is_empty()).then(|| {
            format!(
                "The scene or the path sets {}, which the report leaves out: take it out of the file where a \
                 technique's flags do not set it.",
                names.join(", ")
            )
        })
    }

    /// Columns and rows of the sequence's own frames.
    pub(super) fn full_size(&self) -> (u32, u32) {
        let settings = self.resolve(&self.given);
        (settings.width, settings.height)
    }
}

/// The number of pixels of a size.
pub(super) fn pixels((width, height): (u32, u32)) -> f64 {
    f64::from(width) * f64::from(height)
}
