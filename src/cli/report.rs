use super::args::ReportArguments;
use super::loading::load;
use super::progress::ShareProgress;
use super::{Failure, Status};
use crate::input::Settings;
use crate::report::{Inputs, report};
use std::io::Write;

/// Columns of the frames that are measured, unless given.
const COLUMNS: u32 = 128;

/// Frames that are measured, unless given: from the middles of so many parts of the path.
const FRAMES: u32 = 3;

/// A hash of this program: what another build of it has made is not taken for what this one makes.
fn program() -> std::io::Result<blake3::Hash> {
    let program = std::fs::read(std::env::current_exe()?)?;
    Ok(blake3::hash(&program))
}

pub(super) fn run(arguments: &ReportArguments) -> Result<Status, Failure> {
    let loaded = load(&arguments.input, &arguments.threads)?;
    let given = loaded.settings(Settings::default());
    let size = arguments.size.unwrap_or_else(|| given.size_within(COLUMNS));
    let check = Settings {
        size: Some(size),
        target_error: Some(arguments.reference_error),
        ..Settings::default()
    };
    check.check().map_err(|error| match error.key {
        "size" => format!("--{error}"),
        _ => format!("--reference-error: {}", error.message),
    })?;
    let timeline = loaded.path.path.timeline();
    let frames = match &arguments.frames {
        Some(ranges) => ranges.of_path(timeline.frame_count())?,
        None => timeline.spread(FRAMES),
    };
    let stem = arguments.input.path.file_stem().unwrap_or_default();
    let inputs = Inputs {
        scene: &loaded.scene.scene,
        path: &loaded.path.path,
        given,
        fingerprint: format!("{} {}", loaded.fingerprint(), program()?),
        frames,
        size,
        seeds: arguments.seeds,
        reference_error: arguments.reference_error,
        folder: &arguments.out,
        title: stem.to_string_lossy().into_owned(),
    };
    let progress = ShareProgress::new(arguments.quiet);
    let made = loaded
        .pool
        .install(|| report(&inputs, &|share, what| progress.at(share, what)));
    progress.finish();
    let made = made?;
    if !arguments.quiet {
        let mut out = std::io::stdout().lock();
        for line in &made.advice {
            let _ = writeln!(out, "{line}");
        }
        for row in made.bias.iter().filter(|row| row.is_biased) {
            let _ = writeln!(out, "biased: {} ({})", row.curve, row.flags);
        }
        let _ = writeln!(out, "{}", arguments.out.join("report.md").display());
    }
    Ok(Status::Done)
}

#[cfg(test)]
mod tests {
    use super::super::args::{Arguments, Command};
    use crate::report::techniques;
    use clap::Parser;

    /// What the report prints is what `render` takes for it.
    #[test]
    fn flags_of_techniques_set_what_was_measured() {
        for technique in techniques().into_iter().filter(|t| t.repeats == 1) {
            let flags = technique.flags();
            let start = ["flythrough", "render", "scene", "path", "--out", "frames"];
            let parsed = Arguments::try_parse_from(start.into_iter().chain(flags.split(' ')));
            let Ok(Arguments {
                command: Command::Render(arguments),
            }) = parsed
            else {
                panic!("{flags}: refused");
            };
            let [mut set, mut measured] = [arguments.job.settings.settings(), technique.settings];
            for settings in [&mut set, &mut measured] {
                settings.gi = Some(settings.global_illumination(9));
            }
            assert_eq!(set, measured, "{flags}");
        }
    }
}
