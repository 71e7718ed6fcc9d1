use crate::camera::{Camera, FrameCameras};
use serde::Serialize;

/// `camera_path.json` as nerfstudio's viewer writes it.
#[derive(Serialize)]
struct CameraPathJson {
    default_fov: f64,
    default_transition_sec: f64,
    keyframes: Vec<KeyframeJson>,
    camera_type: &'static str,
    render_height: u32,
    render_width: u32,
    fps: f64,
    seconds: f64,
    is_cycle: bool,
    smoothness_value: f64,
    camera_path: Vec<FrameJson>,
}

/// For the viewer's editor.
#[derive(Serialize)]
struct KeyframeJson {
    matrix: [f64; 16],
    fov: f64,
    aspect: f64,
    override_transition_enabled: bool,
    /// How long after the key before it; of the first key of a loop after its last, otherwise none.
    override_transition_sec: Option<f64>,
}

/// For renderings.
#[derive(Serialize)]
struct FrameJson {
    camera_to_world: [f64; 16],
    fov: f64,
    aspect: f64,
}

/// The text of a `camera_path.json` with these frames, of so many columns and rows, and keys for the editor: the
/// cameras at these times, in seconds; at least one.
pub fn nerfstudio_json(
    cameras: &FrameCameras,
    keys: &[(f64, Camera)],
    is_cycle: bool,
    (width, height): (u32, u32),
) -> serde_json::Result<String> {
    let aspect = f64::from(width) / f64::from(height);
    let fov = |camera: &Camera| camera.field_of_view().to_degrees();
    // A loop's editor goes on from its last key to its first by itself.
    let (keys, closing) = match keys {
        [.., last, again] if is_cycle => (&keys[..keys.len() - 1], Some(again.0 - last.0)),
        keys => (keys, None),
    };
    let mut before = None;
    let keyframes = keys.iter().map(|(time, camera)| KeyframeJson {
        matrix: matrix(camera),
        fov: fov(camera),
        aspect,
        override_transition_enabled: before.is_some() || closing.is_some(),
        override_transition_sec: match before.replace(*time) {
            Some(before) => Some(time - before),
            None => closing,
        },
    });
    let frames = cameras.cameras.iter().map(|camera| FrameJson {
        camera_to_world: matrix(camera),
        fov: fov(camera),
        aspect,
    });
    let path = CameraPathJson {
        default_fov: fov(&cameras.cameras[0]),
        default_transition_sec: 2.0,
        keyframes: keyframes.collect(),
        camera_type: "perspective",
        render_height: height,
        render_width: width,
        fps: cameras.fps,
        seconds: cameras.cameras.len() as f64 / cameras.fps,
        is_cycle,
        smoothness_value: 0.0,
        camera_path: frames.collect(),
    };
    serde_json::to_string_pretty(&path)
}

/// Camera to world, row by row.
fn matrix(camera: &Camera) -> [f64; 16] {
    let [x, y, z] = camera.rotation.transpose().to_cols_array_2d();
    let [a, b, c] = camera.position.to_array();
    let rows = [x, y, z].map(|row| row.map(|number| number + 0.0));
    let [x, y, z] = rows;
    [
        x[0], x[1], x[2], a, y[0], y[1], y[2], b, z[0], z[1], z[2], c, 0.0, 0.0, 0.0, 1.0,
    ]
}
