//! The pictures of a report: charts of error and flicker, and strips of pictures beside their errors.

use super::error::ReportError;
use super::flicker::{self, FlickerRow};
use super::inputs::Inputs;
use super::measure::Measurement;
use super::technique::TARGETS;
use crate::drawing::chart::{Axis, Chart, Point, Series};
use crate::film::Film;
use crate::metrics::{Reference, heat_map, relative_errors};
use image::{ImageFormat, RgbImage};
use std::io::{self, Cursor};

/// Error against time: a curve for each kind of technique.
pub(super) fn curves(inputs: &Inputs, measurements: &[Measurement]) -> Chart {
    let (width, height) = inputs.full_size();
    let mut series: Vec<Series> = Vec::new();
    for measured in measurements {
        let point = Point {
            x: measured.full_size_seconds,
            y: measured.rel_mse,
            low: measured.spread[0],
            high: measured.spread[1],
        };
        match series
            .last_mut()
            .filter(|series| series.name == measured.curve)
        {
            Some(series) => series.points.push(point),
            None => series.push(Series {
                name: measured.curve.to_owned(),
                points: vec![point],
            }),
        }
    }
    Chart {
        title: format!("{}: error against time", inputs.title),
        x: Axis {
            label: format!("seconds per frame of {width}x{height}"),
            logarithmic: true,
        },
        y: Axis {
            label: "relMSE".to_owned(),
            logarithmic: true,
        },
        series,
        guides: TARGETS.to_vec(),
        size: (1080, 600),
    }
}

/// Flicker along the camera path, with 95 % confidence intervals.
pub(super) fn flicker_curve(inputs: &Inputs, rows: &[FlickerRow]) -> Chart {
    let of_kind = |kind: &&'static str| {
        let rows = rows.iter().filter(|row| row.kind == *kind);
        let points = rows.map(|row| {
            let end = |sign: f64| {
                (row.square.mean + sign * 1.96 * row.square.error)
                    .max(0.0)
                    .sqrt()
            };
            Point {
                x: f64::from(row.frame),
                y: row.relative,
                low: end(-1.0),
                high: end(1.0),
            }
        });
        Series {
            name: (*kind).to_owned(),
            points: points.collect(),
        }
    };
    let axis = |label: &str| Axis {
        label: label.to_owned(),
        logarithmic: false,
    };
    Chart {
        title: format!("{}: flicker from each frame to the next", inputs.title),
        x: axis("frame"),
        y: axis("relative change"),
        series: flicker::KINDS.iter().map(of_kind).collect(),
        guides: vec![0.0],
        size: (960, 300),
    }
}

/// A picture and its relative error in false colours, side by side, as a PNG file.
pub(super) fn strip(
    inputs: &Inputs,
    picture: &Film,
    reference: &Reference,
) -> Result<Vec<u8>, ReportError> {
    let errors = heat_map(&relative_errors(picture, reference, inputs.exposure()));
    let mut shown = picture.clone();
    shown.expose(inputs.exposure());
    let shown = shown.to_srgb8();
    let width = picture.width();
    let row = 3 * width as usize;
    let rows = shown.chunks(row).zip(errors.chunks(row));
    let codes = rows.flat_map(|(picture, errors)| [picture, errors].concat());
    let strip = RgbImage::from_raw(2 * width, picture.height(), codes.collect());
    let strip = strip.ok_or_else(|| ReportError::Encoding(io::Error::other("cut off")))?;
    let mut bytes = Cursor::new(Vec::new());
    let written = strip.write_to(&mut bytes, ImageFormat::Png);
    written.map_err(|error| ReportError::Encoding(io::Error::other(error)))?;
    Ok(bytes.into_inner())
}

/// The file of a curve's strip.
pub(super) fn strip_of(curve: &str) -> String {
    let letter = |c: char| if c.is_alphanumeric() { c } else { '_' };
    format!("{}.png", curve.chars().map(letter).collect::<String>())
}
