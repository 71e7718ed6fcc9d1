//! A table of cameras in JSON Lines.

use crate::camera::FrameCameras;
use serde::Serialize;

/// A line of the table.
#[derive(Serialize)]
struct Row {
    frame: usize,
    /// In seconds.
    time: f64,
    position: [f64; 3],
    /// Camera to world: x, y, z, w.
    quaternion: [f64; 4],
    /// Vertical, in degrees.
    fov: f64,
}

/// The camera of every frame as JSON Lines, one line for each: number, time in seconds, position in world coordinates,
/// quaternion (x, y, z, w; camera to world, the camera looks along -Z with +Y up) and vertical field of view in
/// degrees. Numbers round-trip exactly.
pub fn camera_table(cameras: &FrameCameras) -> serde_json::Result<String> {
    let mut table = String::new();
    for (frame, camera) in cameras.cameras.iter().enumerate() {
        let row = Row {
            frame,
            time: cameras.time_of(frame),
            position: camera.position.to_array(),
            quaternion: camera.quaternion().to_array(),
            fov: camera.field_of_view().to_degrees(),
        };
        table += &serde_json::to_string(&row)?;
        table.push('\n');
    }
    Ok(table)
}
