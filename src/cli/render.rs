use super::args::RenderArguments;
use super::progress::{SequenceProgress, clock, rays_per_second};
use super::{Failure, Status, warn};
use crate::input::{InputFiles, load_camera_path, load_scene};
use crate::output::{FrameFolder, FrameFormat, SequenceInfo};
use crate::render::{render_sequence, tile_count};
use std::io::Write;
use std::time::Instant;

pub(super) fn run(arguments: &RenderArguments) -> Result<Status, Failure> {
    let flags = arguments.settings.settings();
    flags.check().map_err(|error| format!("--{error}"))?;
    let mut files = InputFiles::default();
    let path = load_camera_path(&arguments.path, &mut files)?;
    let threads = match arguments.threads {
        Some(threads) => threads.get(),
        None => std::thread::available_parallelism()?.get(),
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?;
    let scene = pool.install(|| load_scene(&arguments.scene, &mut files))?;
    warn(&scene.warnings);
    let given = flags.or(path.settings).or(scene.settings);
    let settings = given.resolve();
    let exposure = given.exposure.unwrap_or(0.0);

    let timeline = path.path.timeline();
    let count = timeline.frame_count();
    let frames = match &arguments.frames {
        None => (0..count).collect(),
        Some(ranges) => ranges.resolve(count).map_err(|frame| {
            format!(
                "--frames: there is no frame {frame}; the path has 0-{}",
                count - 1
            )
        })?,
    };
    let format = FrameFormat::from(arguments.format);
    let decisive = format!(
        "{settings:?} {exposure} {format:?} {}",
        env!("CARGO_PKG_VERSION")
    );
    let mut fingerprint = blake3::Hasher::new();
    fingerprint.update(files.fingerprint().as_bytes());
    fingerprint.update(decisive.as_bytes());
    let info = SequenceInfo {
        fps: timeline.fps,
        frames: count,
        width: settings.width,
        height: settings.height,
        extension: format.extension().to_owned(),
        fingerprint: fingerprint.finalize().to_string(),
    };
    let folder = FrameFolder::open(&arguments.out, format, exposure, &info, arguments.force)?;
    let missing: Vec<u32> = frames
        .iter()
        .copied()
        .filter(|&frame| arguments.force || !folder.has(frame))
        .collect();
    let progress =
        SequenceProgress::new(missing.len() as u64, tile_count(&settings), arguments.quiet);
    let start = Instant::now();
    let outcome = render_sequence(
        &scene.scene,
        &path.path,
        &settings,
        &missing,
        &pool,
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
    }
    Ok(if outcome.failures.is_empty() {
        Status::Done
    } else {
        Status::SomeFailed
    })
}
