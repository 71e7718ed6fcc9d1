//! `status`: the state of a folder of frames, for people and for scripts.

use super::frames::ranges;
use super::outcome::{Failure, Status};
use crate::frames::FrameFolder;
use crate::text::visible;
use clap::Args;
use serde::Serialize;
use std::io::Write;
use std::path::PathBuf;

/// Show the state of a folder of frames
///
/// Reads only the metadata of the frames, which is quick; verify checks their pixels, too.
///
/// Exit status: 0 success, whatever is missing; 2 not a folder of frames.
#[derive(Debug, Args)]
pub(super) struct StatusArguments {
    /// Folder of the frames
    folder: PathBuf,
    /// As JSON
    #[arg(long)]
    json: bool,
    /// Print one value of the JSON alone, as in fps
    #[arg(long, value_name = "KEY", conflicts_with = "json")]
    get: Option<String>,
}

/// The state of a folder, as `--json` prints it.
#[derive(Serialize)]
struct State<'a> {
    /// Frames of the whole sequence.
    frames: u32,
    fps: f64,
    width: u32,
    height: u32,
    format: &'a str,
    /// Whether frames look light up in an irradiance cache.
    irradiance_cache: bool,
    /// The build of the program that renders them.
    build: &'a str,
    /// How many frames are of this sequence by their metadata; their pixels are not verified.
    current: usize,
    /// All others, as in 0,3-5.
    missing: String,
    /// The largest relMSE in the metadata of frames; none where there are none.
    worst_error: Option<f64>,
}

pub(super) fn run(arguments: &StatusArguments) -> Result<Status, Failure> {
    let folder = FrameFolder::open(&arguments.folder)?;
    let sequence = folder.sequence();
    let (mut current, mut missing) = (Vec::new(), Vec::new());
    for frame in 0..sequence.frames {
        match folder.current_record(frame) {
            Some(record) => current.push(record),
            None => missing.push(frame),
        }
    }
    let errors = current.iter().map(|record| record.error);
    let format = sequence.format.to_string();
    let build = visible(&sequence.build);
    let state = State {
        frames: sequence.frames,
        fps: sequence.fps,
        width: sequence.width,
        height: sequence.height,
        format: &format,
        irradiance_cache: sequence.irradiance_cache,
        build: &build,
        current: current.len(),
        missing: ranges(&missing),
        worst_error: errors.map(|error| error.rel_mse).reduce(f64::max),
    };
    let json = serde_json::to_value(&state)?;
    let mut out = std::io::stdout().lock();
    if let Some(key) = &arguments.get {
        let value = json.get(key).ok_or_else(|| {
            let keys = json
                .as_object()
                .into_iter()
                .flat_map(|fields| fields.keys());
            let keys: Vec<_> = keys.map(String::as_str).collect();
            format!(
                "--get: no key is called {key:?}; there are: {}",
                keys.join(", ")
            )
        })?;
        match value.as_str() {
            Some(text) => writeln!(out, "{text}")?,
            None => writeln!(out, "{value}")?,
        }
    } else if arguments.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&state)?)?;
    } else {
        let State {
            frames,
            fps,
            width,
            height,
            ..
        } = state;
        writeln!(
            out,
            "sequence  {frames} frames at {fps} per second, {width}x{height}, {format}"
        )?;
        writeln!(out, "build     {}", state.build)?;
        writeln!(out, "current   {}", state.current)?;
        if !missing.is_empty() {
            writeln!(out, "missing   {} ({})", missing.len(), state.missing)?;
        }
        if let Some(error) = state.worst_error {
            writeln!(out, "error     {error:.2e} at worst (relMSE)")?;
        }
    }
    Ok(Status::Done)
}
