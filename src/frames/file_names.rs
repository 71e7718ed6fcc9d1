//! The names of the files in a folder of frames.

use super::format::FrameFormat;
use crate::storage::Folder;

/// The file beside the frames that records the expected ones: format, size, input hashes.
pub(super) const SEQUENCE_FILE: &str = "sequence.ron";

/// The contact sheet beside the frames.
pub(super) const SHEET_FILE: &str = "sheet.png";

/// The table beside the frames that lists their cameras.
pub(super) const CAMERAS_FILE: &str = "cameras.jsonl";

/// The records of the frames.
pub(super) const MANIFEST_FILE: &str = "manifest.ron";

/// The errors of the frames as a table.
pub(super) const ERROR_TABLE: &str = "errors.csv";

/// The errors of the frames as a chart.
pub(super) const ERROR_CHART: &str = "errors.svg";

/// How the names of all files begin that are written to a folder.
pub(super) const OWN_FILES: [&str; 9] = [
    FRAME_PREFIX,
    ERROR_MAP_PREFIX,
    SEQUENCE_FILE,
    CAMERAS_FILE,
    MANIFEST_FILE,
    "errors.",
    "estimate.ron",
    "irradiance.cache",
    SHEET_FILE,
];

const FRAME_PREFIX: &str = "frame_";

const ERROR_MAP_PREFIX: &str = "error_";

/// The first row of the table of errors.
pub(super) const ERROR_TABLE_HEADER: &str = "frame,relMSE,low,high\n";

/// The most bytes that the program reads of a text file that it wrote: a million frames take less.
pub(super) const MAX_TEXT: u64 = 1 << 28;

/// The name of the file of a frame.
pub(super) fn frame_name(frame: u32, format: FrameFormat) -> String {
    format!("{FRAME_PREFIX}{frame:05}.{}", format.extension())
}

/// The name of the file of a frame's error map.
pub(super) fn error_map_name(frame: u32) -> String {
    format!("{ERROR_MAP_PREFIX}{frame:05}.exr")
}

/// Whether a name looks like that of a frame or of an error map.
pub(super) fn looks_like_a_frame(name: &str) -> bool {
    name.starts_with(FRAME_PREFIX) || name.starts_with(ERROR_MAP_PREFIX)
}

/// Whether a file of a folder is one of those that the program writes beside frames, by how it begins. What has no such
/// name is none.
pub(super) fn is_table_of_frames(folder: &Folder, name: &str) -> bool {
    let start: &[u8] = match name {
        MANIFEST_FILE => b"Manifest(",
        CAMERAS_FILE => b"{\"frame\":0,",
        ERROR_TABLE => ERROR_TABLE_HEADER.as_bytes(),
        ERROR_CHART => b"<svg",
        SHEET_FILE => return is_sheet(folder, name),
        _ => return false,
    };
    let there = folder.read(name, MAX_TEXT);
    there.is_ok_and(|bytes| bytes.starts_with(start))
}

/// The metadata of a contact sheet.
pub(super) const SHEET_METADATA: &str = "contact sheet";

fn is_sheet(folder: &Folder, name: &str) -> bool {
    let file = folder.open_file(name).ok();
    let metadata = file.and_then(|file| FrameFormat::Png.read_metadata(file).ok()?);
    metadata.as_deref() == Some(SHEET_METADATA)
}

/// The files beside the frames that can be made again from them.
pub(super) const TABLES: [&str; 5] = [
    MANIFEST_FILE,
    CAMERAS_FILE,
    ERROR_TABLE,
    ERROR_CHART,
    SHEET_FILE,
];
