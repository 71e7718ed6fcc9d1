//! The program and its subcommands, run as a user runs them.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "../support/mod.rs"]
mod support;

mod cli;
mod hostile_names;
mod job;
mod lights;
mod path_command;
mod path_plot;
mod preflight;
mod quote_and_audit;
mod report;
mod warnings;
