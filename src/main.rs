//! The `flythrough` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    flythrough::cli::run()
}
