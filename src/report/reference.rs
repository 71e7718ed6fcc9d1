use super::{Inputs, ReportError};
use crate::film::Film;
use crate::input::{Mode, Settings};
use crate::metrics::Reference;
use crate::output::{decode_exr, encode_exr, note_of_exr, write_whole};
use crate::render::{RenderSettings, render_frame};
use std::fs;

/// Its numbers have nothing in common with those of what is measured.
pub(super) const SEED: u32 = 1 << 24;

/// The reference of a frame of so many columns and rows: montecarlo with samples spread over each pixel, added
/// until its own relMSE is below what the report asks for. It is made once, and kept with the fingerprint of
/// all that decides it.
pub(super) fn reference(
    inputs: &Inputs,
    (width, height): (u32, u32),
    is_tiny: bool,
    frame: u32,
) -> Result<Reference, ReportError> {
    let settings = settings(inputs, (width, height));
    let folder = inputs.folder.join("references");
    let camera = inputs.camera(frame, is_tiny);
    let decisive = format!("{} {settings:?} {camera:?} {frame}", inputs.fingerprint);
    let fingerprint = blake3::hash(decisive.as_bytes()).to_string();
    let files =
        ["a", "b"].map(|half| folder.join(format!("{width}x{height}_{frame:05}_{half}.exr")));
    let cached = files.each_ref().map(|file| {
        let is_it = note_of_exr(file).is_ok_and(|note| note.as_deref() == Some(&*fingerprint));
        is_it.then(|| decode_exr(file).ok()).flatten()
    });
    if let [Some(a), Some(b)] = cached {
        return Ok(Reference::new(a, b));
    }
    let rendered = render_frame(inputs.scene, &camera, &settings, frame, &|_| ());
    let deviation = match rendered.noise {
        Some(noise) => noise.deviation,
        None => Film::new(width, height),
    };
    let half = |sign: f32| {
        let mut half = rendered.film.clone();
        for (pixel, deviation) in half.pixels_mut().iter_mut().zip(deviation.pixels()) {
            *pixel += sign * *deviation;
        }
        half
    };
    let halves = [half(1.0), half(-1.0)];
    for (file, half) in files.iter().zip(&halves) {
        let kept = fs::create_dir_all(&folder)
            .and_then(|()| write_whole(file, &encode_exr(half, &fingerprint)?));
        kept.map_err(|source| ReportError::file(file, source))?;
    }
    let [a, b] = halves;
    Ok(Reference::new(a, b))
}

fn settings(inputs: &Inputs, size: (u32, u32)) -> RenderSettings {
    let settings = Settings {
        mode: Some(Mode::Montecarlo),
        size: Some(size),
        samples: Some(16),
        splits: Some(vec![2]),
        seed: Some(SEED),
        target_error: Some(inputs.reference_error),
        ..Settings::default()
    };
    settings.or(inputs.given.clone()).resolve()
}
