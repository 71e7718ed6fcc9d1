//! The sheet: title, legend, plan, elevation and charts, drawn to SVG.

use super::axis::label;
use super::charts;
use super::cutaway::{SECTION, SOLID, cutaway};
use super::layout::{Cell, HEAD, Layout, SIZE, px};
use super::motion::Motion;
use super::overlay::{DOT, END, FRUSTUM, LINE, Marks, START, write};
use super::panel::{Panel, SheetPoint};
use super::region::Region;
use super::view::View;
use crate::drawing::area::{Area, Drawn, svg_of};
use crate::drawing::chart::FONT;
use crate::scene::Scene;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::error::Error;

/// The number of camera positions that are taken as outside of solids.
const IN_THE_AIR: u32 = 16;

/// Everything that is drawn, with its layout.
#[derive(Debug)]
pub(super) struct Sheet<'a> {
    motion: &'a Motion,
    region: &'a Region,
    title: &'a str,
    panels: [Panel; 2],
    charts: Cell,
    marks: Marks,
}

impl<'a> Sheet<'a> {
    pub(super) fn new(motion: &'a Motion, region: &'a Region, title: &'a str) -> Sheet<'a> {
        let layout = Layout::of(region);
        let elevation = region.elevation;
        let from = match elevation == View::ELEVATION_OF_X {
            true => "Elevation: towards −z, cut open just in front of the camera's path",
            false => "Elevation: towards +x, cut open just in front of the camera's path",
        };
        let plan = "Plan: from above, cut open just above the camera's path";
        let panels = [
            Panel::new(View::PLAN, plan, layout.plan, &region.shown),
            Panel::new(elevation, from, layout.elevation, &region.shown),
        ];
        let scale = panels.iter().map(Panel::units_per_metre);
        let marks = Marks::of(
            motion,
            scale.fold(f64::INFINITY, f64::min),
            region.frustum_length,
        );
        Sheet {
            motion,
            region,
            title,
            panels,
            charts: layout.charts,
            marks,
        }
    }

    /// The text of an SVG file.
    pub(super) fn to_svg(&self, scene: &Scene) -> Result<String, Box<dyn Error>> {
        let (width, height) = SIZE;
        let units = (px(width), px(height));
        let drawn = svg_of(units, |sheet| self.draw(sheet))?;
        // The images come first, below everything else; plotters cannot draw them.
        let (_, drawn) = drawn
            .split_once(">\n")
            .ok_or("plotters wrote no SVG file")?;
        let mut svg = format!(
            "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {} {}\" \
             xmlns=\"http://www.w3.org/2000/svg\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n",
            units.0, units.1
        );
        for panel in &self.panels {
            svg += &self.picture(scene, panel)?;
        }
        Ok(svg + drawn)
    }

    /// The scene behind a panel, as an element of the file.
    fn picture(&self, scene: &Scene, panel: &Panel) -> Result<String, Box<dyn Error>> {
        let (view, window) = (&panel.view, &panel.window);
        let frames = self.motion.timeline.spread(IN_THE_AIR).into_iter();
        let is_air: Vec<DVec3> = frames
            .map(|frame| self.motion.camera(frame).position)
            .collect();
        let greys = cutaway(scene, view, self.region.cut(view), window, &is_air);
        let mut png = Vec::new();
        let mut encoder = png::Encoder::new(&mut png, window.size.0, window.size.1);
        encoder.set_color(png::ColorType::Grayscale);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&greys)?;
        writer.finish()?;
        let Cell {
            x,
            y,
            width,
            height,
        } = panel.inside;
        Ok(format!(
            "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
             href=\"data:image/png;base64,{}\"/>\n",
            px(x),
            px(y),
            px(width),
            px(height),
            STANDARD.encode(&png)
        ))
    }

    fn draw(&self, sheet: &Area) -> Drawn {
        self.draw_head(sheet)?;
        for panel in &self.panels {
            panel.draw_axes(sheet)?;
            self.marks.draw(self.motion, panel, sheet)?;
        }
        charts::draw(self.motion, &self.marks.keys, &self.charts, sheet)
    }

