//! Charts of speed, turn rate and field of view over time.

use super::axis::label;
use super::layout::{Cell, px};
use super::motion::Motion;
use super::overlay::{draw_key, key_size};
use super::panel::part;
use crate::drawing::area::{Area, Drawn};
use crate::drawing::chart::{COLORS, FONT};
use plotters::prelude::*;
use std::ops::Range;

/// Room for keys above all charts, for the title of each, and for the numbers at the axes, in pixels.
const KEYS: u32 = 22;
const TITLE: u32 = 26;
const LEFT: u32 = 62;
const RIGHT: u32 = 34;
const BELOW: u32 = 42;

/// The most points of a line; further ones, hidden by others, are left out.
const POINTS: usize = 3000;

/// The space between keys, in pixels.
const KEY_DISTANCE: u32 = 4;

/// Seconds and values.
type Line = Vec<(f64, f64)>;

/// A quantity of the path over time.
struct TimeChart {
    title: &'static str,
    color: RGBColor,
    /// For each shot.
    lines: Vec<Line>,
    values: Range<f64>,
}

/// Draws speed, turn rate and field of view over time, one below the other. `keys` are numbers of keys and frames.
pub(super) fn draw(motion: &Motion, keys: &[(usize, u32)], cell: &Cell, sheet: &Area) -> Drawn {
    let speeds = of_shots(motion, Motion::speeds);
    let turns = of_shots(motion, Motion::turn_rates);
    let fields = of_shots(motion, Motion::fields_of_view);
    let charts = [
        TimeChart {
            title: "Speed (metres per second)",
            color: COLORS[0],
            values: 0.0..upwards(&speeds),
            lines: speeds,
        },
        TimeChart {
            title: "Turning (degrees per second)",
            color: COLORS[1],
            values: 0.0..upwards(&turns),
            lines: turns,
        },
        TimeChart {
            title: "Zoom (vertical field of view, degrees)",
            color: COLORS[2],
            values: around(&fields),
            lines: fields,
        },
    ];
    let plots = cell.inside(0, KEYS, 0, BELOW);
    draw_keys(motion, keys, cell, sheet)?;
    for (number, (chart, row)) in charts.iter().zip(plots.rows(3)).enumerate() {
        let below = if number == 2 { BELOW } else { 0 };
        let row = Cell {
            height: row.height + below,
            ..row
        };
        chart.draw(motion, keys, &row, below, sheet)?;
    }
    Ok(())
}

fn of_shots(motion: &Motion, line: fn(&Motion, &Range<u32>) -> Line) -> Vec<Line> {
    let shots = motion.shots.iter();
    shots.map(|shot| line(motion, shot)).collect()
}

/// The upper end of an axis that starts at 0.
fn upwards(lines: &[Line]) -> f64 {
    let values = lines.iter().flatten().map(|point| point.1);
    let highest = values.fold(0.0, f64::max);
    // Less is rounding error.
    if highest < 1e-4 { 1.0 } else { 1.1 * highest }
}

/// From the first key to the last, or a second for a still.
fn times(motion: &Motion) -> Range<f64> {
    let timeline = &motion.timeline;
    match timeline.end > timeline.start {
        true => timeline.start..timeline.end,
        false => timeline.start..timeline.start + 1.0,
    }
}

/// Draws numbered squares at the times of keys, above the charts: the first key, the last, and those between that fit.
fn draw_keys(motion: &Motion, keys: &[(usize, u32)], cell: &Cell, sheet: &Area) -> Drawn {
    let (times, last) = (times(motion), motion.keys.len() - 1);
    let width = f64::from(px(cell.width - LEFT - RIGHT));
    let at = |key: usize| {
        let fraction = (motion.keys[key] - times.start) / (times.end - times.start);
        let x = px(cell.x + LEFT) as i32 + (fraction * width) as i32;
        (x, px(cell.y + KEYS / 2) as i32)
    };
    let half = |key: usize| key_size(&[key]).0 + px(KEY_DISTANCE) as i32 / 2;
    let mut free = i32::MIN;
    for &(key, _) in keys {
        let (from, to) = (at(key).0 - half(key), at(key).0 + half(key));
        if key == last || from >= free && to <= at(last).0 - half(last) {
            draw_key(at(key), &[key], last, sheet)?;
            free = to;
        }
    }
    Ok(())
}

