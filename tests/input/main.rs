//! Input files: scenes, camera paths, models and images, valid, invalid and with extreme numbers.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "../support/mod.rs"]
mod support;

mod bad_input;
mod bad_models;
mod bad_ron;
mod bad_skies;
mod camera_files;
mod documented_examples;
mod extremes;
mod jpeg_files;
