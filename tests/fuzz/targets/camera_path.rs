//! The bytes are a camera path file. If it is accepted, every frame has a camera that is finite and not deformed.
#![no_main]

use flythrough::camera_formats::load_camera_path;
use flythrough::input::InputFiles;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let file = flythrough_fuzz::file("p.ron", bytes);
    let Ok(input) = load_camera_path(&file, &mut InputFiles::default()) else {
        return;
    };
    let frames = input.path.timeline().frame_count();
    for frame in (0..frames)
        .step_by(1 + frames as usize / 100)
        .chain([frames - 1])
    {
        let camera = input.path.camera(frame);
        assert!(camera.position.is_finite(), "{frame}: {camera:?}");
        let product = camera.rotation * camera.rotation.transpose();
        assert!(
            product.abs_diff_eq(Default::default(), 1e-9),
            "{frame}: {camera:?}"
        );
        let height = camera.half_height;
        assert!(height > 0.0 && height.is_finite(), "{frame}: {camera:?}");
    }
});
