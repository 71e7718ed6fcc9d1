//! Renders pre-recorded camera fly-throughs: a scene and a keyframed camera path in, numbered frames out.
//!
//! Frame 10 of a camera path, as a PNG file:
//!
//! ```
//! use flythrough::camera_formats::load_camera_path;
//! use flythrough::frames::write_png;
//! use flythrough::input::{InputFiles, Settings, load_scene};
//! use flythrough::render::Renderer;
//!
//! # let folder = tempfile::tempdir()?;
//! # let file = folder.path().join("frame_00010.png");
//! let mut files = InputFiles::default();
//! let scene = load_scene("scenes/test3.ron".as_ref(), &mut files)?;
//! let path = load_camera_path("paths/test3.ron".as_ref(), &mut files)?;
//! let settings = Settings { size: Some((64, 48)), ..path.settings.or(scene.settings) };
//!
//! let renderer = Renderer::new(&scene.scene, settings.resolve(1), None)?;
//! let mut film = renderer.render_frame(&path.path.camera(10), 10).film;
//! film.expose(settings.exposure.unwrap_or(0.0));
//! write_png(&film, 10, &file)?;
//! # assert_eq!(image::open(&file)?.into_rgb8().into_raw(), film.to_srgb8_dithered(10));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `tests/examples/` has programs that do this, pipe a sequence as raw video, and print the camera of every frame.
//! A library needs no features: those of the program, its charts among them, are behind `cli`, which is on by default.
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
//! | 0 | [`math`], [`sampling`], [`memory`], [`storage`], [`text`] | anything above |
//! | 1 | [`simd`], [`geometry`], [`texture`], [`film`] | files, threads, the scene |
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
#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "plots")]
pub mod drawing;
pub mod film;
#[cfg(feature = "cli")]
pub mod forecast;
pub mod frames;
pub mod geometry;
pub mod input;
pub mod integrator;
pub mod irradiance_cache;
#[cfg(feature = "cli")]
pub mod job;
pub mod light;
pub mod material;
pub mod math;
pub mod memory;
pub mod metrics;
pub mod preflight;
pub mod render;
#[cfg(feature = "cli")]
pub mod report;
pub mod sampling;
pub mod scene;
#[cfg(feature = "cli")]
pub mod selftest;
pub mod simd;
pub mod storage;
pub mod text;
pub mod texture;
