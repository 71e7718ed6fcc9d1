//! The bytes are a JPEG file, the texture of a sphere.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    flythrough_fuzz::file("t.jpg", bytes);
    flythrough_fuzz::check_scene(
        b"Scene(ambient: (1, 1, 1), materials: {\"m\": (texture: \"t.jpg\")},
            objects: [sphere(radius: 1, material: \"m\")])",
    );
});