    /// Draws title and legend.
    fn draw_head(&self, sheet: &Area) -> Drawn {
        let timeline = &self.motion.timeline;
        let frames = timeline.frame_count();
        let (seconds, metres) = (timeline.end - timeline.start, self.motion.length());
        // Longer titles do not fit.
        let title = match self.title.char_indices().nth(60) {
            Some((end, _)) => format!("{}…", &self.title[..end]),
            None => self.title.to_owned(),
        };
        let summary = format!(
            "{title}: {frames} {} at {} per second, {} s, {} m",
            if frames == 1 { "frame" } else { "frames" },
            label(timeline.fps, 0.01),
            label(seconds, 0.1),
            label(metres, 0.1),
        );
        let at = |x: u32, y: u32| (px(HEAD.x + x) as i32, px(HEAD.y + y) as i32);
        let title = (FONT, px(20)).into_font().style(FontStyle::Bold);
        sheet.draw(&Text::new(summary, at(12, 8), title.color(&BLACK)))?;
        let legend = Legend { sheet, right: 18 };
        self.draw_legend(legend)
    }

    fn draw_legend(&self, mut legend: Legend) -> Drawn {
        for (color, what) in [
            (START, "first key"),
            (LINE, "key, from 0 on"),
            (END, "last key"),
        ] {
            legend.entry(what, |sheet, at| {
                let half = px(7) as i32;
                let corners = [(at.0 - half, at.1 - half), (at.0 + half, at.1 + half)];
                sheet.draw(&Rectangle::new(corners, color.filled()))?;
                write(sheet, at, "0", 14, &WHITE)
            })?;
        }
        let dots = match self.marks.dots {
            1 => "each frame".to_owned(),
            dots => format!("every {dots} frames"),
        };
        legend.entry(&dots, |sheet, at| {
            let ends = [(at.0 - px(9) as i32, at.1), (at.0 + px(9) as i32, at.1)];
            sheet.draw(&PathElement::new(ends, LINE.stroke_width(px(2))))?;
            Ok(sheet.draw(&Circle::new(at, px(5) / 2, DOT.filled()))?)
        })?;
        legend.entry("number of a frame", |sheet, at| {
            write(sheet, at, "24", 14, &DOT)
        })?;
        legend.entry("what the camera sees", |sheet, at| {
            let (x, y) = (px(9) as i32, px(6) as i32);
            let cone = vec![(at.0 - x, at.1), (at.0 + x, at.1 - y), (at.0 + x, at.1 + y)];
            sheet.draw(&Polygon::new(cone.clone(), FRUSTUM.mix(0.24)))?;
            Ok(sheet.draw(&PathElement::new(cone, FRUSTUM.stroke_width(px(1))))?)
        })?;
        legend.entry("scene, dark where it is cut", |sheet, at| {
            let half = px(7) as i32;
            let corners = [(at.0 - half, at.1 - half), (at.0 + half, at.1 + half)];
            let grey = RGBColor(SOLID, SOLID, SOLID);
            sheet.draw(&Rectangle::new(corners, grey.filled()))?;
            let [from, to] = corners;
            let edge = vec![from, (to.0, from.1), to, (from.0, to.1), from];
            let dark = RGBColor(SECTION, SECTION, SECTION);
            Ok(sheet.draw(&PathElement::new(edge, dark.stroke_width(px(1))))?)
        })
    }
}

/// Marks and their meanings, side by side.
struct Legend<'a, 'b> {
    sheet: &'a Area<'b>,
    /// The middle of the next mark, in pixels.
    right: u32,
}

impl Legend<'_, '_> {
    /// Draws a mark around a point, and its meaning beside it.
    fn entry(&mut self, meaning: &str, mark: impl FnOnce(&Area, SheetPoint) -> Drawn) -> Drawn {
        let at = |x: u32| (px(HEAD.x + x) as i32, px(HEAD.y + 45) as i32);
        mark(self.sheet, at(self.right))?;
        let text = (FONT, px(14)).into_font().color(&BLACK);
        let text = text.pos(Pos::new(HPos::Left, VPos::Center));
        self.sheet
            .draw(&Text::new(meaning, at(self.right + 13), text))?;
        self.right += 44 + 6 * meaning.len() as u32;
        Ok(())
    }
}
