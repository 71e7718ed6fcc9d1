//! Decoding of texture images: PNG, JPEG, BMP and TGA.

use super::error::InputError;
use super::jpeg::{self, Fault};
use crate::memory::{check_room, room};
use crate::texture::Texture;
use image::error::{DecodingError, ImageFormatHint, LimitError, LimitErrorKind};
use image::error::{UnsupportedError, UnsupportedErrorKind};
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};
use std::io::Cursor;
use std::path::Path;

/// 16,384 x 16,384: a header can claim any size, and memory is allocated for all of it.
const MAX_TEXELS: u64 = 1 << 28;

/// About the most memory that a texel takes while an image is decoded and converted.
const BYTES_PER_TEXEL: u64 = 20;

/// Decodes an image file. Also returns a notice of what of it is not used or damaged.
///
/// The format is told by the content, or by the file's name where the content does not tell.
pub(super) fn decode(file: &Path, bytes: &[u8]) -> Result<(Texture, Option<String>), InputError> {
    let refuse = |source| refuse(file, source);
    let mut reader = ImageReader::new(Cursor::new(bytes));
    if let Ok(format) = ImageFormat::from_path(file) {
        reader.set_format(format);
    }
    let reader = reader.with_guessed_format().map_err(|e| refuse(e.into()))?;
    match reader.format() {
        Some(ImageFormat::Jpeg) => return decode_jpeg(file, bytes),
        // Its floats are linear and would be taken for sRGB.
        Some(format @ (ImageFormat::OpenExr | ImageFormat::Hdr)) => {
            let format = ImageFormatHint::Exact(format);
            let kind = UnsupportedErrorKind::Format(format.clone());
            let error = UnsupportedError::from_format_and_kind(format, kind);
            return Err(refuse(ImageError::Unsupported(error)));
        }
        _ => {}
    }
    let decoder = reader.into_decoder().map_err(refuse)?;
    let (width, height) = decoder.dimensions();
    check_size(file, width, height, BYTES_PER_TEXEL)?;
    let image = DynamicImage::from_decoder(decoder).map_err(refuse)?;
    let notice = unused(&image).map(str::to_owned);
    let rgb = image.into_rgb8();
    let (width, height) = (rgb.width() as usize, rgb.height() as usize);
    let texels = rgb.into_raw().as_chunks().0.to_vec();
    Ok((texture(file, width, height, texels)?, notice))
}

fn decode_jpeg(file: &Path, bytes: &[u8]) -> Result<(Texture, Option<String>), InputError> {
    let fitting = room().map_or(MAX_TEXELS, |room| room.left() / BYTES_PER_TEXEL);
    let decoded = jpeg::decode(bytes, MAX_TEXELS.min(fitting)).map_err(|fault| {
        let message = match fault {
            Fault::Refused(message) => message,
            Fault::Large { width, height } => {
                return match check_size(file, width, height, BYTES_PER_TEXEL) {
                    Err(error) => error,
                    // There is more room by now.
                    Ok(()) => refuse(
                        file,
                        ImageError::Limits(LimitError::from_kind(
                            LimitErrorKind::InsufficientMemory,
                        )),
                    ),
                };
            }
        };
        let format = ImageFormatHint::Exact(ImageFormat::Jpeg);
        refuse(
            file,
            ImageError::Decoding(DecodingError::new(format, message)),
        )
    })?;
    let notices = decoded.notices.join("; ");
    let texture = texture(file, decoded.width, decoded.height, decoded.texels)?;
    Ok((texture, Some(notices).filter(|notices| !notices.is_empty())))
}

fn texture(
    file: &Path,
    width: usize,
    height: usize,
    texels: Vec<[u8; 3]>,
) -> Result<Texture, InputError> {
    Texture::new(width, height, texels).ok_or_else(|| {
        let kind = LimitErrorKind::DimensionError;
        refuse(file, ImageError::Limits(LimitError::from_kind(kind)))
    })
}

fn refuse(file: &Path, source: ImageError) -> InputError {
    InputError::Image {
        file: file.to_owned(),
        source,
    }
}

/// Checks that an image is not too large, and that it fits into memory while it is decoded.
pub(super) fn check_size(
    file: &Path,
    width: u32,
    height: u32,
    bytes_per_texel: u64,
) -> Result<(), InputError> {
    let texels = u64::from(width) * u64::from(height);
    if texels > MAX_TEXELS {
        return Err(InputError::LargeImage {
            file: file.to_owned(),
            width,
            height,
            most: MAX_TEXELS,
        });
    }
    let need = texels * bytes_per_texel;
    let what = format!("{}: an image of {width}x{height} texels", file.display());
    Ok(check_room(&what, need, "make it smaller")?)
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
