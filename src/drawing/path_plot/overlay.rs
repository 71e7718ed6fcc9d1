//! The marks of a path over the views of the scene: line, frames, keys and view frustums.

use super::axis::{ranges, round_step};
use super::labels::{Labels, half_size};
use super::layout::px;
use super::motion::Motion;
use super::panel::{Panel, SheetPoint};
use crate::camera::Camera;
use crate::drawing::area::{Area, Drawn};
use crate::drawing::chart::{COLORS, FONT};
use glam::DVec3;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub(super) const LINE: RGBColor = COLORS[0];
pub(super) const FRUSTUM: RGBColor = COLORS[5];
pub(super) const START: RGBColor = COLORS[2];
pub(super) const END: RGBColor = COLORS[1];
pub(super) const DOT: RGBColor = RGBColor(0, 50, 100);

/// The most dots along the path, and their least distance in pixels.
const DOTS: f64 = 120.0;
const DOT_DISTANCE: f64 = 6.0;

/// The most frames with a number beside them.
const NUMBERS: f64 = 20.0;

/// The most keys that are shown, and the most view frustums in all.
const KEYS: usize = 24;
const FRUSTUMS: u32 = 18;

/// The distance in pixels below which keys share a mark.
const SAME: u32 = 15;

/// Which frames and keys of a path are marked.
#[derive(Debug)]
pub(super) struct Marks {
    /// The frames from a dot to the next.
    pub(super) dots: u32,
    /// The frames from a number to the next.
    numbers: u32,
    /// The keys that are shown, and their frames.
    pub(super) keys: Vec<(usize, u32)>,
    /// The frames whose view frustum is shown.
    frustums: Vec<u32>,
    /// The length of view frustums, in metres.
    frustum_length: f64,
}

impl Marks {
    /// The marks for views of at least `units_per_metre` units of the sheet.
    pub(super) fn of(motion: &Motion, units_per_metre: f64, frustum_length: f64) -> Marks {
        let count = f64::from(motion.frame_count());
        let length = motion.length() * units_per_metre / f64::from(px(1));
        let second = motion.timeline.fps.round().max(1.0);
        let numbers = (second * f64::from(round_step(count / second / NUMBERS))) as u32;
        let keys = shown_keys(motion);
        Marks {
            dots: round_step(count / (length / DOT_DISTANCE).clamp(1.0, DOTS)).min(numbers),
            numbers,
            frustums: frustums(&keys),
            keys,
            frustum_length,
        }
    }

    /// Draws them over a view.
    pub(super) fn draw(&self, motion: &Motion, panel: &Panel, sheet: &Area) -> Drawn {
        let mut labels = Labels::within(panel.corners());
        let mut drawn: Vec<[SheetPoint; 5]> = Vec::new();
        for &frame in &self.frustums {
            let frustum = self.frustum(motion, frame, panel);
            // Frustums on top of each other would hide the drawing.
            if !drawn.iter().any(|other| is_near(other, &frustum)) {
                draw_frustum(&frustum, sheet)?;
                let half = px(4) as i32;
                labels.take(middle(&frustum), (half, half));
                drawn.push(frustum);
            }
        }
        for shot in &motion.shots {
            let mut line: Vec<SheetPoint> = shot
                .clone()
                .map(|f| sheet_point(motion, f, panel))
                .collect();
            // Frames of a camera that hardly moves share points.
            line.dedup();
            for &vertex in &line {
                labels.take(vertex, (px(4) as i32, px(4) as i32));
            }
            let around = PathElement::new(line.clone(), WHITE.mix(0.7).stroke_width(px(5)));
            sheet.draw(&around)?;
            sheet.draw(&PathElement::new(line, LINE.stroke_width(px(2))))?;
        }
        let frames = 0..motion.frame_count();
        let mut dots: Vec<SheetPoint> = frames
            .clone()
            .step_by(self.dots as usize)
            .map(|frame| sheet_point(motion, frame, panel))
            .collect();
        dots.dedup();
        for dot in dots {
            sheet.draw(&Circle::new(dot, px(5) / 2, DOT.filled()))?;
        }
        self.draw_keys(motion, panel, &mut labels, sheet)?;
        for frame in frames.step_by(self.numbers as usize).skip(1) {
            let at = sheet_point(motion, frame, panel);
            write_beside(sheet, &mut labels, at, 6, &frame.to_string(), &DOT)?;
        }
        Ok(())
    }

    /// The apex and the far corners of a camera's view frustum.
    fn frustum(&self, motion: &Motion, frame: u32, panel: &Panel) -> [SheetPoint; 5] {
        let camera = motion.camera(frame);
        let up = camera.half_height;
        let right = up * motion.aspect;
        let corner = |x: f64, y: f64| {
            let towards = camera.rotation * DVec3::new(x * right, y * up, -1.0);
            panel.to_sheet(camera.position + self.frustum_length * towards.normalize())
        };
        [
            sheet_point(motion, frame, panel),
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ]
    }

