//! The command line as clap parses it. What a command takes stands in its own file.

use super::audit::AuditArguments;
use super::bake::BakeArguments;
use super::check::CheckArguments;
use super::missing::MissingArguments;
use super::path_args::PathArguments;
use super::quote::QuoteArguments;
use super::render::RenderArguments;
use super::report::ReportArguments;
use super::sheet::SheetArguments;
use super::status::StatusArguments;
use super::verify::VerifyArguments;
use clap::{Parser, Subcommand};

/// The version, and the build: a hash of what decides pixels.
const VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    " (build ",
    env!("FLYTHROUGH_BUILD"),
    ")"
);

/// Renders pre-recorded camera fly-throughs: a scene and a camera path in, every frame out.
#[derive(Debug, Parser)]
#[command(version = VERSION, max_term_width = 100)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    Render(RenderArguments),
    Quote(QuoteArguments),
    Verify(VerifyArguments),
    Missing(MissingArguments),
    Status(StatusArguments),
    Audit(AuditArguments),
    Sheet(SheetArguments),
    Bake(BakeArguments),
    Check(CheckArguments),
    Report(ReportArguments),
    Path(PathArguments),
    /// Run numerically hard cases with known answers on this machine
    ///
    /// Takes less than a minute. Prints for each case what is measured, its limit, and the worst value with each
    /// instruction set that the processor has.
    ///
    /// Exit status: 0 all values are within their limits, 1 some are not.
    Selftest,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::techniques;
    use clap::CommandFactory;

    #[test]
    fn definitions_are_consistent() {
        Arguments::command().debug_assert();
    }

    /// What the report prints is what `render` takes for it.
    #[test]
    fn flags_of_techniques_set_what_was_measured() {
        for technique in techniques() {
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
