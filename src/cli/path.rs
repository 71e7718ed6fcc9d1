use super::path_args::{PathArguments, PathCommand};
use super::{Failure, Status, path_export, path_import};

pub(super) fn run(arguments: &PathArguments) -> Result<Status, Failure> {
    match &arguments.command {
        PathCommand::Import(arguments) => path_import::run(arguments),
        PathCommand::Export(arguments) => path_export::run(arguments),
    }
}
