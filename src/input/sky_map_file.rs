//! Decoding of images of the sky: OpenEXR and Radiance HDR, whose floats are linear radiance.

use super::check::MAX_RADIANCE;
use super::error::InputError;
use super::texture_file::check_size;
use crate::light::SkyMap;
use glam::Vec3;
use image::error::{ImageFormatHint, LimitError, LimitErrorKind};
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};
use std::io::Cursor;
use std::path::Path;

/// About the most memory that a texel takes while an image is decoded and converted: four channels twice, and three.
const BYTES_PER_TEXEL: u64 = 44;

/// Decodes an image file, its radiance times `intensity`, rotated about +Y, in radians. An alpha channel is not used.
///
/// The format is told by the content.
pub(super) fn decode(
    file: &Path,
    bytes: &[u8],
    intensity: f64,
    rotation: f64,
) -> Result<SkyMap, InputError> {
    let refuse = |source| InputError::Image {
        file: file.to_owned(),
        source,
    };
    let reader = ImageReader::new(Cursor::new(bytes));
    let reader = reader.with_guessed_format().map_err(|e| refuse(e.into()))?;
    if !matches!(
        reader.format(),
        Some(ImageFormat::OpenExr | ImageFormat::Hdr)
    ) {
        return Err(InputError::NotSky {
            file: file.to_owned(),
            format: reader
                .format()
                .map_or(ImageFormatHint::Unknown, ImageFormatHint::Exact),
        });
    }
    let decoder = reader.into_decoder().map_err(refuse)?;
    let (width, height) = decoder.dimensions();
    check_size(file, width, height, BYTES_PER_TEXEL)?;
    let image = DynamicImage::from_decoder(decoder).map_err(refuse)?;
    let texels = image.into_rgb32f().into_raw();
    let mut radiance = Vec::with_capacity(texels.len() / 3);
    for (number, &channels) in texels.as_chunks::<3>().0.iter().enumerate() {
        let lit = channels.map(|channel| f64::from(channel) * intensity);
        // Not a number is in no range; -1 times an intensity of 0 would be.
        let is_radiance = channels.iter().all(|channel| *channel >= 0.0)
            && lit.iter().all(|channel| *channel <= MAX_RADIANCE);
        if !is_radiance {
            let number = number as u32;
            return Err(InputError::Texel {
                file: file.to_owned(),
                column: number % width,
                row: number / width,
                channels,
                most: MAX_RADIANCE,
            });
        }
        radiance.push(Vec3::from_array(lit.map(|channel| channel as f32)));
    }
    let map = SkyMap::new(width as usize, height as usize, radiance, rotation);
    map.ok_or_else(|| {
        let kind = LimitErrorKind::DimensionError;
        refuse(ImageError::Limits(LimitError::from_kind(kind)))
    })
}
