//! References of the frames that are measured: made once, and kept in the folder of the report.

use super::error::ReportError;
use super::inputs::{Inputs, TINY};
use super::progress::Progress;
use crate::frames::{decode_exr, encode_exr, note_of_exr};
use crate::input::{GlobalIllumination, MIN_TARGET_ERROR, Mode, Settings};
use crate::metrics::Reference;
use crate::render::{RenderSettings, Renderer};
use crate::storage::write_atomic;
use serde::Serialize;
use std::fs;

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

/// Far from the seeds of what is measured, so that the noise is independent.
const SEED: u32 = 1 << 24;

/// The references of the frames that are measured, or of the tiny window, by frame.
pub(super) fn references(
    inputs: &Inputs,
    is_tiny: bool,
    progress: &mut Progress,
) -> Result<Vec<(u32, Reference)>, ReportError> {
    let (size, frames) = if is_tiny {
        (TINY, &inputs.frames[..1])
    } else {
        (inputs.size, &inputs.frames[..])
    };
    progress.begin("references");
    let made = frames.iter().map(|&frame| {
        let made = reference(inputs, size, is_tiny, frame)?;
        progress.step(work(inputs, is_tiny) * f64::from(size.0 * size.1));
        Ok((frame, made))
    });
    made.collect()
}

/// About how many paths each pixel of a reference takes: an error of 0.1 for each path.
pub(super) fn work(inputs: &Inputs, is_tiny: bool) -> f64 {
    0.1 / wanted_error(inputs, is_tiny)
}

/// The relMSE of a reference. Techniques that trace a million paths in each pixel of the window need a better one.
fn wanted_error(inputs: &Inputs, is_tiny: bool) -> f64 {
    let factor = if is_tiny { 0.01 } else { 1.0 };
    (factor * inputs.reference_error).max(MIN_TARGET_ERROR)
}

/// The reference of one frame: montecarlo with adaptive sampling until its own estimated relMSE is below what the report asks
/// for. It is rendered once, and kept with a hash of all its inputs.
fn reference(
    inputs: &Inputs,
    size: (u32, u32),
    is_tiny: bool,
    frame: u32,
) -> Result<Reference, ReportError> {
    let settings = settings(inputs, size, is_tiny);
    let folder = inputs.folder.join("references");
    let camera = inputs.camera(frame, is_tiny);
    let inputs_of_it = format!("{} {settings:?} {camera:?} {frame}", inputs.fingerprint);
    let fingerprint = blake3::hash(inputs_of_it.as_bytes()).to_string();
    let kind = if is_tiny { "window" } else { "frame" };
    let files = ["a", "b"].map(|half| folder.join(format!("{kind}_{frame:05}_{half}.exr")));
    let cached = files.each_ref().map(|file| {
        let is_it = note_of_exr(file).is_ok_and(|note| note.as_deref() == Some(&*fingerprint));
        is_it
            .then(|| decode_exr(&fs::read(file).ok()?).ok())
            .flatten()
    });
    if let [Some(a), Some(b)] = cached {
        return Ok(Reference::new(a, b));
    }
    let renderer = Renderer::new(inputs.scene, settings, None).expect("needs no cache");
    let rendered = renderer.render_frame(&camera, frame);
    let halves = rendered.half_buffers();
    for (file, half) in files.iter().zip(&halves) {
        let kept = fs::create_dir_all(&folder)
            .and_then(|()| write_atomic(file, &encode_exr(half, &fingerprint)?));
        kept.map_err(|source| ReportError::file(file, source))?;
    }
    let [a, b] = halves;
    Ok(Reference::new(a, b))
}

/// A warning if a reference is noisier than asked for; none if all are as good.
pub(super) fn advice(inputs: &Inputs, references: &[ReferenceRow]) -> Option<String> {
    let errors = references.iter().map(|row| row.relative_square_error);
    let worst = errors.fold(0.0, f64::max);
    (worst > inputs.reference_error).then(|| {
        format!("The relMSE of a reference is {worst:.1e}: errors that are not much larger are uncertain.")
    })
}

fn settings(inputs: &Inputs, size: (u32, u32), is_tiny: bool) -> RenderSettings {
    let settings = Settings {
        mode: Some(Mode::Montecarlo),
        gi: Some(GlobalIllumination::PathTraced),
        size: Some(size),
        samples: Some(16),
        splits: Some(vec![2]),
        seed: Some(SEED),
        target_error: Some(wanted_error(inputs, is_tiny)),
        ..Settings::default()
    };
    inputs.resolve(&settings.or(inputs.given.clone()))
}
