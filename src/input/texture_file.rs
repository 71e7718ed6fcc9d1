//! Decoding of texture images: PNG, JPEG, BMP and TGA.

use super::error::InputError;
use crate::texture::Texture;
use image::error::{ImageFormatHint, UnsupportedError, UnsupportedErrorKind};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use std::io::{self, Cursor};
use std::path::Path;

/// 16,384 x 16,384: a header can claim any size, and memory is allocated for all of it.
const MAX_TEXELS: u64 = 1 << 28;

/// Decodes an image file. Also returns a notice of what of it is not used.
///
/// The format is told by the content, or by the file's name where the content does not tell.
pub(super) fn decode(
    file: &Path,
    bytes: &[u8],
) -> Result<(Texture, Option<&'static str>), InputError> {
    let refuse = |source| InputError::Image {
        file: file.to_owned(),
        source,
    };
    let mut reader = ImageReader::new(Cursor::new(bytes));
    if let Ok(format) = ImageFormat::from_path(file) {
        reader.set_format(format);
    }
    let reader = reader.with_guessed_format().map_err(|e| refuse(e.into()))?;
    // Its floats are linear and would be taken for sRGB.
    if reader.format() == Some(ImageFormat::OpenExr) {
        let format = ImageFormatHint::Exact(ImageFormat::OpenExr);
        let kind = UnsupportedErrorKind::Format(format.clone());
        let error = UnsupportedError::from_format_and_kind(format, kind);
        return Err(refuse(image::ImageError::Unsupported(error)));
    }
    if reader.format() == Some(ImageFormat::Jpeg) && is_truncated_jpeg(bytes) {
        let error = io::Error::new(io::ErrorKind::UnexpectedEof, "the file is truncated");
        return Err(refuse(error.into()));
    }
    let decoder = reader.into_decoder().map_err(refuse)?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > MAX_TEXELS {
        return Err(InputError::LargeImage {
            file: file.to_owned(),
            width,
            height,
            most: MAX_TEXELS,
        });
    }
    let image = DynamicImage::from_decoder(decoder).map_err(refuse)?;
    let notice = unused(&image);
    let rgb = image.into_rgb8();
    let (width, height) = (rgb.width() as usize, rgb.height() as usize);
    let texels = rgb.into_raw().as_chunks().0.to_vec();
    let texture = Texture::new(width, height, texels).ok_or_else(|| {
        refuse(image::ImageError::Limits(
            image::error::LimitError::from_kind(image::error::LimitErrorKind::DimensionError),
        ))
    })?;
    Ok((texture, notice))
}

/// Whether the end of a JPEG file is missing, which the decoder would fill with grey: no end-of-image marker follows
/// the start of the first scan. The segments before that give their lengths.
fn is_truncated_jpeg(bytes: &[u8]) -> bool {
    const START_OF_SCAN: u8 = 0xda;
    const END_OF_IMAGE: [u8; 2] = [0xff, 0xd9];
    let mut rest = bytes.get(2..).unwrap_or_default();
    while let [0xff, marker, high, low, ..] = rest {
        if *marker == 0xff {
            rest = &rest[1..];
            continue;
        }
        if *marker == START_OF_SCAN {
            return !rest.windows(2).any(|pair| pair == END_OF_IMAGE);
        }
        let length = 2 + usize::from(u16::from_be_bytes([*high, *low]));
        rest = rest.get(length..).unwrap_or_default();
    }
    // No scan: the decoder reports it.
    false
}

fn unused(image: &DynamicImage) -> Option<&'static str> {
    use DynamicImage::{ImageLuma16, ImageRgb16};
    let transparent =
        image.color().has_alpha() && image.to_rgba8().pixels().any(|texel| texel[3] < 255);
    if transparent {
        return Some("its transparency is not used");
    }
    matches!(image, ImageLuma16(_) | ImageRgb16(_)).then_some("its 16 bits are rounded to 8")
}
