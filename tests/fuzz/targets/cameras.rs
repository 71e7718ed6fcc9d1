//! The bytes are a camera file of another program. If it is accepted, the camera path file that is made of it has the
//! same cameras.
#![no_main]

use flythrough::camera::FrameCameras;
use flythrough::camera_formats::{camera_path_to_ron, import_cameras, load_camera_path};
use flythrough::input::InputFiles;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let file = flythrough_fuzz::file("cameras", bytes);
    let Ok(import) = import_cameras(&file, None, None) else {
        return;
    };
    if import.frames.cameras.len() > 1000 {
        return;
    }
    let text = camera_path_to_ron(&import.frames, import.size, "a file");
    let file = flythrough_fuzz::file("p.ron", text.as_bytes());
    let loaded = match load_camera_path(&file, &mut InputFiles::default()) {
        Ok(loaded) => FrameCameras::of(&loaded.path),
        // The loader names what exceeds the limits of a path.
        Err(error) => return assert!(error.to_string().contains("p.ron: ")),
    };
    assert_eq!(loaded.cameras.len(), import.frames.cameras.len());
    for (a, b) in loaded.cameras.iter().zip(&import.frames.cameras) {
        let scale = b.position.abs().max_element().max(1.0);
        assert!(
            (a.position - b.position).length() <= 1e-9 * scale,
            "{a:?} {b:?}"
        );
        assert!(a.rotation.abs_diff_eq(b.rotation, 1e-9), "{a:?} {b:?}");
        assert!(
            (a.half_height / b.half_height - 1.0).abs() < 1e-9,
            "{a:?} {b:?}"
        );
    }
});
