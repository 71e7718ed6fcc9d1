//! The bytes are the first random numbers for a hostile scene and its rays, whose hits are compared with brute force.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| flythrough::accel::check_scene_of(bytes));
