use super::error::InputError;
use crate::texture::Texture;
use image::{DynamicImage, ImageReader};
use std::io::Cursor;
use std::path::Path;

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
    if let Ok(format) = image::ImageFormat::from_path(file) {
        reader.set_format(format);
    }
    let mut reader = reader.with_guessed_format().map_err(|e| refuse(e.into()))?;
    reader.no_limits();
    let image = reader.decode().map_err(refuse)?;
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

fn unused(image: &DynamicImage) -> Option<&'static str> {
    use DynamicImage::{ImageLuma16, ImageRgb16};
    let transparent =
        image.color().has_alpha() && image.to_rgba8().pixels().any(|texel| texel[3] < 255);
    if transparent {
        return Some("its transparency is not used");
    }
    matches!(image, ImageLuma16(_) | ImageRgb16(_)).then_some("its 16 bits are rounded to 8")
}
