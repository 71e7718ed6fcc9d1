//! Files of somebody else under the names of a report's own.

use super::error::ReportError;
use crate::storage::Folder;
use std::path::Path;

/// The most bytes of a report's texts.
const MAX_TEXT: u64 = 1 << 26;

/// Refuses a folder that holds files under the names of a report's own and no text of a report. One that is not there yet
/// is free.
pub fn check_free_for_report(folder: &Path) -> Result<(), ReportError> {
    let Ok(folder) = Folder::open(folder) else {
        return Ok(());
    };
    type IsOwn = fn(&str) -> bool;
    let texts: [(&str, IsOwn); 3] = [
        ("report.md", |text| {
            let first = text.lines().next().unwrap_or_default();
            first.starts_with("# ") && first.ends_with(": error against time")
        }),
        ("report.csv", |text| text.starts_with("curve,flags,")),
        ("report.json", |text| text.starts_with("{\n  \"title\": ")),
    ];
    let has_own = texts.iter().any(|(name, is_own)| {
        let text = folder.read_text(name, MAX_TEXT);
        text.is_ok_and(|text| is_own(&text))
    });
    // Pictures are a report's beside its texts.
    let names = texts.map(|(name, _)| name).into_iter().chain(PICTURES);
    match names
        .into_iter()
        .find(|name| !has_own && folder.contains(name))
    {
        Some(name) => Err(ReportError::Foreign {
            file: folder.file(name),
        }),
        None => Ok(()),
    }
}

/// The pictures of a report, and the folder of others.
const PICTURES: [&str; 5] = [
    "curves.svg",
    "curves.png",
    "flicker.svg",
    "flicker.png",
    "strips",
];
