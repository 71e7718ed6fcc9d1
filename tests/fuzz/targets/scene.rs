//! The bytes are a scene file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| flythrough_fuzz::check_scene(bytes));
