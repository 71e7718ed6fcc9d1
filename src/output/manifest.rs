use super::folder::{FrameFolder, write_whole};
use super::record::FrameRecord;
use serde::Serialize;
use std::io;

/// What the frames of a folder say of themselves, by number.
#[derive(Debug, Serialize)]
pub struct Manifest {
    frames: Vec<FrameRecord>,
}

impl Manifest {
    /// Asks each of the first `count` frames that is there: the manifest is made anew of the frames alone, so
    /// it is right for whoever rendered them, in however many runs. What is no frame is passed over.
    pub fn of(folder: &FrameFolder, count: u32) -> Manifest {
        let frames = (0..count)
            .filter_map(|frame| folder.record(frame))
            .collect();
        Manifest { frames }
    }

    /// Writes `manifest.ron` and, if any frame has an error, `errors.csv`.
    pub fn write(&self, folder: &FrameFolder) -> io::Result<()> {
        let pretty = ron::ser::PrettyConfig::new()
            .struct_names(true)
            .depth_limit(2);
        let text = ron::ser::to_string_pretty(self, pretty).map_err(io::Error::other)?;
        write_whole(&folder.path().join("manifest.ron"), text.as_bytes())?;
        let mut table = "frame,relMSE,low,high\n".to_owned();
        let mut rows = 0;
        for record in &self.frames {
            if let Some(error) = record.error {
                let (error, low, high) = (error.relative_square_error, error.low, error.high);
                table += &format!("{},{error:e},{low:e},{high:e}\n", record.frame);
                rows += 1;
            }
        }
        if rows > 0 {
            write_whole(&folder.path().join("errors.csv"), table.as_bytes())?;
        }
        Ok(())
    }
}
