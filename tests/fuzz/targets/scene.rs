#![no_main]
//! The bytes are a scene file.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| flythrough_fuzz::look_at(bytes));
