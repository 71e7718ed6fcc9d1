//! Decoding of JPEG files, the damaged ones of which are refused.
//!
//! The decoder fills what is missing with grey, and does not say so. Therefore [`check`] reads all codes of the file
//! first. Where pixels are lost, the file is refused. Other damage that libjpeg warns of is a notice. The decoder then
//! gets the picture alone, in a plain form, and never sees a file that is damaged or hostile.

mod blocks;
mod check;
mod fault;
mod frame;
mod huffman;
mod marker;
mod scan;
mod segments;

use jpeg_decoder::{ColorTransform, Decoder};

pub(super) use fault::Fault;

/// The texels of a picture.
#[derive(Debug)]
pub(super) struct Decoded {
    pub(super) width: usize,
    pub(super) height: usize,
    /// sRGB, by rows from the top.
    pub(super) texels: Vec<[u8; 3]>,
    /// What is wrong with the file without loss to the picture.
    pub(super) notices: Vec<String>,
}

/// Decodes a file whose picture is whole and has at most `max_texels`.
pub(super) fn decode(bytes: &[u8], max_texels: u64) -> Result<Decoded, Fault> {
    let picture = check::check(bytes, max_texels)?;
    let mut decoder = Decoder::new(&picture.bytes[..]);
    decoder.set_color_transform(picture.colors);
    let samples = decoder
        .decode()
        .map_err(|error| Fault::Refused(error.to_string()))?;
    let size = decoder.info().expect("the picture is decoded");
    let texels = match picture.colors {
        ColorTransform::Grayscale => samples.iter().map(|&grey| [grey; 3]).collect(),
        ColorTransform::CMYK | ColorTransform::YCCK => samples
            .as_chunks()
            .0
            .iter()
            .map(|&inks| rgb_of_inks(inks))
            .collect(),
        _ => samples.as_chunks().0.to_vec(),
    };
    Ok(Decoded {
        width: size.width.into(),
        height: size.height.into(),
        texels,
        notices: picture.notices,
    })
}

/// The colour that cyan, magenta, yellow and black inks leave of white; 255 is all of an ink.
fn rgb_of_inks([cyan, magenta, yellow, black]: [u8; 4]) -> [u8; 3] {
    [cyan, magenta, yellow].map(|ink| {
        let left = u32::from(255 - ink) * u32::from(255 - black);
        ((2 * left + 255) / 510) as u8
    })
}
