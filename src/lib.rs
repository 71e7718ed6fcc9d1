//! Renders pre-recorded camera fly-throughs.
//!
//! Data flows one way: scene and camera path files → resolved scene and camera path → frame →
//! film → image file. What is parsed is checked and resolved once, in [`input`]; the tracer sees
//! no strings, no missing values, no degrees.
//!
//! Conventions, everywhere inside: right-handed world with +Y up, the camera looks along −Z;
//! metres, seconds, radians; colours are linear RGB with sRGB primaries until the film is encoded.
//!
//! Modules import only from lower layers:
//!
//! | layer | modules | never know |
//! |---|---|---|
//! | 0 | [`math`], [`storage`] | anything above |
//! | 1 | [`simd`], [`sampling`], [`geometry`], [`texture`], [`film`] | files, threads, the scene |
//! | 2 | [`accel`], [`material`], [`light`], [`camera`], [`metrics`], [`irradiance_cache`] | each other, files, threads |
//! | 3 | [`scene`] | how light is gathered, files |
//! | 4 | [`integrator`] | pixels, frames, time |
//! | 5 | [`render`] | file formats, folders, terminals |
//! | 6 | [`bake`], [`preflight`], [`drawing`] | terminals, each other |
//! | 7 | [`input`], [`frames`], [`selftest`] | each other, the command line |
//! | 8 | [`camera_formats`] | frames, the command line |
//! | 9 | [`report`], [`forecast`] | each other, the command line |
//! | 10 | [`job`] | terminals |
//! | 11 | [`cli`] | the mathematics |

pub mod accel;
pub mod bake;
pub mod camera;
pub mod camera_formats;
pub mod cli;
pub mod drawing;
pub mod film;
pub mod forecast;
pub mod frames;
pub mod geometry;
pub mod input;
pub mod integrator;
pub mod irradiance_cache;
pub mod job;
pub mod light;
pub mod material;
pub mod math;
pub mod metrics;
pub mod preflight;
pub mod render;
pub mod report;
pub mod sampling;
pub mod scene;
pub mod selftest;
pub mod simd;
pub mod storage;
pub mod texture;
