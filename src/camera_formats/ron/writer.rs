//! Writes the cameras of all frames as a camera path file.

use crate::camera::FrameCameras;
use std::fmt::Write;

/// The text of a camera path file with a key for each frame. `comment` stands above it; `size` is the columns and rows
/// of the frames, if known.
pub fn camera_path_to_ron(
    cameras: &FrameCameras,
    size: Option<(u32, u32)>,
    comment: &str,
) -> String {
    let mut text = String::new();
    for line in comment.lines() {
        text += &format!("// {line}\n");
    }
    text += &format!(
        "CameraPath(\n    fps: {},\n    interpolation: linear,\n",
        cameras.fps
    );
    if let Some((width, height)) = size {
        text += &format!("    settings: (size: ({width}, {height})),\n");
    }
    text += "    keyframes: [\n";
    for (frame, camera) in cameras.cameras.iter().enumerate() {
        let time = cameras.time_of(frame);
        let [x, y, z] = camera.position.to_array();
        let quaternion = camera.quaternion();
        let [a, b, c, d] = quaternion.to_array();
        let fov = camera.field_of_view().to_degrees();
        // Half a turn has no shorter way; from a frame to the next it is a cut.
        let next = cameras.cameras.get(frame + 1);
        let is_half_turn = next.is_some_and(|next| quaternion.dot(next.quaternion()).abs() < 1e-6);
        let hold = if cameras.is_cut(frame) || is_half_turn {
            ", interpolation: hold"
        } else {
            ""
        };
        let _ = writeln!(
            text,
            "        (time: {time}, position: ({x}, {y}, {z}), quaternion: ({a}, {b}, {c}, {d}), \
             fov: {fov}{hold}),"
        );
    }
    text + "    ],\n)\n"
}
