//! Scans of a JPEG file: what their headers say, and whether all of their blocks are there (ITU-T T.81, annex B.2.3).

use super::blocks::{Coding, Tables, read_block};
use super::fault::{Fault, damaged, unsupported};
use super::frame::{Frame, TableSet};
use super::huffman::{self, Bits, Codes};
use super::marker;
use super::segments::{Segments, write_entropy_coded, write_segment};

/// Blocks of a minimum coded unit.
const MAX_UNIT: u32 = 10;

/// More low bits than coefficients of 8-bit samples have.
const MAX_UNKNOWN_BITS: u8 = 13;

/// The header of a scan.
#[derive(Debug)]
pub(super) struct Scan {
    /// The numbers of its components in the frame, and of their tables for DC and AC coefficients.
    components: Vec<(usize, [u8; 2])>,
    /// The first and the last coefficient.
    band: [u8; 2],
    /// How many low bits of the coefficients are unknown before, if any bit is known, and after.
    unknown_bits: (Option<u8>, u8),
    coding: Coding,
}

impl Scan {
    /// What is wrong without consequences is a notice.
    pub(super) fn parse(
        content: &[u8],
        frame: &Frame,
        notices: &mut Vec<String>,
    ) -> Result<Scan, Fault> {
        let wrong = || damaged("the header of one of its scans is wrong");
        let [count, content @ ..] = content else {
            return Err(wrong());
        };
        let (ids, parameters) = content.as_chunks::<2>();
        // The three parameters are one pair and a byte.
        let Some((&[first, last], ids)) = ids.split_last() else {
            return Err(wrong());
        };
        let &[precision] = parameters else {
            return Err(wrong());
        };
        if ids.is_empty() || ids.len() != usize::from(*count) {
            return Err(wrong());
        }
        let mut components: Vec<(usize, [u8; 2])> = Vec::new();
        for &[id, tables] in ids {
            let number = frame.components.iter().position(|other| other.id == id);
            let number = number.ok_or_else(wrong)?;
            if components.iter().any(|&(before, _)| before >= number) {
                return Err(damaged(
                    "the components of one of its scans are out of order",
                ));
            }
            components.push((number, [tables >> 4, tables & 15]));
        }
        let (before, after) = (precision >> 4, precision & 15);
        let mut scan = Scan {
            components,
            band: [first, last],
            unknown_bits: ((before > 0).then_some(before), after),
            coding: Coding::Sequential,
        };
        if frame.is_progressive {
            scan.coding = scan.progressive_coding().ok_or_else(wrong)?;
        } else if (first, last, precision) != (0, 63, 0) {
            notices.push("the header of one of its scans has unknown parameters".to_owned());
            (scan.band, scan.unknown_bits) = ([0, 63], (None, 0));
        }
        scan.check_units(frame)?;
        Ok(scan)
    }

    fn progressive_coding(&self) -> Option<Coding> {
        let (before, after) = self.unknown_bits;
        let range = self.band.map(u32::from);
        let is_valid_band = match range {
            [0, last] => last == 0,
            [first, last] => first <= last && last < 64 && self.components.len() == 1,
        };
        if !is_valid_band
            || after > MAX_UNKNOWN_BITS
            || before.is_some_and(|bits| bits != after + 1)
        {
            return None;
        }
        Some(match (range, before) {
            ([0, _], None) => Coding::DcFirst,
            ([0, _], Some(_)) => Coding::DcRefinement,
            (_, None) => Coding::AcFirst(range),
            (_, Some(_)) => Coding::AcRefinement(range),
        })
    }

    /// Refuses units that are too large, and those that jpeg-decoder counts wrongly: in a scan of one component, it
    /// takes the blocks that interleaving would add for blocks of the picture.
    fn check_units(&self, frame: &Frame) -> Result<(), Fault> {
        let (units, blocks) = self.units(frame);
        let [(number, _)] = self.components[..] else {
            return match blocks.iter().sum::<u32>() {
                0..=MAX_UNIT => Ok(()),
                _ => Err(damaged("the units of one of its scans are too large")),
            };
        };
        let (sampling, interleaved) =
            (frame.components[number].sampling, frame.interleaved_units());
        let sides = [frame.width, frame.height];
        let counted =
            |axis: usize| (interleaved[axis] * sampling[axis]).min(sides[axis].div_ceil(8));
        match units == [0, 1].map(counted) {
            true => Ok(()),
            false => Err(unsupported(
                "a JPEG file of such sampling factors whose components are not interleaved",
            )),
        }
    }

