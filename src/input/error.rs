//! What can be wrong with an input file.

use crate::memory::MemoryError;
use crate::storage::FileError;
use image::error::ImageFormatHint;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// An error in an input file: where it is and what to do about it.
#[derive(Debug, Error)]
pub enum InputError {
    /// A file could not be read.
    #[error(transparent)]
    Read(#[from] FileError),
    /// The scene needs more memory than there is.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// A file that another one names could not be read.
    #[error(
        "{file}: {key} names {missing}, which cannot be read: {source}; file names are relative to \
         the folder of the file that names them",
        file = .file.display(), missing = .missing.display()
    )]
    Reference {
        /// The file that names it.
        file: PathBuf,
        /// Where in that file.
        key: String,
        /// The file that is named.
        missing: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The text does not follow the file's syntax.
    #[error("{file}:{line}:{column}: {message}", file = .file.display())]
    Syntax {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What is wrong there.
        message: String,
    },
    /// A value is not one that can be rendered.
    #[error("{file}: {key}: {message}", file = .file.display())]
    Value {
        /// The file.
        file: PathBuf,
        /// Which value, as in `objects[3].radius`.
        key: String,
        /// What is wrong with it and what to write instead.
        message: String,
    },
    /// A statement of an OBJ or MTL file is wrong.
    #[error("{file}:{line}: {message}", file = .file.display())]
    Model {
        /// The file.
        file: PathBuf,
        /// The line, from 1, at or after that of the fault.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// A file that is named as a model is no OBJ file.
    #[error("{file}: is no OBJ model: {seems}", file = .file.display())]
    NotObj {
        /// The file.
        file: PathBuf,
        /// What it seems to be, and what to do.
        seems: String,
    },
    /// An image cannot be decoded.
    #[error("{file}: cannot be decoded as an image: {source}", file = .file.display())]
    Image {
        /// The file.
        file: PathBuf,
        /// What the decoder says.
        source: image::ImageError,
    },
    /// An image is too large for a texture, or for the sky.
    #[error(
        "{file}: an image of {width}x{height} texels; a texture may have up to {most}: make it smaller",
        file = .file.display()
    )]
    LargeImage {
        /// The file.
        file: PathBuf,
        /// Its columns.
        width: u32,
        /// Its rows.
        height: u32,
        /// The largest number of texels.
        most: u64,
    },
    /// A file that is named as an image of the sky has no linear light.
    #[error(
        "{file}: its format is {format}; an image of the sky is an OpenEXR or a Radiance HDR file",
        file = .file.display()
    )]
    NotSky {
        /// The file.
        file: PathBuf,
        /// Its format.
        format: ImageFormatHint,
    },
    /// A texel of an image is no radiance.
    #[error(
        "{file}: texel ({column}, {row}), from the upper left, is ({}, {}, {}): every channel must lie between 0 and \
         {most:e}, also times the intensity",
        channels[0], channels[1], channels[2], file = .file.display()
    )]
    Texel {
        /// The file.
        file: PathBuf,
        /// Its column, from 0.
        column: u32,
        /// Its row, from 0.
        row: u32,
        /// Its channels in the file.
        channels: [f32; 3],
        /// The largest channel, in W/(sr m²).
        most: f64,
    },
}
