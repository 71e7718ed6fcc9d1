use super::args::RenderArguments;
use super::loading::load;
use super::progress::{SequenceProgress, ShareProgress, Steps, clock, rays_per_second};
use super::{Failure, Status, warn};
use crate::bake::{BakeSettings, UNKNOWN_PATHS, bake};
use crate::camera::CameraPath;
use crate::illumination::Illumination;
use crate::input::GlobalIllumination;
use crate::integrator::Integrator;
use crate::output::{FrameFolder, FrameFormat, FrameStorage, Manifest, SequenceInfo};
use crate::render::{ErrorEstimate, render_sequence, tile_count};
use crate::scene::Scene;
use std::io::Write;
use std::sync::Arc;
use std::time::Instant;

pub(super) fn run(arguments: &RenderArguments) -> Result<Status, Failure> {
    let flags = arguments.settings.settings();
    flags
        .check()
        .map_err(|error| format!("--{}: {}", error.key.replace('_', "-"), error.message))?;
    let loaded = load(&arguments.input, arguments.threads)?;
    let (scene, path) = (loaded.scene, loaded.path);
    let given = flags.or(path.settings).or(scene.settings);
    given.check_together()?;
    let mut settings = given.resolve();
    let looks_up = given.gi == Some(GlobalIllumination::Path);
    let exposure = given.exposure.unwrap_or(0.0);
    if arguments.aov.is_some() && looks_up {
        return Err("--aov error: light that is looked up has no halves; choose --gi exact".into());
    }
    if arguments.aov.is_some() && !settings.has_noise() {
        return Err("--aov error: nothing is left to chance here; choose a montecarlo mode".into());
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
        given.gi.unwrap_or_default(),
        env!("CARGO_PKG_VERSION")
    );
    let mut fingerprint = blake3::Hasher::new();
    fingerprint.update(loaded.fingerprint.as_bytes());
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
    if looks_up
        && !missing.is_empty()
        && let Integrator::MonteCarlo { bounces, .. } = settings.integrator
    {
        let bake_settings = BakeSettings {
            width: settings.width,
            height: settings.height,
            bounces,
            seed: settings.seed,
        };
        let illumination = bake_light(
            &loaded.pool,
            &scene.scene,
            &path.path,
            &bake_settings,
            arguments.quiet,
        );
        settings.integrator = Integrator::Cached {
            illumination: Arc::new(illumination),
            paths: UNKNOWN_PATHS,
        };
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
            warn(&[format!(
                "{count} frames stayed above the error of {target} with all the samples that a pixel can take"
            )]);
        }
    }
    Ok(if outcome.failures.is_empty() && listed.is_ok() {
        Status::Done
    } else {
        Status::SomeFailed
    })
}

/// Works out the light of a path and says what it took.
fn bake_light(
    pool: &rayon::ThreadPool,
    scene: &Scene,
    path: &CameraPath,
    settings: &BakeSettings,
    quiet: bool,
) -> Illumination {
    let start = Instant::now();
    let progress = ShareProgress::new(quiet);
    let listener = |share, what| progress.at(share, what);
    let illumination = pool.install(|| bake(scene, path, settings, &listener));
    progress.finish();
    if !quiet {
        let [visible, secondary] = illumination.place_count();
        let _ = writeln!(
            std::io::stdout(),
            "light of the path worked out in {}: {visible} places that the camera sees, {secondary} beyond, {:.1} MB",
            clock(start.elapsed()),
            illumination.memory() as f64 / 1e6
        );
    }
    illumination
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
