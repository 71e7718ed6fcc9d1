//! Light transport against closed forms, invariants, statistics, and another renderer.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "../support/mod.rs"]
mod support;

mod cache_bakes;
mod cache_cases;
mod convergence;
mod emitters;
mod global_illumination;
mod invariants;
mod irradiance_cache;
mod mitsuba;
mod physics;
mod random_cache_cases;
mod sky;
