//! Error against time: what every technique costs on a scene and a camera path, and the error that is left.
//!
//! A few frames are rendered by each technique of one table, with several seeds, and compared with references of known
//! noise. Unbiased oracle estimates at pixels of full-size frames show whether a technique is biased, and pairs of
//! consecutive frames how much it flickers. The irradiance cache is baked once, for all techniques that use it, and each of
//! their frames is charged its part of the time.

mod advice;
mod baked_cache;
mod bias;
mod flicker;
mod measure;
mod pictures;
mod progress;
mod reference;
mod seconds;
mod technique;
mod text;

use advice::TARGETS;
pub use baked_cache::BakeCost;
pub use bias::BiasRow;
pub use flicker::FlickerRow;
pub use measure::Measurement;
pub use progress::Listener;
pub use technique::{Technique, techniques};

use baked_cache::BakedCache;
use progress::Progress;

use crate::camera::{Camera, CameraPath};
use crate::drawing::chart::{Chart, ChartError};
use crate::input::Settings;
use crate::metrics::Reference;
use crate::render::RenderSettings;
use crate::scene::Scene;
use crate::storage::{check_writable, write_atomic};
use serde::Serialize;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What a report is made from.
#[derive(Debug)]
pub struct Inputs<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The camera path.
    pub path: &'a CameraPath,
    /// What files and command line set for the sequence; techniques override mode, samples, splits, target error and gi.
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
    fn exposure(&self) -> f32 {
        self.given.exposure.unwrap_or(0.0)
    }

    /// Settings of frames of the sequence.
    fn resolve(&self, settings: &Settings) -> RenderSettings {
        settings.resolve(self.path.timeline().frame_count())
    }

    /// The camera of a frame, or of the [`TINY`] window in the middle of the full-size one.
    fn camera(&self, frame: u32, is_tiny: bool) -> Camera {
        let mut camera = self.path.camera(frame);
        if is_tiny {
            camera.half_height *= f64::from(TINY.1) / f64::from(self.full_size().1);
        }
        camera
    }

    /// A warning of settings in the files that a technique's flags do not override; none if there are none.
    fn caveat(&self) -> Option<String> {
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
    fn full_size(&self) -> (u32, u32) {
        let settings = self.resolve(&self.given);
        (settings.width, settings.height)
    }
}

/// Why there is no report.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A file of it cannot be written.
    #[error("{file}: cannot be written: {source}", file = .file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A chart cannot be drawn.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// A picture or a table cannot be encoded.
    #[error("a part of the report cannot be encoded: {0}")]
    Encoding(io::Error),
}

impl ReportError {
    fn file(file: &Path, source: io::Error) -> ReportError {
        ReportError::Unwritable {
            file: file.to_owned(),
            source,
        }
    }
}

/// What a report finds.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The title.
    pub title: String,
    /// Columns and rows of the sequence's own frames.
    pub full_size: (u32, u32),
    /// The frames that were rendered.
    pub frames: Vec<u32>,
    /// How often each technique rendered each frame.
    pub seeds: u32,
    /// The cheapest settings, in words.
    pub advice: Vec<String>,
    /// The cost of the irradiance cache.
    pub bake: BakeCost,
    /// Every technique, in the order of the table.
    pub measurements: Vec<Measurement>,
    /// The references that errors are relative to.
    pub references: Vec<ReferenceRow>,
    /// The bias of techniques.
    pub bias: Vec<BiasRow>,
    /// The flicker of pairs of frames.
    pub flicker: Vec<FlickerRow>,
}

/// The quality of a reference.
#[derive(Debug, Serialize)]
pub struct ReferenceRow {
    /// Columns and rows.
    pub size: (u32, u32),
    /// The frame.
    pub frame: u32,
    /// The estimated relMSE of the reference itself.
    pub relative_square_error: f64,
}

/// Columns and rows of the window that stands for a frame where a technique is too slow for all of it.
const TINY: (u32, u32) = (4, 3);

/// Measures everything, on the threads of the current pool, and writes `report.csv`, `report.json`,
/// `report.md`, `curves` and `flicker` as SVG and PNG, and a strip for each curve.
pub fn report(inputs: &Inputs, listener: Listener) -> Result<Report, ReportError> {
    let techniques = techniques();
    let mut progress = Progress::new(inputs, &techniques, listener);
    let write = |name: &str, bytes: &[u8]| {
        let file = inputs.folder.join(name);
        write_atomic(&file, bytes).map_err(|source| ReportError::file(&file, source))
    };
    let strips = inputs.folder.join("strips");
    fs::create_dir_all(&strips).map_err(|source| ReportError::file(&strips, source))?;
    let written_last = inputs.folder.join("report.md");
    check_writable(&written_last).map_err(|source| ReportError::file(&written_last, source))?;

    let usual_references = reference::references(inputs, false, &mut progress)?;
    let tiny_references = reference::references(inputs, true, &mut progress)?;
    let cache = BakedCache::new(inputs, &mut progress);
    let mut measurements: Vec<Measurement> = Vec::new();
    for (number, technique) in techniques.iter().enumerate() {
        let references = match technique.is_tiny {
            true => &tiny_references,
            false => &usual_references,
        };
        let (measured, picture) =
            measure::measure(inputs, &cache, technique, references, &mut progress);
        let next = techniques.get(number + 1);
        if next.is_none_or(|next| next.curve != technique.curve) {
            let strip = pictures::strip(inputs, &picture, &references[0].1)?;
            write(&strip_of(technique.curve), &strip)?;
        }
        measurements.push(measured);
    }
    let bias = bias::bias(inputs, &cache, &techniques, &mut progress);
    let flicker = flicker::flicker(inputs, &cache, &mut progress);

    let quality = |(frame, reference): &(u32, Reference)| ReferenceRow {
        size: (reference.mean().width(), reference.mean().height()),
        frame: *frame,
        relative_square_error: reference.relative_square_error(inputs.exposure()),
    };
    let full_size = inputs.full_size();
    let references = usual_references.iter().chain(&tiny_references);
    let references: Vec<ReferenceRow> = references.map(quality).collect();
    let mut advice: Vec<String> = TARGETS
        .map(|target| advice::advice(&measurements, target, full_size))
        .to_vec();
    advice.extend(flicker::advice(&flicker));
    advice.extend(inputs.caveat());
    advice.extend(reference::advice(inputs, &references));
    let report = Report {
        title: inputs.title.clone(),
        full_size,
        frames: inputs.frames.clone(),
        seeds: inputs.seeds,
        advice,
        bake: cache.bake,
        measurements,
        references,
        bias,
        flicker,
    };
    let chart = |name: &str, chart: Chart| -> Result<(), ReportError> {
        write(&format!("{name}.svg"), chart.to_svg()?.as_bytes())?;
        write(&format!("{name}.png"), &chart.to_png()?)
    };
    write("report.csv", text::csv(&report).as_bytes())?;
    write("report.json", &text::json(&report)?)?;
    write("report.md", text::markdown(&report).as_bytes())?;
    chart("curves", pictures::curves(inputs, &report.measurements))?;
    chart("flicker", pictures::flicker_curve(inputs, &report.flicker))?;
    Ok(report)
}

/// The file of a curve's strip.
fn strip_of(curve: &str) -> String {
    let letter = |c: char| if c.is_alphanumeric() { c } else { '_' };
    format!(
        "strips/{}.png",
        curve.chars().map(letter).collect::<String>()
    )
}

/// How many there are.
fn pixels((width, height): (u32, u32)) -> f64 {
    f64::from(width) * f64::from(height)
}
