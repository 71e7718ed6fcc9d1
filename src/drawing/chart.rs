//! Line charts, as the text of an SVG file and as the bytes of a PNG file of the same picture.

use super::area::{Area, DrawingError, Drawn, svg_of};
use super::svg;
use crate::text::visible;
use plotters::coord::ranged1d::{Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// A line chart.
///
/// The axes span the values that can be drawn. Values that are not finite and, on a logarithmic axis, values that are
/// not positive are left out.
#[derive(Clone, Debug)]
pub struct Chart {
    /// The heading.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The series, in the order of the legend.
    pub series: Vec<Series>,
    /// Reference values of y, drawn as dashed lines.
    pub guides: Vec<f64>,
    /// Columns and rows, in pixels.
    pub size: (u32, u32),
}

/// An axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// The quantity, with its unit.
    pub label: String,
    /// Whether the scale is logarithmic.
    pub logarithmic: bool,
}

/// Points joined by a line in their order.
#[derive(Clone, Debug)]
pub struct Series {
    /// The name in the legend; empty for none.
    pub name: String,
    /// The points of the line.
    pub points: Vec<Point>,
}

/// A point with an interval of y around it.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// The horizontal coordinate.
    pub x: f64,
    /// The vertical coordinate.
    pub y: f64,
    /// The lower end of the interval of y.
    pub low: f64,
    /// The upper end of the interval of y.
    pub high: f64,
}

/// The palette of Okabe and Ito (2002) for all kinds of colour vision, without yellow.
pub(super) const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(60, 60, 60),
];

/// The most points of a series that are drawn as marks with error bars; beyond, the intervals are drawn as a band.
const MAX_MARKS: usize = 40;

/// The font of all text.
pub(super) const FONT: &str = "sans-serif";

impl Chart {
    /// The text of an SVG file.
    pub fn to_svg(&self) -> Result<String, DrawingError> {
        svg_of(self.size, |root| self.draw(root)).map_err(|error| self.failed(error))
    }

    /// The bytes of a PNG file.
    pub fn to_png(&self) -> Result<Vec<u8>, DrawingError> {
        let pixels = svg::pixels(&self.to_svg()?).map_err(|error| self.failed(error))?;
        pixels.encode_png().map_err(|error| self.failed(error))
    }

    fn failed(&self, reason: impl ToString) -> DrawingError {
        DrawingError::new(format!("chart \"{}\"", self.title), reason)
    }

    fn draw(&self, root: &Area) -> Drawn {
        root.fill(&WHITE)?;
        let points = self.series.iter().flat_map(|series| &series.points);
        let drawn = points.filter_map(|point| self.fitting(point));
        let x = range(drawn.clone().map(|point| point.x), &self.x);
        let values = drawn.flat_map(|point| [point.low, point.y, point.high]);
        let y = range(values.chain(self.guides.iter().copied()), &self.y);
        // Beside the plot.
        let names = self.series.iter().map(|series| visible(&series.name).len());
        let legend_width = match names.max() {
            None | Some(0) => 8,
            Some(letters) => 44 + 7 * letters as u32,
        };
        let (plot, legend) = root.split_horizontally(self.size.0.saturating_sub(legend_width));
        self.legend(&legend)?;
        let mut builder = ChartBuilder::on(&plot);
        builder
            .caption(visible(&self.title), (FONT, 18))
            .margin(8)
            .set_label_area_size(LabelAreaPosition::Left, 64)
            .set_label_area_size(LabelAreaPosition::Bottom, 40);
        match (self.x.logarithmic, self.y.logarithmic) {
            (true, true) => self.plot(builder.build_cartesian_2d(x.log_scale(), y.log_scale())?),
            (false, true) => self.plot(builder.build_cartesian_2d(x, y.log_scale())?),
            (true, false) => self.plot(builder.build_cartesian_2d(x.log_scale(), y)?),
            (false, false) => self.plot(builder.build_cartesian_2d(x, y)?),
        }
    }

