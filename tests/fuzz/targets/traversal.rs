#![no_main]
//! The bytes are the first of the numbers that a hostile scene and its rays are made of.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| flythrough::accel::check_scene_of(bytes));
