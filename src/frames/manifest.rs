use super::folder::{FrameFolder, remove};
use super::record::FrameRecord;
use crate::drawing::chart::{Axis, Chart, Point, Series};
use crate::storage::{PartFile, write_atomic};
use serde::Serialize;
use std::fs;
use std::io;
use std::time::Duration;

const FILE: &str = "manifest.ron";

/// How long a turn is waited for.
const PATIENCE: Duration = Duration::from_secs(60);

/// What the frames of a folder say of themselves, by number.
#[derive(Debug, Serialize)]
pub struct Manifest {
    frames: Vec<FrameRecord>,
}

impl Manifest {
    /// Asks each frame that is there: the manifest is made anew of the frames alone, so it is right for whoever
    /// rendered them, in however many runs, and can be lost. What is no frame is passed over.
    fn of(folder: &FrameFolder) -> Manifest {
        let frames = (0..folder.sequence().frames).filter_map(|frame| folder.record(frame));
        Manifest {
            frames: frames.collect(),
        }
    }

    /// Whether there is one that says what the frames say.
    pub fn is_right(folder: &FrameFolder) -> bool {
        let there = fs::read_to_string(folder.path().join(FILE)).ok();
        there.is_some() && there == Manifest::of(folder).to_text().ok()
    }

    /// Writes `manifest.ron` and, if any frame has an error, `errors.csv` and a picture of it, `errors.svg`;
    /// otherwise there are no such files.
    ///
    /// Others may do the same at the same time: one after the other, each after its own frames. So the last has
    /// seen all of them.
    pub fn update(folder: &FrameFolder) -> io::Result<()> {
        let file = folder.path().join(FILE);
        let _turn = PartFile::claim_in_turn(&file, PATIENCE)?;
        Manifest::of(folder).write(folder)
    }

    fn to_text(&self) -> Result<String, ron::Error> {
        let pretty = ron::ser::PrettyConfig::new()
            .struct_names(true)
            .depth_limit(2);
        ron::ser::to_string_pretty(self, pretty)
    }

    fn write(&self, folder: &FrameFolder) -> io::Result<()> {
        let text = self.to_text().map_err(io::Error::other)?;
        write_atomic(&folder.path().join(FILE), text.as_bytes())?;
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
        write_atomic(&errors, table.as_bytes())?;
        let drawn = drawing(points).to_svg().map_err(io::Error::other)?;
        write_atomic(&picture, drawn.as_bytes())
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
