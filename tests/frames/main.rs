//! Sequences of frames: determinism, faults, verification, estimated errors, contact sheets and videos.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "../support/mod.rs"]
mod support;

mod determinism;
mod faults;
mod flicker;
mod frame_error;
mod irradiance_cache_file;
mod reprojection;
mod sheet;
mod verified_frames;
mod video;