/// The range of all values with a margin of some degrees.
fn around(lines: &[Line]) -> Range<f64> {
    let values = lines.iter().flatten().map(|point| point.1);
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    let margin = (0.1 * (high - low)).max(2.5);
    low - margin..high + margin
}

impl TimeChart {
    fn draw(
        &self,
        motion: &Motion,
        keys: &[(usize, u32)],
        cell: &Cell,
        below: u32,
        sheet: &Area,
    ) -> Drawn {
        let area = part(sheet, cell);
        let title = (FONT, px(15)).into_font().color(&BLACK);
        let at = (px(LEFT) as i32, px(4) as i32);
        area.draw(&Text::new(self.title, at, title))?;

        let timeline = &motion.timeline;
        let times = times(motion);
        let (duration, top) = (times.end - times.start, self.values.end);
        let span = top - self.values.start;
        let mut chart = ChartBuilder::on(&area)
            .margin_top(px(TITLE))
            .margin_right(px(RIGHT))
            .set_label_area_size(LabelAreaPosition::Left, px(LEFT))
            .set_label_area_size(LabelAreaPosition::Bottom, px(below))
            .build_cartesian_2d(times, self.values.clone())?;
        let small = (FONT, px(14));
        let time_label = |time: &f64| {
            let frame = (time - timeline.start) * timeline.fps;
            format!(
                "{} ({})",
                label(*time, duration),
                label(frame, duration * timeline.fps)
            )
        };
        let width = cell.width - LEFT - RIGHT;
        chart
            .configure_mesh()
            .x_desc(if below > 0 { "seconds (frame)" } else { "" })
            .label_style(small)
            .axis_desc_style(small)
            .axis_style(BLACK.stroke_width(px(1)))
            .bold_line_style(BLACK.mix(0.10).stroke_width(px(1)))
            .light_line_style(TRANSPARENT)
            .set_all_tick_mark_size(px(4))
            .x_labels((width / 90) as usize)
            .y_labels((cell.height / 25) as usize)
            .x_label_formatter(&time_label)
            .y_label_formatter(&|value| label(*value, span))
            .draw()?;

        for &(key, _) in keys {
            let time = motion.keys[key];
            let ends = [(time, self.values.start), (time, top)];
            let style = BLACK.mix(0.35).stroke_width(px(1));
            chart.draw_series(DashedLineSeries::new(ends, px(4), px(3), style))?;
        }
        for line in &self.lines {
            if let [point] = line[..] {
                chart.draw_series([Circle::new(point, px(3), self.color.filled())])?;
            }
            let line = thinned(line, POINTS);
            chart.draw_series(LineSeries::new(line, self.color.stroke_width(px(2))))?;
        }
        Ok(())
    }
}

/// At most about `most` points that look the same: the lowest and the highest of equal parts.
fn thinned(points: &[(f64, f64)], most: usize) -> Line {
    if points.len() <= most {
        return points.to_vec();
    }
    let parts = points.chunks(points.len().div_ceil(most / 2));
    let ends = parts.flat_map(|part| {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let low = part.iter().min_by(by_value);
        let high = part.iter().max_by(by_value);
        let mut ends: Line = low.into_iter().chain(high).copied().collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends
    });
    ends.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_spikes_and_the_order() {
        let mut points: Line = (0..10_000).map(|i| (f64::from(i), 1.0)).collect();
        points[1234].1 = 9.0;
        points[7777].1 = -9.0;
        let thin = thinned(&points, 500);
        assert!(thin.len() <= 500);
        assert!(thin.contains(&(1234.0, 9.0)) && thin.contains(&(7777.0, -9.0)));
        assert!(thin.is_sorted_by_key(|point| point.0));
        assert_eq!(thinned(&points[..500], 500), points[..500]);
    }
}