    /// Writes the tables that the scan needs, and returns those that its codes need.
    pub(super) fn write_tables(
        &self,
        frame: &Frame,
        defined: &TableSet,
        picture: &mut Vec<u8>,
    ) -> Result<Vec<Tables>, Fault> {
        let (needs_dc, needs_ac) = match self.coding {
            Coding::Sequential => (true, true),
            Coding::DcFirst => (true, false),
            Coding::DcRefinement => (false, false),
            Coding::AcFirst(_) | Coding::AcRefinement(_) => (false, true),
        };
        let mut all = Vec::new();
        for &(number, [dc, ac]) in &self.components {
            let component = &frame.components[number];
            let number = number as u8;
            if component.unknown_bits == [None; 64] {
                let table = defined.quantization[usize::from(component.quantization)]
                    .ok_or(damaged("one of its quantization tables is missing"))?;
                let mut content = vec![0x10 | number];
                content.extend(table.iter().flat_map(|entry| entry.to_be_bytes()));
                write_segment(picture, marker::QUANTIZATION_TABLES, &content);
            }
            let mut take = |is_needed: bool, tables: &[Option<Codes>; 4], at: u8, class: u8| {
                if !is_needed {
                    return Ok(None);
                }
                let codes = tables.get(usize::from(at)).and_then(Option::as_ref);
                let codes = codes.ok_or(damaged("one of its Huffman tables is missing"))?;
                let content = [&[class << 4 | number], &codes.to_bytes()[..]].concat();
                write_segment(picture, marker::HUFFMAN_TABLES, &content);
                Ok(Some(codes.table()))
            };
            all.push(Tables {
                dc: take(needs_dc, &defined.dc, dc, 0)?,
                ac: take(needs_ac, &defined.ac, ac, 1)?,
            });
        }
        Ok(all)
    }

    /// The content of its header, for the tables that [`write_tables`](Self::write_tables) wrote.
    pub(super) fn header(&self) -> Vec<u8> {
        let mut content = vec![self.components.len() as u8];
        for &(number, _) in &self.components {
            let number = number as u8;
            content.extend([number, number << 4 | number]);
        }
        let (before, after) = self.unknown_bits;
        content.extend(self.band);
        content.push(before.unwrap_or(0) << 4 | after);
        content
    }

    /// Notes in the frame which bits the scan brings. Refuses bits that do not follow those before.
    pub(super) fn mark_known(&self, frame: &mut Frame) -> Result<(), Fault> {
        let (before, after) = self.unknown_bits;
        let [first, last] = self.band.map(usize::from);
        for &(number, _) in &self.components {
            let known = &mut frame.components[number].unknown_bits;
            let lacks_dc = first > 0 && known[0].is_none();
            if lacks_dc || known[first..=last].iter().any(|&bits| bits != before) {
                return Err(damaged("one of its scans is missing"));
            }
            known[first..=last].fill(Some(after));
        }
        Ok(())
    }

    /// Reads the scan's data, and writes what of it is of its blocks.
    pub(super) fn read(
        &self,
        frame: &mut Frame,
        tables: &[Tables],
        restart_interval: u32,
        file: &mut Segments,
        picture: &mut Vec<u8>,
    ) -> Result<(), Fault> {
        let ([columns, rows], blocks) = self.units(frame);
        let count = columns * rows;
        let place = |unit: u32| format!("{} % of the way down", unit / columns * 100 / rows);
        // Scans of AC coefficients, of one component, build on what is known of its blocks.
        let number = self.components[0].0;
        let nonzero = &mut frame.components[number].nonzero;
        let is_band = matches!(self.coding, Coding::AcFirst(_) | Coding::AcRefinement(_));
        if is_band {
            nonzero.resize(count as usize, 0);
        }
        let mut restarts = (0..8).cycle();
        let mut first = 0;
        loop {
            let end = match restart_interval {
                0 => count,
                interval => count.min(first + interval),
            };
            let mut bits = Bits::new(file.entropy_coded());
            let mut end_of_band_run = 0;
            for unit in first..end {
                let mut none = 0;
                let nonzero = if is_band {
                    &mut nonzero[unit as usize]
                } else {
                    &mut none
                };
                for (tables, &blocks) in tables.iter().zip(&blocks) {
                    for _ in 0..blocks {
                        read_block(
                            &mut bits,
                            self.coding,
                            tables,
                            nonzero,
                            &mut end_of_band_run,
                        )
                        .map_err(|fault| {
                            let what = match fault {
                                huffman::Fault::Short => "end",
                                huffman::Fault::Wrong => "are wrong",
                            };
                            damaged(&format!("its pixels {what} {}", place(unit)))
                        })?;
                    }
                }
            }
            // More data than blocks is harmless only behind what looks like the end.
            if end_of_band_run > 0 || bits.unread_bytes() > 0 && !bits.is_at_end() {
                let place = place(end - 1);
                return Err(damaged(&format!("its pixels are wrong {place}")));
            }
            file.extraneous += bits.unread_bytes();
            write_entropy_coded(picture, bits.read());
            if end == count {
                return Ok(());
            }
            let restart = restarts.next().map(|number| marker::RESTART_0 + number);
            if file.marker() != restart {
                let place = place(end);
                return Err(damaged(&format!("its pixels are missing {place}")));
            }
            picture.extend([0xff].into_iter().chain(restart));
            first = end;
        }
    }

    /// Columns and rows of minimum coded units, and the blocks of each component in such a unit.
    fn units(&self, frame: &Frame) -> ([u32; 2], Vec<u32>) {
        let components = self
            .components
            .iter()
            .map(|&(number, _)| &frame.components[number]);
        match &components.collect::<Vec<_>>()[..] {
            [alone] => (frame.blocks(alone), vec![1]),
            several => (
                frame.interleaved_units(),
                several
                    .iter()
                    .map(|component| component.sampling.iter().product())
                    .collect(),
            ),
        }
    }
}
