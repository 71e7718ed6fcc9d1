use crate::film::Film;
use image::{ImageFormat, Rgb32FImage};
use std::io::{self, Cursor};

/// How a frame is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameFormat {
    /// 8 bits for each channel, sRGB.
    Png,
    /// 16 bits for each channel, sRGB.
    Png16,
    /// 32-bit floats, linear light, OpenEXR.
    Exr,
}

impl FrameFormat {
    /// The ending of a file's name, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            FrameFormat::Png | FrameFormat::Png16 => "png",
            FrameFormat::Exr => "exr",
        }
    }

    /// The bytes of a file that holds `film`; the same for the same film.
    pub fn encode(self, film: &Film) -> io::Result<Vec<u8>> {
        match self {
            FrameFormat::Png => png_file(film, png::BitDepth::Eight, &film.to_srgb8()),
            FrameFormat::Png16 => png_file(film, png::BitDepth::Sixteen, &film.to_srgb16_be()),
            FrameFormat::Exr => exr_file(film),
        }
    }
}

fn png_file(film: &Film, depth: png::BitDepth, samples: &[u8]) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, film.width(), film.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(depth);
    // Without a tag, programs guess the colour space, and guess differently.
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    // Stronger settings cost many times the encoding time for a few per cent of size.
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(samples)?;
    writer.finish()?;
    Ok(bytes)
}

fn exr_file(film: &Film) -> io::Result<Vec<u8>> {
    let channels = film.pixels().iter().flat_map(|p| p.to_array()).collect();
    let image = Rgb32FImage::from_raw(film.width(), film.height(), channels)
        .ok_or_else(|| io::Error::other("film has not three channels for each pixel"))?;
    let mut bytes = Cursor::new(Vec::new());
    image
        .write_to(&mut bytes, ImageFormat::OpenExr)
        .map_err(io::Error::other)?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn film() -> Film {
        let mut film = Film::new(3, 2);
        for (i, pixel) in film.pixels_mut().iter_mut().enumerate() {
            *pixel = Vec3::new(0.1 * i as f32, 0.5, 1.5);
        }
        film
    }

    #[test]
    fn png_files_hold_the_codes_and_say_srgb() {
        for (format, codes) in [
            (FrameFormat::Png, film().to_srgb8()),
            (FrameFormat::Png16, film().to_srgb16_be()),
        ] {
            let bytes = format.encode(&film()).expect("encodes");
            let mut reader = png::Decoder::new(Cursor::new(bytes))
                .read_info()
                .expect("a PNG");
            assert!(reader.info().srgb.is_some());
            let mut samples = vec![0; codes.len()];
            let info = reader.next_frame(&mut samples).expect("whole");
            assert_eq!((info.width, info.height), (3, 2));
            assert_eq!(samples, codes);
        }
    }

    #[test]
    fn exr_files_hold_the_floats() {
        let bytes = FrameFormat::Exr.encode(&film()).expect("encodes");
        let image = image::load_from_memory(&bytes)
            .expect("an EXR")
            .into_rgb32f();
        let channels: Vec<f32> = film().pixels().iter().flat_map(|p| p.to_array()).collect();
        assert_eq!(image.into_raw(), channels);
    }
}
