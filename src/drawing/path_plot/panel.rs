//! A panel: a view of a part of the world, to scale, with axes.

use super::axis::label;
use super::cutaway::Window;
use super::layout::{Cell, px};
use super::region::Cuboid;
use super::view::View;
use crate::drawing::area::{Area, Drawn};
use crate::drawing::chart::FONT;
use glam::{DVec2, DVec3};
use plotters::prelude::*;

/// Room for the title and for the numbers at the axes, in pixels.
const TITLE: u32 = 26;
const LEFT: u32 = 62;
const RIGHT: u32 = 12;
const BELOW: u32 = 42;

/// A point of the sheet, in its units.
pub(super) type SheetPoint = (i32, i32);

/// A view of a part of the world, to scale.
#[derive(Debug)]
pub(super) struct Panel {
    pub(super) view: View,
    pub(super) title: String,
    outside: Cell,
    /// Between the axes.
    pub(super) inside: Cell,
    /// The part of the view between the axes.
    pub(super) window: Window,
}

impl Panel {
    /// A panel that shows all of `shown`, as large as its cell allows, with the same scale on both axes.
    pub(super) fn new(view: View, title: &str, cell: Cell, shown: &Cuboid) -> Panel {
        let inside = cell.inside(LEFT, TITLE, RIGHT, BELOW);
        let pixels = DVec2::new(f64::from(inside.width), f64::from(inside.height));
        let metres_per_pixel = (view.flat(shown.size()) / pixels).max_element();
        let middle = view.flat(0.5 * shown.min + 0.5 * shown.max);
        let mut to_corner = 0.5 * metres_per_pixel * pixels;
        if !view.is_downward() {
            to_corner.y = -to_corner.y;
        }
        Panel {
            view,
            title: title.to_owned(),
            outside: cell,
            inside,
            window: Window {
                from: middle - to_corner,
                to: middle + to_corner,
                size: (inside.width, inside.height),
            },
        }
    }

    /// Units of the sheet in a metre.
    pub(super) fn units_per_metre(&self) -> f64 {
        f64::from(px(self.inside.width)) / (self.window.to.x - self.window.from.x)
    }

    /// Maps a point in world coordinates to the sheet.
    pub(super) fn to_sheet(&self, point: DVec3) -> SheetPoint {
        let Window { from, to, .. } = self.window;
        let fraction = (self.view.flat(point) - from) / (to - from);
        let unit = |start: u32, length: u32, fraction: f64| {
            (f64::from(px(start)) + fraction * f64::from(px(length))).round() as i32
        };
        let inside = &self.inside;
        (
            unit(inside.x, inside.width, fraction.x),
            unit(inside.y, inside.height, fraction.y),
        )
    }

    /// The upper left and the lower right corner of the area between the axes.
    pub(super) fn corners(&self) -> [SheetPoint; 2] {
        let Cell {
            x,
            y,
            width,
            height,
        } = self.inside;
        [(x, y), (x + width, y + height)].map(|(x, y)| (px(x) as i32, px(y) as i32))
    }

    /// Draws axes, in metres, and the title.
    pub(super) fn draw_axes(&self, sheet: &Area) -> Drawn {
        let area = part(sheet, &self.outside);
        let title = (FONT, px(17)).into_font().style(FontStyle::Bold);
        let corner = (px(LEFT) as i32, px(4) as i32);
        area.draw(&Text::new(self.title.as_str(), corner, title.color(&BLACK)))?;
        let Window { from, to, .. } = self.window;
        let spans = (to - from).abs();
        let mut chart = ChartBuilder::on(&area)
            .margin_top(px(TITLE))
            .margin_right(px(RIGHT))
            .set_label_area_size(LabelAreaPosition::Left, px(LEFT))
            .set_label_area_size(LabelAreaPosition::Bottom, px(BELOW))
            .build_cartesian_2d(from.x..to.x, to.y..from.y)?;
        let name = |axis: usize| format!("{} (m)", ["x", "y", "z"][axis]);
        let small = (FONT, px(14));
        chart
            .configure_mesh()
            .x_desc(name(self.view.across))
            .y_desc(name(self.view.along))
            .label_style(small)
            .axis_desc_style(small)
            .axis_style(BLACK.stroke_width(px(1)))
            .bold_line_style(BLACK.mix(0.10).stroke_width(px(1)))
            .light_line_style(TRANSPARENT)
            .set_all_tick_mark_size(px(4))
            .x_labels((self.inside.width / 55) as usize)
            .y_labels((self.inside.height / 45) as usize)
            .x_label_formatter(&|value| label(*value, spans.x))
            .y_label_formatter(&|value| label(*value, spans.y))
            .draw()?;
        Ok(())
    }
}

/// The drawing area of a cell.
pub(super) fn part<'a>(sheet: &Area<'a>, cell: &Cell) -> Area<'a> {
    let corner = (px(cell.x) as i32, px(cell.y) as i32);
    sheet
        .clone()
        .shrink(corner, (px(cell.width), px(cell.height)))
}