    /// Draws a numbered square for each key, or for all keys at one point, and labels start and end. Without room for
    /// the number the square is small.
    fn draw_keys(
        &self,
        motion: &Motion,
        panel: &Panel,
        labels: &mut Labels,
        sheet: &Area,
    ) -> Drawn {
        let mut groups: Vec<(SheetPoint, Vec<usize>)> = Vec::new();
        for &(key, _) in &self.keys {
            let at = panel.to_sheet(motion.key_positions[key]);
            let is_same = |other: SheetPoint| {
                (other.0 - at.0).abs().max((other.1 - at.1).abs()) < px(SAME) as i32
            };
            match groups.iter_mut().find(|group| is_same(group.0)) {
                Some(group) => group.1.push(key),
                None => groups.push((at, vec![key])),
            }
        }
        let last = motion.keys.len() - 1;
        let is_end = |keys: &[usize]| keys.contains(&0) || keys.contains(&last);
        groups.sort_by_key(|(_, keys)| !is_end(keys));
        let mut numbered = Labels::within(panel.corners());
        let (numbered, small): (Vec<_>, Vec<_>) = groups.iter().partition(|(at, keys)| {
            let half = key_size(keys);
            let has_room = numbered.is_free(*at, half);
            if has_room {
                numbered.take(*at, half);
            }
            has_room
        });
        for (at, keys) in small {
            let half = px(4) as i32;
            draw_square(*at, (half, half), key_color(keys, last), sheet)?;
        }
        for (at, keys) in &numbered {
            draw_key(*at, keys, last, sheet)?;
            labels.take(*at, key_size(keys));
        }
        for (at, keys) in &groups {
            let name = match (keys.contains(&0), keys.contains(&last)) {
                (true, true) => "start, end",
                (true, false) => "start",
                (false, true) => "end",
                (false, false) => continue,
            };
            write_beside(sheet, labels, *at, 12, name, &BLACK)?;
        }
        Ok(())
    }
}

fn is_near(a: &[SheetPoint; 5], b: &[SheetPoint; 5]) -> bool {
    let near = px(SAME) as i32;
    a.iter()
        .zip(b)
        .all(|(a, b)| (a.0 - b.0).abs() < near && (a.1 - b.1).abs() < near)
}

fn middle(points: &[SheetPoint; 5]) -> SheetPoint {
    let mean = |sum: i32| sum / points.len() as i32;
    (
        mean(points.iter().map(|point| point.0).sum()),
        mean(points.iter().map(|point| point.1).sum()),
    )
}

/// Draws the sides of a view frustum.
fn draw_frustum(&[eye, ref corners @ ..]: &[SheetPoint; 5], sheet: &Area) -> Drawn {
    for (number, &corner) in corners.iter().enumerate() {
        let side = vec![eye, corner, corners[(number + 1) % corners.len()]];
        sheet.draw(&Polygon::new(side.clone(), FRUSTUM.mix(0.10)))?;
        sheet.draw(&PathElement::new(
            side,
            FRUSTUM.mix(0.5).stroke_width(px(1)),
        ))?;
    }
    Ok(())
}

/// The half extents of a square with the numbers of keys.
pub(super) fn key_size(keys: &[usize]) -> SheetPoint {
    let (width, _) = half_size(&ranges(keys), 14);
    (width.max(px(4) as i32) + px(4) as i32, px(8) as i32)
}

/// Draws a square with the numbers of keys around a point. `last` is the last key.
pub(super) fn draw_key(at: SheetPoint, keys: &[usize], last: usize, sheet: &Area) -> Drawn {
    draw_square(at, key_size(keys), key_color(keys, last), sheet)?;
    write(sheet, at, &ranges(keys), 14, &WHITE)
}

fn draw_square(at: SheetPoint, half: SheetPoint, color: RGBColor, sheet: &Area) -> Drawn {
    let corners = [
        (at.0 - half.0, at.1 - half.1),
        (at.0 + half.0, at.1 + half.1),
    ];
    Ok(sheet.draw(&Rectangle::new(corners, color.filled()))?)
}

fn key_color(keys: &[usize], last: usize) -> RGBColor {
    match (keys.contains(&0), keys.contains(&last)) {
        (true, _) => START,
        (_, true) => END,
        _ => LINE,
    }
}

/// All keys, or evenly spread ones with the first and the last.
fn shown_keys(motion: &Motion) -> Vec<(usize, u32)> {
    let count = motion.keys.len();
    let step = round_step(count as f64 / KEYS as f64) as usize;
    let frame = |key: usize| (key, motion.frame_at(motion.keys[key]));
    let mut shown: Vec<(usize, u32)> = (0..count - 1).step_by(step).map(frame).collect();
    shown.push(frame(count - 1));
    shown
}

/// The frames of the keys, and some between.
fn frustums(keys: &[(usize, u32)]) -> Vec<u32> {
    let parts = (FRUSTUMS / keys.len() as u32).clamp(1, 6);
    let mut frames: Vec<u32> = keys.iter().map(|key| key.1).collect();
    for pair in keys.windows(2) {
        let (from, to) = (pair[0].1, pair[1].1.max(pair[0].1));
        frames.extend((1..parts).map(|part| from + (to - from) * part / parts));
    }
    frames
}

fn sheet_point(motion: &Motion, frame: u32, panel: &Panel) -> SheetPoint {
    let Camera { position, .. } = motion.camera(frame);
    panel.to_sheet(*position)
}

/// Writes a text of `size` pixels around its middle.
pub(super) fn write(
    sheet: &Area,
    middle: SheetPoint,
    text: &str,
    size: u32,
    color: &RGBColor,
) -> Drawn {
    let style = (FONT, px(size)).into_font().color(color);
    let style = style.pos(Pos::new(HPos::Center, VPos::Center));
    sheet.draw(&Text::new(text, middle, style))?;
    Ok(())
}

/// Writes a text beside a point, `away` pixels from it, if there is room.
fn write_beside(
    sheet: &Area,
    labels: &mut Labels,
    what: SheetPoint,
    away: u32,
    text: &str,
    color: &RGBColor,
) -> Drawn {
    let half = half_size(text, 14);
    let Some(middle) = labels.beside(what, px(away) as i32, half) else {
        return Ok(());
    };
    let corners = [
        (middle.0 - half.0, middle.1 - half.1),
        (middle.0 + half.0, middle.1 + half.1),
    ];
    sheet.draw(&Rectangle::new(corners, WHITE.mix(0.6).filled()))?;
    write(sheet, middle, text, 14, color)
}
