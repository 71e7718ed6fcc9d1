//! `flythrough path plot`: the plot of a camera path through a scene.

use super::outcome::{Failure, Status, keep, warn};
use super::path_args::PlotArguments;
use crate::drawing::path_plot::plot;
use crate::input::Settings;
use crate::job::Inputs;
use crate::storage::write_atomic;

pub(super) fn run(arguments: &PlotArguments) -> Result<Status, Failure> {
    // Guards an input that is named by mistake.
    if arguments
        .out
        .extension()
        .is_none_or(|extension| extension != "svg")
    {
        let out = arguments.out.display();
        return Err(format!("{out}: the picture is an SVG file: name it .svg").into());
    }
    keep(&arguments.out, arguments.replace)?;
    let flags = Settings {
        size: arguments.size,
        ..Settings::default()
    };
    flags.check().map_err(|error| error.of_flag())?;
    let input = &arguments.input;
    let loaded = Inputs::load(&input.scene, &input.path, arguments.threads.threads)?;
    warn(&loaded.scene.warnings);
    let settings = loaded.settings(flags).resolve(1);
    let aspect = f64::from(settings.width) / f64::from(settings.height);
    let title = arguments.input.path.file_stem().unwrap_or_default();
    let (scene, path) = (&loaded.scene.scene, &loaded.path.path);
    let svg = loaded
        .pool
        .install(|| plot(scene, path, aspect, &title.to_string_lossy()))?;
    write_atomic(&arguments.out, svg.as_bytes())?;
    Ok(Status::Done)
}
