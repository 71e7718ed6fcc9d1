//! The command that a folder says its frames were rendered by, once more.

use super::Failure;
use super::args::{Arguments, Command, RenderArguments};
use super::input_args::ThreadsArgument;
use super::job::Job;
use super::quote::choose_again;
use crate::frames::FrameFolder;
use clap::Parser;

/// Loads what the frames of a folder were made from, as it is now. Names in the command are relative to where it
/// was typed: that is the current folder from now on.
pub(super) fn job_of(folder: &FrameFolder, threads: ThreadsArgument) -> Result<Job, Failure> {
    let command = &folder.sequence().command;
    let mut render = render_of(folder)?;
    let there = command.folder.display();
    let gone_there = std::env::set_current_dir(&command.folder);
    let names = [&render.job.input.scene, &render.job.input.path];
    if names.iter().any(|name| name.is_relative()) {
        gone_there.map_err(|error| format!("{there}, where they were rendered: {error}"))?;
    }
    // Whoever rendered them may have had more threads.
    render.job.threads = threads;
    let mut job = Job::new(&render.job, render.preview, Some(folder.path()), false)?;
    if let Some(budget) = render.budget
        && !choose_again(&mut job, budget, folder.path())?
    {
        let folder = folder.path().display();
        return Err(format!("{folder}/quote.ron, where the samples stand, is lost").into());
    }
    Ok(job)
}

/// Whether the frames of a folder are a preview; not if nobody can tell.
pub(super) fn is_preview(folder: &FrameFolder) -> bool {
    render_of(folder).is_ok_and(|render| render.preview)
}

/// The command that the frames of a folder were rendered by.
fn render_of(folder: &FrameFolder) -> Result<RenderArguments, Failure> {
    let arguments = &folder.sequence().command.arguments;
    match Arguments::try_parse_from(arguments)?.command {
        Command::Render(render) => Ok(render),
        _ => Err(format!("{}: not rendered by render", folder.path().display()).into()),
    }
}
