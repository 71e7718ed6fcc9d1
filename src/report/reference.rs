//! References of the frames that are measured: made once, and kept in the folder of the report.

use super::error::ReportError;
use super::inputs::{Inputs, pixels};
use super::progress::Progress;
use crate::frames::{decode_exr, encode_exr};
use crate::input::{GlobalIllumination, MIN_TARGET_ERROR, Mode, Samples, Settings};
use crate::metrics::Reference;
use crate::render::{RenderSettings, Renderer};
use crate::storage::{FileError, Folder};
use serde::Serialize;

/// The quality of a reference.
#[derive(Debug, Serialize)]
pub struct ReferenceRow {
    /// Columns and rows.
    pub size: (u32, u32),
    /// The frame.
    pub frame: u32,
    /// The estimated relMSE of the reference itself.
    pub rel_mse: f64,
}

/// The most bytes of the file of a reference.
const MAX_BYTES: u64 = 1 << 32;

/// Far from the seeds of what is measured, so that the noise is independent.
const SEED: u32 = 1 << 24;

/// The references of the frames that are measured, by frame.
pub(super) fn references(
    inputs: &Inputs,
    progress: &mut Progress,
) -> Result<Vec<(u32, Reference)>, ReportError> {
    progress.begin("references");
    let made = inputs.frames.iter().map(|&frame| {
        let made = reference(inputs, frame)?;
        progress.step(work(inputs));
        Ok((frame, made))
    });
    made.collect()
}

/// About how many paths a reference takes: an error of 0.1 for each path of a pixel.
pub(super) fn work(inputs: &Inputs) -> f64 {
    0.1 / wanted_error(inputs) * pixels(inputs.size)
}

/// The relMSE of a reference.
fn wanted_error(inputs: &Inputs) -> f64 {
    inputs.reference_error.max(MIN_TARGET_ERROR)
}

/// The reference of one frame: montecarlo with adaptive sampling until its own estimated relMSE is low enough. It is
/// rendered once, and kept with a hash of all its inputs.
fn reference(inputs: &Inputs, frame: u32) -> Result<Reference, ReportError> {
    let settings = settings(inputs);
    let folder = Folder::create(&inputs.folder.join("references"))?;
    let camera = inputs.path.camera(frame);
    let inputs_of_it = format!("{} {settings:?} {camera:?} {frame}", inputs.fingerprint);
    let fingerprint = blake3::hash(inputs_of_it.as_bytes()).to_string();
    let files = ["a", "b"].map(|half| format!("frame_{frame:05}_{half}.exr"));
    let cached = files.each_ref().map(|file| {
        let (metadata, film) = decode_exr(&folder.read(file, MAX_BYTES).ok()?).ok()?;
        (metadata.as_deref() == Some(&*fingerprint)).then_some(film)
    });
    if let [Some(a), Some(b)] = cached {
        return Ok(Reference::new(a, b));
    }
    let renderer = Renderer::new(inputs.scene, settings, None).expect("needs no cache");
    let rendered = renderer.render_frame(&camera, frame);
    let half_buffers = rendered.half_buffers();
    for (file, half) in files.iter().zip(&half_buffers) {
        let bytes = encode_exr(half, &fingerprint);
        let bytes = bytes.map_err(|error| FileError::writing(&folder.file(file), error))?;
        folder.write_atomic(file, &bytes)?;
    }
    let [a, b] = half_buffers;
    Ok(Reference::new(a, b))
}

/// A warning if a reference is noisier than asked for; none if all are as good.
pub(super) fn advice(inputs: &Inputs, references: &[ReferenceRow]) -> Option<String> {
    let errors = references.iter().map(|row| row.rel_mse);
    let worst = errors.fold(0.0, f64::max);
    (worst > inputs.reference_error).then(|| {
        format!("The relMSE of a reference is {worst:.1e}: errors that are not much larger are uncertain.")
    })
}

fn settings(inputs: &Inputs) -> RenderSettings {
    let settings = Settings {
        mode: Some(Mode::Montecarlo),
        gi: Some(GlobalIllumination::PathTraced),
        size: Some(inputs.size),
        samples: Some(Samples::Spread(16)),
        splits: Some(vec![2]),
        seed: Some(SEED),
        target_error: Some(wanted_error(inputs)),
        ..Settings::default()
    };
    inputs.resolve(&settings.or(inputs.given.clone()))
}
