//! What a JPEG file says of its picture: its size and its components (ITU-T T.81, annex B.2.2).

use super::fault::{Fault, damaged, unsupported};
use super::huffman::Codes;

/// As libjpeg.
const MAX_SIDE: u32 = 65_500;

/// A picture's size and coding.
#[derive(Debug)]
pub(super) struct Frame {
    pub(super) is_progressive: bool,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) components: Vec<Component>,
}

/// Samples of one kind: brightness, or a colour.
#[derive(Debug)]
pub(super) struct Component {
    pub(super) id: u8,
    /// Blocks of a minimum coded unit, horizontally and vertically, where components are interleaved.
    pub(super) sampling: [u32; 2],
    /// The quantization table, by its number in the file.
    pub(super) quantization: u8,
    /// How many low bits of each coefficient are unknown; none if all are.
    pub(super) unknown_bits: [Option<u8>; 64],
    /// Which coefficients of each block are not zero; empty before the first progressive scan of AC coefficients.
    pub(super) nonzero: Vec<u64>,
}

impl Frame {
    pub(super) fn parse(content: &[u8], is_progressive: bool) -> Result<Frame, Fault> {
        let [precision, y1, y0, x1, x0, count, components @ ..] = content else {
            return Err(damaged("its frame header is too short"));
        };
        let height = u32::from(u16::from_be_bytes([*y1, *y0]));
        let width = u32::from(u16::from_be_bytes([*x1, *x0]));
        let (components, rest) = components.as_chunks::<3>();
        if components.len() != usize::from(*count) || !rest.is_empty() {
            return Err(damaged("its frame header has a wrong length"));
        }
        if *precision != 8 {
            return Err(unsupported(&format!(
                "a JPEG file of {precision}-bit samples"
            )));
        }
        if !matches!(count, 1 | 3 | 4) {
            return Err(unsupported(&format!("a JPEG file of {count} components")));
        }
        if width == 0 || height == 0 {
            return Err(unsupported(
                "a JPEG file whose header does not say its size",
            ));
        }
        if width.max(height) > MAX_SIDE {
            return Err(unsupported(&format!(
                "a JPEG file of more than {MAX_SIDE} texels a side"
            )));
        }
        let mut frame = Frame {
            is_progressive,
            width,
            height,
            components: Vec::new(),
        };
        for [id, sampling, quantization] in components {
            let mut sampling = [sampling >> 4, sampling & 15].map(u32::from);
            if sampling.iter().any(|factor| !(1..=4).contains(factor)) || *quantization > 3 {
                return Err(damaged("its frame header is wrong"));
            }
            if frame.components.iter().any(|other| other.id == *id) {
                return Err(damaged("two of its components have the same number"));
            }
            // A single component is not interleaved.
            if *count == 1 {
                sampling = [1, 1];
            }
            frame.components.push(Component {
                id: *id,
                sampling,
                quantization: *quantization,
                unknown_bits: [None; 64],
                nonzero: Vec::new(),
            });
        }
        for axis in [0, 1] {
            let most = frame.max_sampling(axis);
            let mut factors = frame.components.iter().map(|c| c.sampling[axis]);
            if factors.any(|factor| !most.is_multiple_of(factor)) {
                return Err(unsupported("a JPEG file of fractional sampling factors"));
            }
        }
        Ok(frame)
    }

    fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    fn max_sampling(&self, axis: usize) -> u32 {
        let factors = self.components.iter().map(|c| c.sampling[axis]);
        factors.max().expect("a frame has components")
    }

    /// Columns and rows of minimum coded units in a scan of several components.
    pub(super) fn interleaved_units(&self) -> [u32; 2] {
        [0, 1].map(|axis| self.size()[axis].div_ceil(8 * self.max_sampling(axis)))
    }

    /// Columns and rows of blocks in a scan of this component alone.
    pub(super) fn blocks(&self, component: &Component) -> [u32; 2] {
        [0, 1].map(|axis| {
            let samples = self.size()[axis] * component.sampling[axis];
            samples.div_ceil(self.max_sampling(axis)).div_ceil(8)
        })
    }

    /// Whether everything that can be known of each coefficient is.
    pub(super) fn is_complete(&self) -> bool {
        let mut components = self.components.iter();
        components.all(|component| component.unknown_bits == [Some(0); 64])
    }
}

/// The tables that scans refer to by number.
#[derive(Debug, Default)]
pub(super) struct TableSet {
    pub(super) quantization: [Option<[u16; 64]>; 4],
    pub(super) dc: [Option<Codes>; 4],
    pub(super) ac: [Option<Codes>; 4],
}

impl TableSet {
    pub(super) fn define_huffman(&mut self, mut content: &[u8]) -> Result<(), Fault> {
        let wrong = || damaged("one of its Huffman tables is wrong");
        while let [class_and_number, codes @ ..] = content {
            let (class, number) = (class_and_number >> 4, class_and_number & 15);
            let (codes, rest) = Codes::parse(codes).ok_or_else(wrong)?;
            let tables = match class {
                0 if codes.are_sizes() => &mut self.dc,
                1 => &mut self.ac,
                _ => return Err(wrong()),
            };
            *tables.get_mut(usize::from(number)).ok_or_else(wrong)? = Some(codes);
            content = rest;
        }
        Ok(())
    }

    pub(super) fn define_quantization(&mut self, mut content: &[u8]) -> Result<(), Fault> {
        let wrong = || damaged("one of its quantization tables is wrong");
        while let [precision_and_number, values @ ..] = content {
            let mut table = [0; 64];
            let size = match precision_and_number >> 4 {
                0 => 1,
                1 => 2,
                _ => return Err(wrong()),
            };
            let (values, rest) = values.split_at_checked(64 * size).ok_or_else(wrong)?;
            for (entry, value) in table.iter_mut().zip(values.chunks_exact(size)) {
                *entry = value
                    .iter()
                    .fold(0, |number, &byte| number << 8 | u16::from(byte));
            }
            if table.contains(&0) {
                return Err(wrong());
            }
            let number = usize::from(precision_and_number & 15);
            *self.quantization.get_mut(number).ok_or_else(wrong)? = Some(table);
            content = rest;
        }
        Ok(())
    }
}
