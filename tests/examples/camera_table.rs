//! Prints the camera of every frame of a camera path: its time in seconds, position, viewing direction and vertical
//! field of view in degrees.
//!
//! `cargo run --example camera_table -- paths/test3.ron`

use flythrough::camera_formats::load_camera_path;
use flythrough::input::InputFiles;
use std::error::Error;
use std::io::Write;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file] = &arguments[..] else {
        return Err("usage: camera_table PATH".into());
    };
    let path = load_camera_path(Path::new(file), &mut InputFiles::default())?.path;
    let timeline = path.timeline();
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "{:>6}{:>10}  {:^30}  {:^24}{:>8}",
        "frame", "time", "position", "direction", "fov"
    )?;
    for frame in 0..timeline.frame_count() {
        let camera = path.camera(frame);
        // The third column of the rotation points backwards.
        let (position, direction) = (camera.position, -camera.rotation.z_axis);
        writeln!(
            out,
            "{frame:>6}{:>10.3}  {:>10.4}{:>10.4}{:>10.4}  {:>8.4}{:>8.4}{:>8.4}{:>8.2}",
            timeline.time_of(frame),
            position.x,
            position.y,
            position.z,
            direction.x,
            direction.y,
            direction.z,
            camera.field_of_view().to_degrees()
        )?;
    }
    Ok(())
}
