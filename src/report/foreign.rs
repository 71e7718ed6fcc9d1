//! Files of somebody else under the names of a report's own.

use super::error::ReportError;
use crate::storage::Folder;
use std::path::Path;

/// The most bytes of a report's texts.
const MAX_TEXT: u64 = 1 << 26;

/// Refuses a folder that holds a file under the name of one of a report's texts which the program did not write. One
/// that is not there yet is free.
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
    for (name, is_own) in texts {
        let is_foreign = folder.contains(name)
            && !folder
                .read_text(name, MAX_TEXT)
                .is_ok_and(|text| is_own(&text));
        if is_foreign {
            return Err(ReportError::Foreign {
                file: folder.file(name),
            });
        }
    }
    Ok(())
}
