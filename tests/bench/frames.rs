//! Seconds and rays of whole frames: `cargo bench --bench frames`.
//!
//! By mode; on 1 to all threads; beside the rays of the frame alone. `cargo bench --bench frames --
//! test3` runs only the rows of the first table whose names contain the word. Times are the median of
//! five runs after one that is not counted, on all threads.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a benchmark prints or fails"
)]

use flythrough::accel::QueryState;
use flythrough::camera::Camera;
use flythrough::camera_formats::load_camera_path;
use flythrough::input::{InputFiles, Settings, load_scene};
use flythrough::material::FeatureMask;
use flythrough::math::Ray;
use flythrough::render::{RenderSettings, Renderer};
use flythrough::sampling::SobolSequence;
use flythrough::scene::{Scene, ShadowPacket, SurfacePointPacket};
use flythrough::simd::PACKET_WIDTH;
use glam::DVec2;
use rayon::prelude::*;
use std::path::Path;
use std::time::Instant;

const RUNS: usize = 5;

/// Name, scene, path, frame, settings.
fn rows() -> Vec<(&'static str, &'static str, &'static str, u32, Settings)> {
    let settings = |mode: &str, size, samples: &str, splits: &[u32]| Settings {
        mode: Some(mode.parse().unwrap()),
        size: Some(size),
        samples: Some(samples.parse().unwrap()),
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
            settings("raytracing", small, "center", &[]),
        ),
        (
            "test3 supersampling",
            "test3",
            "test3",
            0,
            settings("supersampling", small, "corners", &[]),
        ),
        (
            "test3 montecarlo, 64 paths from 4 camera samples",
            "test3",
            "test3",
            0,
            settings("montecarlo", small, "4", &[16]),
        ),
        (
            "test3 montecarlo, 64 paths from 64 camera samples",
            "test3",
            "test3",
            0,
            settings("montecarlo", small, "64", &[1]),
        ),
        (
            "test2 montecarlo, 32 paths",
            "test2",
            "zoom",
            0,
            settings("montecarlo", small, "center", &[32]),
        ),
        (
            "gallery montecarlo, 64 paths from 4 camera samples",
            "gallery",
            "gallery",
            100,
            settings("montecarlo", small, "4", &[16]),
        ),
        (
            "gallery raytracing, 720p, 4 samples",
            "gallery",
            "gallery",
            100,
            settings("raytracing", hd, "4", &[]),
        ),
        (
            "gallery supersampling, 720p",
            "gallery",
            "gallery",
            100,
            settings("supersampling", hd, "corners", &[]),
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
        if wanted.iter().all(|word| name.contains(word.as_str())) {
            let frame = Frame::load(scene, path, frame, settings);
            let (seconds, rays) = frame.render();
            let rate = rays as f64 / seconds / 1e6;
            println!("| {name} | {seconds:.3} | {rays} | {rate:.1} |");
        }
    }
    if wanted.is_empty() {
        let (name, scene, path, number, settings) = rows().remove(6);
        let frame = Frame::load(scene, path, number, settings);
        by_threads(name, &frame);
        beside_its_rays(name, &frame);
    }
}

struct Frame {
    scene: Scene,
    camera: Camera,
    settings: RenderSettings,
    number: u32,
}

impl Frame {
    fn load(scene: &str, path: &str, number: u32, settings: Settings) -> Frame {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut files = InputFiles::default();
        let scene = load_scene(&root.join(format!("scenes/{scene}.ron")), &mut files).unwrap();
        let path = load_camera_path(&root.join(format!("paths/{path}.ron")), &mut files).unwrap();
        Frame {
            scene: scene.scene,
            camera: path.path.camera(number),
            settings: settings.resolve(1),
            number,
        }
    }

    /// Seconds and rays.
    fn render(&self) -> (f64, u64) {
        let renderer = Renderer::new(&self.scene, self.settings.clone(), None).unwrap();
        let mut rays = 0;
        let seconds = median(|| {
            rays = renderer.render_frame(&self.camera, self.number).rays;
        });
        (seconds, rays)
    }
}

fn median(mut work: impl FnMut()) -> f64 {
    let mut seconds: Vec<f64> = (0..=RUNS)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        })
        .skip(1)
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[RUNS / 2]
}

