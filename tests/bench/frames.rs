//! Seconds and rays of whole frames, by mode: `cargo bench --bench frames`.
//!
//! `cargo bench --bench frames -- test3` runs the rows whose names contain the word. Each row is
//! the median of five runs, the first of which is not counted, on all threads.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a benchmark prints or fails"
)]

use flythrough::input::{InputFiles, Settings, load_camera_path, load_scene};
use flythrough::render::render_frame;
use std::path::Path;
use std::time::Instant;

const RUNS: usize = 5;

/// Name, scene, path, frame, settings.
fn rows() -> Vec<(&'static str, &'static str, &'static str, u32, Settings)> {
    let settings = |mode: &str, size, samples, splits: &[u32]| Settings {
        mode: Some(mode.parse().unwrap()),
        size: Some(size),
        samples,
        splits: Some(splits.to_vec()),
        ..Settings::default()
    };
    let small = (320, 240);
    let hd = (1280, 720);
    vec![
        (
            "test3 raytracing",
            "test3",
            "test3",
            0,
            settings("raytracing", small, None, &[]),
        ),
        (
            "test3 supersampling",
            "test3",
            "test3",
            0,
            settings("supersampling", small, None, &[]),
        ),
        (
            "test3 montecarlo, 64 paths from 2 camera samples",
            "test3",
            "test3",
            0,
            settings("montecarlo", small, Some(2), &[32]),
        ),
        (
            "test3 montecarlo, 64 paths from 64 camera samples",
            "test3",
            "test3",
            0,
            settings("montecarlo", small, Some(64), &[1]),
        ),
        (
            "test2 montecarlo, 32 paths",
            "test2",
            "zoom",
            0,
            settings("montecarlo", small, None, &[32]),
        ),
        (
            "gallery raytracing, 720p, 4 samples",
            "gallery",
            "gallery",
            100,
            settings("raytracing", hd, Some(4), &[]),
        ),
        (
            "gallery supersampling, 720p",
            "gallery",
            "gallery",
            100,
            settings("supersampling", hd, None, &[]),
        ),
    ]
}

fn main() {
    let wanted: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    println!("| frame | seconds | rays | million rays per second |");
    println!("|---|---|---|---|");
    for (name, scene, path, frame, settings) in rows() {
        if !wanted.iter().all(|word| name.contains(word.as_str())) {
            continue;
        }
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut files = InputFiles::default();
        let scene = load_scene(&root.join(format!("scenes/{scene}.ron")), &mut files).unwrap();
        let path = load_camera_path(&root.join(format!("paths/{path}.ron")), &mut files).unwrap();
        let (camera, settings) = (path.path.camera(frame), settings.resolve());
        let mut rays = 0;
        let mut seconds: Vec<f64> = (0..=RUNS)
            .map(|_| {
                let start = Instant::now();
                rays = render_frame(&scene.scene, &camera, &settings, frame, &|_| ()).rays;
                start.elapsed().as_secs_f64()
            })
            .skip(1)
            .collect();
        seconds.sort_by(f64::total_cmp);
        let median = seconds[RUNS / 2];
        let rate = rays as f64 / median / 1e6;
        println!("| {name} | {median:.3} | {rays} | {rate:.1} |");
    }
}
