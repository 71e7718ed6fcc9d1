use super::args::RenderArguments;
use super::light::PathLight;
use super::loading::{Loaded, load};
use super::progress::{SequenceProgress, Steps, clock, rays_per_second};
use super::{Failure, Status, warn};
use crate::input::{GlobalIllumination, Settings};
use crate::output::{FrameFolder, FrameFormat, FrameStorage, Manifest, SequenceInfo};
use crate::render::{ErrorEstimate, RenderSettings, render_sequence, tile_count};
use std::io::Write;
use std::time::Instant;

pub(super) fn run(arguments: &RenderArguments) -> Result<Status, Failure> {
    let flags = arguments.settings.settings();
    flags.check().map_err(|error| error.of_flag())?;
    let loaded = load(&arguments.input, arguments.threads)?;
    let (scene, path) = (&loaded.scene, &loaded.path);
    let given = flags.or(path.settings.clone()).or(scene.settings.clone());
    given.check_together()?;
    let mut settings = given.resolve();
    let exposure = given.exposure.unwrap_or(0.0);
    let light = light(arguments, &given, &loaded, &settings)?;
    if arguments.aov.is_some() {
        let (has_noise, advice) = match &light {
            Some(_) => (
                settings.has_noise_looking_up(),
                "take more camera samples, or --gi exact",
            ),
            None => (settings.has_noise(), "choose a montecarlo mode"),
        };
        if !has_noise {
            return Err(format!("--aov error: nothing is left to chance here; {advice}").into());
        }
    }

    let timeline = path.path.timeline();
    let count = timeline.frame_count();
    let frames = match &arguments.frames {
        None => (0..count).collect(),
        Some(ranges) => ranges.of_path(count)?,
    };
    let format = FrameFormat::from(arguments.format);
    let decisive = format!(
        "{settings:?} {:?} {exposure} {format:?} {}",
        light.as_ref().map(PathLight::paths),
        env!("CARGO_PKG_VERSION")
    );
    let mut fingerprint = blake3::Hasher::new();
    fingerprint.update(loaded.fingerprint().as_bytes());
    fingerprint.update(decisive.as_bytes());
    let info = SequenceInfo {
        fps: timeline.fps,
        frames: count,
        width: settings.width,
        height: settings.height,
        extension: format.extension().to_owned(),
        fingerprint: fingerprint.finalize().to_string(),
    };
    let storage = FrameStorage {
        format,
        exposure,
        error_maps: arguments.aov.is_some(),
    };
    let folder = FrameFolder::open(&arguments.out, storage, &info, arguments.force)?;
    let missing: Vec<u32> = frames
        .iter()
        .copied()
        .filter(|&frame| arguments.force || !folder.has(frame))
        .collect();
    if let Some(light) = light.filter(|_| !missing.is_empty()) {
        settings = light.bake(&loaded, &settings, arguments.quiet)?;
    }
    // How many samples a frame will need until it is good enough nobody knows: it counts as a whole.
    let steps = match settings.target_error {
        Some(_) => Steps::Frames,
        None => Steps::Tiles(tile_count(&settings)),
    };
    let progress = SequenceProgress::new(missing.len() as u64, steps, arguments.quiet);
    let start = Instant::now();
    let outcome = render_sequence(
        &scene.scene,
        &path.path,
        &settings,
        &missing,
        &loaded.pool,
        &folder,
        &progress,
    );
    progress.finish();
    let elapsed = start.elapsed();

    if outcome.non_finite_samples > 0 {
        warn(&[format!(
            "{} samples were not finite numbers and are black",
            outcome.non_finite_samples
        )]);
    }
    let listed = Manifest::of(&folder, count).write(&folder);
    if let Err(error) = &listed {
        warn(&[format!(
            "{}: the frames' errors cannot be listed: {error}",
            arguments.out.display()
        )]);
    }
    let rendered = missing.len() - outcome.failures.len();
    if !arguments.quiet {
        // Nobody has to read it: the exit status says what matters.
        let _ = writeln!(
            std::io::stdout(),
            "{rendered} frames rendered in {} ({}), {} were there, {} failed: {}",
            clock(elapsed),
            rays_per_second(outcome.rays, elapsed),
            frames.len() - missing.len(),
            outcome.failures.len(),
            arguments.out.display()
        );
        if let Some(errors) = summary(&outcome.errors) {
            let _ = writeln!(std::io::stdout(), "{errors}");
        }
    }
    if let Some(target) = settings.target_error {
        let reaches = |error: &ErrorEstimate| error.interval()[1] <= target;
        let count = outcome.errors.iter().filter(|(_, e)| !reaches(e)).count();
        if count > 0 {
            warn(&[format!("{count} frames stayed above the error of {target}")]);
        }
    }
    Ok(if outcome.failures.is_empty() && listed.is_ok() {
        Status::Done
    } else {
        Status::SomeFailed
    })
}

/// The light that frames look up; none if they gather it.
fn light(
    arguments: &RenderArguments,
    given: &Settings,
    loaded: &Loaded,
    exact: &RenderSettings,
) -> Result<Option<PathLight>, Failure> {
    let file = arguments.gi_cache.as_deref();
    let frames = loaded.path.path.timeline().frame_count();
    match given.global_illumination(frames) {
        GlobalIllumination::Path => {
            let light = PathLight::open(file, loaded, exact, arguments.force)?;
            Ok(Some(light))
        }
        GlobalIllumination::Exact if file.is_some() => Err("--gi-cache: add --gi path".into()),
        GlobalIllumination::Exact => Ok(None),
    }
}

/// The errors of the frames that were rendered; none where nothing was left to chance.
fn summary(errors: &[(u32, ErrorEstimate)]) -> Option<String> {
    let error = |(_, error): &(u32, ErrorEstimate)| error.relative_square_error;
    let worst = errors.iter().max_by(|a, b| error(a).total_cmp(&error(b)))?;
    let mean = errors.iter().map(error).sum::<f64>() / errors.len() as f64;
    let [low, high] = worst.1.interval();
    Some(format!(
        "error (relMSE) {mean:.2e} on average, at worst {:.2e} ({low:.2e} to {high:.2e}) in frame {}",
        error(worst),
        worst.0,
    ))
}
