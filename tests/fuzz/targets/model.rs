//! The bytes are an OBJ file and, after the first byte 255, the MTL file `m.mtl`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut files = bytes.splitn(2, |&byte| byte == 255);
    flythrough_fuzz::file("m.obj", files.next().unwrap_or_default());
    flythrough_fuzz::file("m.mtl", files.next().unwrap_or_default());
    flythrough_fuzz::check_scene(
        b"Scene(ambient: (1, 1, 1), objects: [model(file: \"m.obj\")],
            lights: [(position: (1, 2, 3), intensity: (9, 9, 9))])",
    );
});
