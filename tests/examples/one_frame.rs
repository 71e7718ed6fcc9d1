//! Renders one frame of a camera path to a PNG file.
//!
//! `cargo run --release --example one_frame -- scenes/test3.ron paths/test3.ron 10 frame_00010.png`

use flythrough::camera_formats::load_camera_path;
use flythrough::frames::write_png;
use flythrough::input::{GlobalIllumination, InputFiles, Settings, load_scene};
use flythrough::render::Renderer;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, path, frame, file] = &arguments[..] else {
        return Err("usage: one_frame SCENE PATH FRAME PNG".into());
    };
    let frame: u32 = frame.parse()?;
    let mut files = InputFiles::default();
    let scene = load_scene(Path::new(scene), &mut files)?;
    let path = load_camera_path(Path::new(path), &mut files)?;
    let count = path.path.timeline().frame_count();
    if frame >= count {
        return Err(format!("the path has {count} frames, the first is 0").into());
    }

    // The path's settings come before the scene's. A single frame needs no irradiance cache.
    let settings = Settings {
        gi: Some(GlobalIllumination::PathTraced),
        ..path.settings.or(scene.settings)
    };
    settings.check_together()?;
    let renderer = Renderer::new(&scene.scene, settings.resolve(1), None)?;
    let mut film = renderer.render_frame(&path.path.camera(frame), frame).film;
    film.expose(settings.exposure.unwrap_or(0.0));
    write_png(&film, frame, Path::new(file))?;
    Ok(())
}