    fn plot<X, Y>(&self, mut chart: ChartContext<SVGBackend, Cartesian2d<X, Y>>) -> Drawn
    where
        X: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let small = (FONT, 13);
        let [ends, heights] = [chart.x_range(), chart.y_range()];
        chart
            .configure_mesh()
            .x_desc(visible(&self.x.label))
            .y_desc(visible(&self.y.label))
            .label_style(small)
            .axis_desc_style(small)
            .bold_line_style(BLACK.mix(0.15))
            .light_line_style(BLACK.mix(0.05))
            .x_label_formatter(&|value| self.x.label(*value, &ends))
            .y_label_formatter(&|value| self.y.label(*value, &heights))
            .draw()?;
        for &y in &self.guides {
            let ends = [(ends.start, y), (ends.end, y)];
            chart.draw_series(DashedLineSeries::new(
                ends,
                6,
                4,
                BLACK.mix(0.5).stroke_width(1),
            ))?;
        }
        for (number, series) in self.series.iter().enumerate() {
            let color = COLORS[number % COLORS.len()];
            let points = series.points.iter().filter_map(|point| self.fitting(point));
            let points: Vec<Point> = points.collect();
            let line = points.iter().map(|point| (point.x, point.y));
            if points.len() > MAX_MARKS {
                let band = points.iter().map(|point| (point.x, point.high));
                let back = points.iter().rev().map(|point| (point.x, point.low));
                let band: Vec<(f64, f64)> = band.chain(back).collect();
                chart.draw_series([Polygon::new(band, color.mix(0.25))])?;
            } else {
                chart.draw_series(points.iter().map(|point| {
                    let ends = vec![(point.x, point.low), (point.x, point.high)];
                    PathElement::new(ends, color.stroke_width(2))
                }))?;
                chart.draw_series(line.clone().map(|at| mark(number, at)))?;
            }
            chart.draw_series(LineSeries::new(line, color.stroke_width(1)))?;
        }
        Ok(())
    }

    fn legend(&self, area: &Area) -> Drawn {
        let style = (FONT, 13)
            .into_font()
            .color(&BLACK)
            .pos(Pos::new(HPos::Left, VPos::Center));
        let named = self.series.iter().enumerate();
        for (number, series) in named.filter(|(_, series)| !series.name.is_empty()) {
            let y = 48 + 20 * number as i32;
            area.draw(&mark(number, (12, y)))?;
            area.draw(&Text::new(visible(&series.name), (24, y), style.clone()))?;
        }
        Ok(())
    }

    /// The point, if it can be drawn, with the ends of its interval that can be.
    fn fitting(&self, point: &Point) -> Option<Point> {
        let fits =
            |value: f64, axis: &Axis| value.is_finite() && (value > 0.0 || !axis.logarithmic);
        let end = |value: f64| if fits(value, &self.y) { value } else { point.y };
        (fits(point.x, &self.x) && fits(point.y, &self.y)).then(|| Point {
            low: end(point.low),
            high: end(point.high),
            ..*point
        })
    }
}

/// The mark of a series: another colour for each, and other shapes once all colours are used.
fn mark<'a, C: Clone + 'static>(number: usize, at: C) -> DynElement<'static, SVGBackend<'a>, C> {
    let style = COLORS[number % COLORS.len()].filled();
    match number / COLORS.len() % 3 {
        0 => Circle::new(at, 4, style).into_dyn(),
        1 => TriangleMarker::new(at, 6, style).into_dyn(),
        _ => Cross::new(at, 4, style.stroke_width(2)).into_dyn(),
    }
}

/// The range of an axis, with a margin.
fn range(values: impl Iterator<Item = f64> + Clone, axis: &Axis) -> Range<f64> {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    if low > high {
        return 0.1..1.0;
    }
    if axis.logarithmic {
        let (low, high) = (low / 1.3, high * 1.3);
        // Only powers of ten are labelled, so the range contains one.
        let below = 10_f64.powf(low.log10().floor());
        let has_label = 10.0 * below <= high;
        return if has_label { low } else { 0.99 * below }..high;
    }
    let margin = if high > low { 0.03 * (high - low) } else { 1.0 };
    low - margin..high + margin
}

