use super::folder::{FrameFolder, remove, write_whole};
use super::record::FrameRecord;
use crate::chart::{Axis, Chart, Point, Series};
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

    /// Writes `manifest.ron` and, if any frame has an error, `errors.csv` and a picture of it, `errors.svg`;
    /// otherwise there are no such files.
    pub fn write(&self, folder: &FrameFolder) -> io::Result<()> {
        let pretty = ron::ser::PrettyConfig::new()
            .struct_names(true)
            .depth_limit(2);
        let text = ron::ser::to_string_pretty(self, pretty).map_err(io::Error::other)?;
        write_whole(&folder.path().join("manifest.ron"), text.as_bytes())?;
        let mut table = "frame,relMSE,low,high\n".to_owned();
        let mut points = Vec::new();
        for record in &self.frames {
            if let Some(error) = record.error {
                let (y, low, high) = (error.relative_square_error, error.low, error.high);
                table += &format!("{},{y:e},{low:e},{high:e}\n", record.frame);
                let x = f64::from(record.frame);
                points.push(Point { x, y, low, high });
            }
        }
        let [errors, picture] = ["errors.csv", "errors.svg"].map(|name| folder.path().join(name));
        if points.is_empty() {
            remove(&errors)?;
            return remove(&picture);
        }
        write_whole(&errors, table.as_bytes())?;
        let drawn = drawing(points).to_svg().map_err(io::Error::other)?;
        write_whole(&picture, drawn.as_bytes())
    }
}

fn drawing(points: Vec<Point>) -> Chart {
    let axis = |label: &str| Axis {
        label: label.to_owned(),
        logarithmic: false,
    };
    Chart {
        title: "Error of each frame".to_owned(),
        x: axis("frame"),
        y: axis("relMSE"),
        series: vec![Series {
            name: String::new(),
            points,
        }],
        guides: Vec::new(),
        size: (720, 240),
    }
}
