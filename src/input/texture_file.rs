use super::error::InputError;
use crate::texture::Texture;
use image::error::{ImageFormatHint, UnsupportedError, UnsupportedErrorKind};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use std::io::{self, Cursor};
use std::path::Path;

/// 16,384 x 16,384: a file of a few bytes can claim any number, and memory is taken for all of them.
const MOST_TEXELS: u64 = 1 << 28;

/// Decodes a PNG, JPEG, BMP or TGA file. Also returns what of it is not used.
///
/// Files are decoded by content, or by name where the content does not tell.
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
    // Floats of linear light, which would be taken for sRGB.
    if reader.format() == Some(ImageFormat::OpenExr) {
        let format = ImageFormatHint::Exact(ImageFormat::OpenExr);
        let kind = UnsupportedErrorKind::Format(format.clone());
        let error = UnsupportedError::from_format_and_kind(format, kind);
        return Err(refuse(image::ImageError::Unsupported(error)));
    }
    if reader.format() == Some(ImageFormat::Jpeg) && is_cut_jpeg(bytes) {
        let error = io::Error::new(io::ErrorKind::UnexpectedEof, "the file is cut off");
        return Err(refuse(error.into()));
    }
    let decoder = reader.into_decoder().map_err(refuse)?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > MOST_TEXELS {
        return Err(InputError::LargeImage {
            file: file.to_owned(),
            width,
            height,
            most: MOST_TEXELS,
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

/// Whether the end is missing, in place of which the decoder would give grey: no end of image stands
/// after the start of the first scan. What comes before that is in segments that tell their length.
fn is_cut_jpeg(bytes: &[u8]) -> bool {
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
    // No scan: the decoder says so.
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
