use super::path_args::ExportArguments;
use super::{Failure, Status, keep, written};
use crate::camera::FrameCameras;
use crate::camera_formats::load_camera_path;
use crate::camera_formats::{GltfContainer, camera_table, gltf_file, nerfstudio_json};
use crate::input::{InputFiles, Settings};
use crate::storage::write_atomic;

pub(super) fn run(arguments: &ExportArguments) -> Result<Status, Failure> {
    keep(&arguments.out, arguments.force)?;
    let input = load_camera_path(&arguments.path, &mut InputFiles::default())?;
    let flags = Settings {
        size: arguments.size,
        ..Settings::default()
    };
    flags.check().map_err(|error| error.of_flag())?;
    let settings = flags.or(input.settings).resolve(1);
    let aspect = f64::from(settings.width) / f64::from(settings.height);
    let path = &input.path;
    let frames = FrameCameras::of(path);
    let extension = arguments.out.extension().unwrap_or_default();
    let bytes = match extension.to_string_lossy().to_lowercase().as_str() {
        "json" => {
            let size = (settings.width, settings.height);
            nerfstudio_json(&frames, &path.key_cameras(), path.is_closed(), size)?.into_bytes()
        }
        "gltf" => gltf_file(&frames, aspect, GltfContainer::Text)?,
        "glb" => gltf_file(&frames, aspect, GltfContainer::Binary)?,
        "jsonl" => camera_table(&frames)?.into_bytes(),
        _ => {
            let out = arguments.out.display();
            return Err(format!("{out}: name it .json, .gltf, .glb or .jsonl").into());
        }
    };
    written(&arguments.out, write_atomic(&arguments.out, &bytes))?;
    Ok(Status::Done)
}