impl Axis {
    /// A short label of a number at the axis. Its digits tell it from its neighbours: on a linear scale they are a tenth
    /// of the range apart or more, on a logarithmic one they are other powers of ten.
    fn label(&self, value: f64, range: &Range<f64>) -> String {
        let span = match self.logarithmic {
            true => value.abs(),
            false => range.end - range.start,
        };
        // What rounding leaves of zero.
        if value.abs() < 1e-6 * span {
            return "0".to_owned();
        }
        let place = |number: f64| number.abs().log10().floor() as i32;
        let last = place(span) - 1;
        let short = |digits: &str| match digits.contains('.') {
            true => digits
                .trim_end_matches('0')
                .trim_end_matches('.')
                .to_owned(),
            false => digits.to_owned(),
        };
        if (1e-3..1e5).contains(&value.abs()) {
            let decimals = (-last).max(0) as usize;
            return short(&format!("{value:.decimals$}"));
        }
        let decimals = (place(value) - last).max(0) as usize;
        let scientific = format!("{value:.decimals$e}");
        let (digits, exponent) = scientific.split_once('e').expect("an exponent");
        format!("{}e{exponent}", short(digits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn chart(logarithmic: bool, series: Vec<Vec<[f64; 4]>>, size: (u32, u32)) -> Chart {
        let axis = |label: &str| Axis {
            label: label.to_owned(),
            logarithmic,
        };
        let series = series.into_iter().enumerate().map(|(number, points)| {
            let points = points.into_iter();
            Series {
                name: format!("technique {number}"),
                points: points
                    .map(|[x, y, low, high]| Point { x, y, low, high })
                    .collect(),
            }
        });
        Chart {
            title: "error & time".to_owned(),
            x: axis("seconds"),
            y: axis("relMSE"),
            series: series.collect(),
            guides: vec![0.01],
            size,
        }
    }

    /// The positions of the marks of the first series.
    fn marks(svg: &str) -> Vec<[i32; 2]> {
        let circles = svg
            .lines()
            .filter(|line| line.starts_with("<circle") && line.contains("#0072B2"));
        let number = |line: &str, key: &str| -> i32 {
            let rest = line.split(&format!("{key}=\"")).nth(1).expect(key);
            rest.split('"')
                .next()
                .and_then(|n| n.parse().ok())
                .expect("a number")
        };
        circles
            .map(|line| [number(line, "cx"), number(line, "cy")])
            .collect()
    }

    #[test]
    fn equal_factors_are_equal_distances() {
        let points = [0.001, 0.01, 0.1, 1.0].map(|x| [x, 10.0 * x, 9.0 * x, 11.0 * x]);
        let svg = chart(true, vec![points.to_vec()], (960, 600))
            .to_svg()
            .expect("drawn");
        assert!(svg::pixels(&svg).is_ok());
        for text in ["error &amp; time", "seconds", "relMSE", "technique 0"] {
            assert!(svg.contains(text), "{text}");
        }
        // The last is the legend's, or the first.
        let mut marks = marks(&svg);
        marks.sort();
        let steps: Vec<[i32; 2]> = marks
            .windows(2)
            .map(|m| [m[1][0] - m[0][0], m[1][1] - m[0][1]])
            .collect();
        assert_eq!(marks.len(), 5);
        for step in &steps[1..3] {
            assert!(
                (step[0] - steps[0][0]).abs() <= 1 && (step[1] - steps[0][1]).abs() <= 1,
                "{steps:?}"
            );
        }
    }

    #[test]
    fn pictures_have_their_size_and_the_colors_of_all_series() {
        let many: Vec<[f64; 4]> = (1..100).map(|i| [f64::from(i), 0.2, 0.1, 0.3]).collect();
        let few = vec![[1.0, 0.4, 0.3, 0.5], [50.0, 0.5, 0.4, 0.6]];
        let png = chart(false, vec![many, few], (720, 240))
            .to_png()
            .expect("drawn");
        let picture = image::load_from_memory(&png).expect("a PNG").into_rgb8();
        assert_eq!(picture.dimensions(), (720, 240));
        for color in &COLORS[..2] {
            let seen = picture
                .pixels()
                .filter(|p| p.0 == [color.0, color.1, color.2]);
            assert!(seen.count() > 20, "{color:?}");
        }
        // Letters: what is darker than any line.
        assert!(
            picture
                .pixels()
                .filter(|p| p.0[0] < 40 && p.0[1] < 40)
                .count()
                > 200
        );
    }

    #[test]
    fn what_cannot_be_drawn_is_left_out() {
        let nothing = [f64::NAN, 1.0, 1.0, 1.0];
        for logarithmic in [true, false] {
            for points in [
                vec![],
                vec![nothing],
                vec![[1.0, 1.0, 1.0, 1.0]],
                vec![[-1.0, 0.0, -1.0, 1.0], [1.0, 1.0, 0.0, f64::INFINITY]],
            ] {
                chart(logarithmic, vec![points], (320, 160))
                    .to_png()
                    .expect("drawn");
            }
        }
    }

    #[test]
    fn labels_are_short() {
        let axis = |logarithmic| Axis {
            label: String::new(),
            logarithmic,
        };
        for (value, expected) in [
            (0.01, "0.01"),
            (1.0, "1"),
            (1e-4, "1e-4"),
            (1000.0, "1000"),
            (1e7, "1e7"),
        ] {
            assert_eq!(axis(true).label(value, &(1e-5..1e8)), expected);
        }
        for (value, range, expected) in [
            (0.0, 0.0..1.0, "0"),
            (-1e-17, -1.0..1.0, "0"),
            (250.0, 0.0..300.0, "250"),
            (-0.5, -1.0..1.0, "-0.5"),
            (6.5e-4, 6e-4..8e-4, "6.5e-4"),
            (1e-3, 6e-4..1.1e-3, "0.001"),
            (1_234_567.0, 1_234_560.0..1_234_580.0, "1.234567e6"),
        ] {
            assert_eq!(axis(false).label(value, &range), expected);
        }
    }

    /// Errors of frames that differ little, and other ranges.
    #[test]
    fn ticks_have_labels_of_their_own() {
        for (low, high) in [
            (6.1e-4, 8.3e-4),
            (6.1e-4, 6.3e-4),
            (1e-12, 9e-12),
            (-0.002, 0.003),
            (99_990.0, 100_010.0),
            (1e6, 1e6 + 20.0),
            (0.0, 1.0),
        ] {
            let points = vec![[0.0, low, low, low], [7.0, high, high, high]];
            let mut chart = chart(false, vec![points], (720, 240));
            chart.guides.clear();
            let svg = chart.to_svg().expect("drawn");
            let mut lines = svg.lines();
            let mut labels = Vec::new();
            while let Some(line) = lines.next() {
                if line.starts_with("<text") && line.contains("text-anchor=\"end\"") {
                    labels.extend(lines.next());
                }
            }
            let distinct: BTreeSet<&str> = labels.iter().copied().collect();
            assert!(
                labels.len() > 3 && distinct.len() == labels.len(),
                "{labels:?}"
            );
        }
    }
}
