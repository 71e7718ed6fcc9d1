//! Reads all of a JPEG file: proves that its picture is whole, and writes that picture alone, as a plain file.

use super::fault::{Fault, damaged, unsupported};
use super::frame::{Frame, TableSet};
use super::marker;
use super::scan::Scan;
use super::segments::{Segments, write_segment};
use jpeg_decoder::ColorTransform;

/// More than any encoder writes: one for each coefficient of three components is 192.
const MAX_SCANS: usize = 200;

/// The picture of a file that is whole.
#[derive(Debug)]
pub(super) struct Picture {
    /// A JPEG file of nothing else.
    pub(super) bytes: Vec<u8>,
    /// What its components are.
    pub(super) colors: ColorTransform,
    /// What is wrong with the file without loss to the picture.
    pub(super) notices: Vec<String>,
}

/// Proves that the picture of a file is whole. It has at most `max_texels`.
pub(super) fn check(bytes: &[u8], max_texels: u64) -> Result<Picture, Fault> {
    let rest = bytes
        .strip_prefix(&[0xff, marker::START_OF_IMAGE])
        .ok_or(damaged("it does not begin like a JPEG file"))?;
    let mut check = Check {
        file: Segments::new(rest),
        max_texels,
        frame: None,
        tables: TableSet::default(),
        restart_interval: 0,
        has_jfif: false,
        adobe_transform: None,
        scans: 0,
        picture: vec![0xff, marker::START_OF_IMAGE],
        notices: Vec::new(),
    };
    let has_end = loop {
        match check.file.marker() {
            None => break false,
            Some(marker::END_OF_IMAGE) => break true,
            Some(marker::TEMPORARY | marker::RESTART_0..=marker::RESTART_7) => {}
            Some(marker) => match check.file.content() {
                None => break false,
                Some(content) => check.segment(marker, content)?,
            },
        }
    };
    check.finish(has_end)
}

struct Check<'a> {
    file: Segments<'a>,
    max_texels: u64,
    frame: Option<Frame>,
    tables: TableSet,
    restart_interval: u16,
    has_jfif: bool,
    /// What an Adobe segment says of the colours.
    adobe_transform: Option<u8>,
    scans: usize,
    picture: Vec<u8>,
    notices: Vec<String>,
}

