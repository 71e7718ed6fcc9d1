//! `flythrough path`: plots, imports and exports camera paths.

use super::outcome::{Failure, Status};
use super::path_args::{PathArguments, PathCommand};
use super::{path_export, path_import, path_plot};

pub(super) fn run(arguments: &PathArguments) -> Result<Status, Failure> {
    match &arguments.command {
        PathCommand::Plot(arguments) => path_plot::run(arguments),
        PathCommand::Import(arguments) => path_import::run(arguments),
        PathCommand::Export(arguments) => path_export::run(arguments),
    }
}
