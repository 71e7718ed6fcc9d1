//! The names of the files in a folder of frames.

use super::format::FrameFormat;
use crate::render::Aov;
use crate::storage::Folder;
use std::io::Read;

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

const FRAME_PREFIX: &str = "frame_";

const ERROR_MAP_PREFIX: &str = "error_";

const CACHE_ERROR_MAP_PREFIX: &str = "cache_error_";

/// The estimate of the sequence.
pub(super) const ESTIMATE_FILE: &str = "estimate.ron";

/// The irradiance cache of the sequence.
pub(super) const CACHE_FILE: &str = "irradiance.cache";

/// The first row of the table of errors.
pub(super) const ERROR_TABLE_HEADER: &str = "frame,relMSE,low,high,worst_block,blurred\n";

/// The most bytes that the program reads of a text file that it wrote: three million frames take less.
pub(super) const MAX_TEXT: u64 = 1 << 28;

/// The name of the file of a frame.
pub(super) fn frame_name(frame: u32, format: FrameFormat) -> String {
    format!("{FRAME_PREFIX}{frame:05}.{}", format.extension())
}

/// The name of the file of a frame's map.
pub(super) fn map_name(frame: u32, aov: Aov) -> String {
    let prefix = match aov {
        Aov::Error => ERROR_MAP_PREFIX,
        Aov::CacheError => CACHE_ERROR_MAP_PREFIX,
    };
    format!("{prefix}{frame:05}.exr")
}

/// The number in a name that is that of a frame or a map, of whichever format; none in other names.
pub(super) fn frame_in(name: &str) -> Option<u32> {
    let prefixes = [FRAME_PREFIX, ERROR_MAP_PREFIX, CACHE_ERROR_MAP_PREFIX].into_iter();
    let rest = prefixes
        .filter_map(|prefix| name.strip_prefix(prefix))
        .next()?;
    let (number, extension) = rest.split_once('.')?;
    let is_number = number.bytes().all(|digit| digit.is_ascii_digit());
    let is_picture = matches!(extension, "png" | "exr");
    number.parse().ok().filter(|_| is_number && is_picture)
}

/// Whether a file of that name is written to a folder of frames.
pub(super) fn is_written(name: &str) -> bool {
    frame_in(name).is_some() || name == SEQUENCE_FILE || BESIDE_FRAMES.contains(&name)
}

/// Whether a file beside the frames is one that the program wrote, by how it begins.
pub(super) fn is_own(folder: &Folder, name: &str) -> bool {
    let start: &[u8] = match name {
        SEQUENCE_FILE => b"Sequence(",
        MANIFEST_FILE => b"Manifest(",
        CAMERAS_FILE => b"{\"frame\":0,",
        ERROR_TABLE => ERROR_TABLE_HEADER.as_bytes(),
        ERROR_CHART => return is_error_chart(folder),
        ESTIMATE_FILE => b"Estimate(",
        CACHE_FILE => b"flythrough irradiance cache",
        SHEET_FILE => return is_sheet(folder, name),
        _ => return false,
    };
    let mut beginning = vec![0; start.len()];
    let file = folder.open_file(name);
    file.is_ok_and(|mut file| file.read_exact(&mut beginning).is_ok() && beginning == start)
}

/// The metadata of a contact sheet.
pub(super) const SHEET_METADATA: &str = "contact sheet";

/// The title of the chart of errors.
pub const ERROR_CHART_TITLE: &str = "Error of each frame";

fn is_error_chart(folder: &Folder) -> bool {
    let text = folder.read_text(ERROR_CHART, MAX_TEXT);
    text.is_ok_and(|text| text.starts_with("<svg") && text.contains(ERROR_CHART_TITLE))
}

fn is_sheet(folder: &Folder, name: &str) -> bool {
    let file = folder.open_file(name).ok();
    let metadata = file.and_then(|file| FrameFormat::Png.read_metadata(file).ok()?);
    metadata.as_deref() == Some(SHEET_METADATA)
}

/// The files beside the frames.
pub(super) const BESIDE_FRAMES: [&str; 7] = [
    MANIFEST_FILE,
    CAMERAS_FILE,
    ERROR_TABLE,
    ERROR_CHART,
    ESTIMATE_FILE,
    CACHE_FILE,
    SHEET_FILE,
];