impl Check<'_> {
    fn segment(&mut self, marker: u8, content: &[u8]) -> Result<(), Fault> {
        match marker {
            marker::SEQUENTIAL | marker::EXTENDED_SEQUENTIAL => self.start_frame(content, false),
            marker::PROGRESSIVE => self.start_frame(content, true),
            marker::START_OF_SCAN => self.scan(content),
            marker::HUFFMAN_TABLES => self.tables.define_huffman(content),
            marker::QUANTIZATION_TABLES => self.tables.define_quantization(content),
            marker::RESTART_INTERVAL => {
                let interval = content.try_into().map(u16::from_be_bytes);
                self.restart_interval =
                    interval.map_err(|_| damaged("its restart interval is wrong"))?;
                Ok(())
            }
            marker::APPLICATION_0 => {
                if let Some([major, _, ..]) = content.strip_prefix(b"JFIF\0") {
                    self.has_jfif = true;
                    if *major != 1 {
                        self.notices.push("its JFIF version is unknown".to_owned());
                    }
                }
                Ok(())
            }
            marker::APPLICATION_14 => {
                if let Some([_, _, _, _, _, _, transform, ..]) = content.strip_prefix(b"Adobe") {
                    self.adobe_transform = Some(*transform);
                }
                Ok(())
            }
            marker::APPLICATION_0..=marker::APPLICATION_15
            | marker::COMMENT
            | marker::ARITHMETIC_CONDITIONING
            | marker::NUMBER_OF_LINES => Ok(()),
            0xc9 | 0xca => Err(unsupported("arithmetic coding")),
            0xc3 | 0xc5..=0xc7 | 0xcb | 0xcd..=0xcf => {
                Err(unsupported("lossless or hierarchical coding"))
            }
            _ => Err(damaged(&format!("its marker {marker:#04x} is misplaced"))),
        }
    }

    fn start_frame(&mut self, content: &[u8], is_progressive: bool) -> Result<(), Fault> {
        if self.frame.is_some() {
            return Err(damaged("it has two frame headers"));
        }
        let frame = Frame::parse(content, is_progressive)?;
        let (width, height) = (frame.width, frame.height);
        if u64::from(width) * u64::from(height) > self.max_texels {
            return Err(Fault::Large { width, height });
        }
        // Each component gets a quantization table of its own. Baseline files may not use so many.
        let marker = match is_progressive {
            true => marker::PROGRESSIVE,
            false => marker::EXTENDED_SEQUENTIAL,
        };
        let mut header = content[..6].to_vec();
        for (number, component) in (0..).zip(&frame.components) {
            let [x, y] = component.sampling.map(|factor| factor as u8);
            header.extend([number, x << 4 | y, number]);
        }
        write_segment(&mut self.picture, marker, &header);
        self.frame = Some(frame);
        Ok(())
    }

    fn scan(&mut self, content: &[u8]) -> Result<(), Fault> {
        let frame = self
            .frame
            .as_mut()
            .ok_or(damaged("its frame header is missing"))?;
        self.scans += 1;
        if self.scans > MAX_SCANS {
            return Err(unsupported(&format!(
                "a file of more than {MAX_SCANS} scans"
            )));
        }
        let scan = Scan::parse(content, frame, &mut self.notices)?;
        let tables = scan.write_tables(frame, &self.tables, &mut self.picture)?;
        let interval = self.restart_interval;
        let content = interval.to_be_bytes();
        write_segment(&mut self.picture, marker::RESTART_INTERVAL, &content);
        write_segment(&mut self.picture, marker::START_OF_SCAN, &scan.header());
        scan.mark_known(frame)?;
        scan.read(
            frame,
            &tables,
            interval.into(),
            &mut self.file,
            &mut self.picture,
        )
    }

    fn finish(mut self, has_end: bool) -> Result<Picture, Fault> {
        let frame = self.frame.ok_or(damaged("it holds no picture"))?;
        if frame
            .components
            .iter()
            .any(|component| component.unknown_bits[0].is_none())
        {
            return Err(damaged("a part of its colours is missing"));
        }
        let extraneous = self.file.extraneous;
        match (frame.is_complete(), has_end) {
            (true, true) => {}
            (true, false) => self.notices.push("its end marker is missing".to_owned()),
            // A file may end so on purpose.
            (false, true) if extraneous == 0 => {
                self.notices.push("it lacks its finest details".to_owned());
            }
            (false, _) => return Err(damaged("one of its scans is missing")),
        }
        if extraneous > 0 {
            self.notices
                .push(format!("{extraneous} bytes of it belong to nothing"));
        }
        let ids: Vec<u8> = frame
            .components
            .iter()
            .map(|component| component.id)
            .collect();
        let (colors, is_known) = colors(&ids, self.has_jfif, self.adobe_transform);
        if !is_known {
            self.notices.push(format!(
                "what its colours are is unknown: they are taken for {colors:?}"
            ));
        }
        self.picture.extend([0xff, marker::END_OF_IMAGE]);
        // A notice of many segments is one.
        self.notices.sort();
        self.notices.dedup();
        Ok(Picture {
            bytes: self.picture,
            colors,
            notices: self.notices,
        })
    }
}

/// What components of these numbers are, and whether that is known for sure: told as libjpeg does.
fn colors(ids: &[u8], has_jfif: bool, adobe_transform: Option<u8>) -> (ColorTransform, bool) {
    match (ids.len(), adobe_transform) {
        (1, _) => (ColorTransform::Grayscale, true),
        (3, _) if has_jfif => (ColorTransform::YCbCr, true),
        (3, Some(0)) => (ColorTransform::RGB, true),
        (3, None) if ids == b"RGB" => (ColorTransform::RGB, true),
        (3, transform) => (ColorTransform::YCbCr, matches!(transform, None | Some(1))),
        (_, None | Some(0)) => (ColorTransform::CMYK, true),
        (_, transform) => (ColorTransform::YCCK, transform == Some(2)),
    }
}
