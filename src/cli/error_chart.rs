//! `errors.svg`: the estimated error of each frame, over the sequence.

use crate::drawing::chart::{Axis, Chart, Point, Series};
use crate::frames::{ERROR_CHART_TITLE, FrameRecord};
use std::io;

/// The chart as the text of an SVG file.
pub(super) fn error_chart(frames: &[FrameRecord]) -> io::Result<Option<String>> {
    let point = |record: &FrameRecord| {
        let error = record.error;
        Point {
            x: f64::from(record.frame),
            y: error.rel_mse,
            low: error.low,
            high: error.high,
        }
    };
    let axis = |label: &str| Axis {
        label: label.to_owned(),
        logarithmic: false,
    };
    let chart = Chart {
        title: ERROR_CHART_TITLE.to_owned(),
        x: axis("frame"),
        y: axis("relMSE"),
        series: vec![Series {
            name: String::new(),
            points: frames.iter().map(point).collect(),
        }],
        guides: Vec::new(),
        size: (720, 240),
    };
    chart.to_svg().map(Some).map_err(io::Error::other)
}