fn by_threads(name: &str, frame: &Frame) {
    println!("\n| {name}: threads | seconds | times as fast |\n|---|---|---|");
    let mut alone = None;
    for threads in 1..=std::thread::available_parallelism().unwrap().get() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let (seconds, _) = pool.build().unwrap().install(|| frame.render());
        let speedup = *alone.get_or_insert(seconds) / seconds;
        println!("| {threads} | {seconds:.3} | {speedup:.2} |");
    }
}

/// The rays of a frame without anything around them: its camera rays and their shadow rays, packet by
/// packet as far as possible.
fn beside_its_rays(name: &str, frame: &Frame) {
    let (whole, rays) = frame.render();
    let tiles = tiles(frame);
    let of_packet = |(rays, shadow_packets): &(Vec<Ray>, Vec<ShadowPacket>)| {
        let shadow_rays: u32 = shadow_packets.iter().map(|s| s.facing().count_ones()).sum();
        rays.len() + shadow_rays as usize
    };
    let count: usize = tiles.iter().flatten().map(of_packet).sum();
    let seconds = median(|| {
        tiles.par_iter().for_each(|packets| {
            let mut query_state = QueryState::default();
            for (rays, shadow_packets) in packets {
                let mut hits = [None; PACKET_WIDTH];
                let scene = &frame.scene;
                scene.closest_coherent(rays, &mut hits, &mut query_state);
                std::hint::black_box(hits);
                for shadow_packet in shadow_packets {
                    std::hint::black_box(scene.occluded_coherent(shadow_packet, &mut query_state));
                }
            }
        });
    });
    let (per_ray, alone) = (whole / rays as f64, seconds / count as f64);
    println!("\n| {name} | rays | ns per ray | ratio |\n|---|---|---|---|");
    println!(
        "| whole frame | {rays} | {:.1} | {:.2} |",
        1e9 * per_ray,
        per_ray / alone
    );
    println!(
        "| camera rays and their shadow rays alone | {count} | {:.1} | 1 |",
        1e9 * alone
    );
}

/// For tiles of 8 x 8 pixels: packets of camera rays, and the shadow rays to every light.
fn tiles(frame: &Frame) -> Vec<Vec<(Vec<Ray>, Vec<ShadowPacket>)>> {
    const TILE: u32 = 8;
    let (width, height) = (frame.settings.width, frame.settings.height);
    let size = DVec2::new(width.into(), height.into());
    let camera_rays = frame.camera.rays(size, frame.scene.origin);
    let (columns, rows) = (width / TILE, height / TILE);
    let tile = |number: u32| {
        let corner = (number % columns * TILE, number / columns * TILE);
        let mut packets = Vec::new();
        let mut query_state = QueryState::default();
        // Two by two pixels of four samples each.
        for block in 0..TILE * TILE / 4 {
            let mut rays = Vec::with_capacity(PACKET_WIDTH);
            for i in 0..PACKET_WIDTH as u32 {
                let x = corner.0 + block % (TILE / 2) * 2 + i / 4 % 2;
                let y = corner.1 + block / (TILE / 2) * 2 + i / 8;
                let sequence = SobolSequence::new(frame.settings.seed, frame.number, x, y);
                let [u, v] = sequence.sample_2d(i % 4, 0);
                let film = DVec2::new((x as f32 + u).into(), (y as f32 + v).into());
                rays.push(camera_rays.through(film));
            }
            let mut hits = [None; PACKET_WIDTH];
            frame
                .scene
                .closest_coherent(&rays, &mut hits, &mut query_state);
            let mut points = SurfacePointPacket::default();
            for (ray, hit) in rays.iter().zip(&hits) {
                if let Some(hit) = hit {
                    points.push(&frame.scene.surface::<FeatureMask<0>>(ray, hit).point);
                }
            }
            let lights = frame.scene.lights.iter();
            let shadow_packets =
                lights.map(|light| frame.scene.shadow_rays_to(&points, light.position));
            packets.push((rays, shadow_packets.collect()));
        }
        packets
    };
    (0..columns * rows).into_par_iter().map(tile).collect()
}
