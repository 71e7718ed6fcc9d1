//! Scenes that are meant to break an irradiance cache, against path tracing: light that must not go through walls, small
//! things seen closely and late, narrow gaps, sharp indirect shadows.

use crate::support::*;
use flythrough::accel::QueryState;
use flythrough::bake::{Baked, bake};
use flythrough::camera::{
    CameraPath, CameraPathTiming, Interpolation, Keyframe, Orientation, Segment,
};
use flythrough::integrator::{IntegratorSettings, record_in_cell};
use flythrough::irradiance_cache::CellKey;
use flythrough::metrics::{BiasCheck, HeldOutPixel};
use flythrough::render::{PixelSampling, RenderSettings, Renderer};
use flythrough::scene::Scene;
use glam::{DVec3, Vec3};
use std::fmt::Write;

const SIZE: (u32, u32) = (80, 48);
const BLOCK: u32 = 8;

/// Where the camera is, what it looks at, and the field of view in degrees.
pub(crate) type View = (DVec3, DVec3, f64);

/// A path whose frames are these views.
pub(crate) fn path_of(views: &[View]) -> CameraPath {
    let key = |(frame, (position, target, degrees)): (usize, &View)| Keyframe {
        time: frame as f64,
        position: *position,
        orientation: Orientation::LookAt {
            target: *target,
            roll: 0.0,
        },
        field_of_view: degrees.to_radians(),
        segment: Segment::of(Interpolation::Hold),
    };
    let keys: Vec<Keyframe> = views.iter().enumerate().map(key).collect();
    CameraPath::new(1.0, &keys, &CameraPathTiming::BY_KEYS).unwrap()
}

pub(crate) fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Objects of a scene file.
#[derive(Default)]
pub(crate) struct Objects(String);

impl Objects {
    pub(crate) fn quad(&mut self, corners: [DVec3; 4], material: &str) {
        let [a, b, c, d] = corners.map(|p| format!("({}, {}, {})", p.x, p.y, p.z));
        for [a, b, c] in [[&a, &b, &c], [&a, &c, &d]] {
            let vertices = format!("vertices: [{a}, {b}, {c}]");
            writeln!(self.0, "triangle({vertices}, material: \"{material}\"),").unwrap();
        }
    }

    /// A closed box.
    pub(crate) fn cuboid(&mut self, low: DVec3, high: DVec3, material: &str) {
        for axis in 0..3 {
            let [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
            for side in [low, high] {
                let corner = |u: DVec3, w: DVec3| {
                    let mut corner = side;
                    corner[next] = u[next];
                    corner[last] = w[last];
                    corner
                };
                let corners = [(low, low), (high, low), (high, high), (low, high)];
                self.quad(corners.map(|(u, w)| corner(u, w)), material);
            }
        }
    }

    pub(crate) fn sphere(&mut self, center: DVec3, radius: f64, material: &str) {
        let DVec3 { x, y, z } = center;
        let center = format!("center: ({x}, {y}, {z})");
        writeln!(
            self.0,
            "sphere({center}, radius: {radius}, material: \"{material}\"),"
        )
        .unwrap();
    }

    /// With a room four metres wide and deep and 2.5 high around them, or without.
    pub(crate) fn scene(mut self, has_room: bool, lights: &str) -> Scene {
        if has_room {
            self.cuboid(v(-2.0, 0.0, -2.0), v(2.0, 2.5, 2.0), "wall");
        }
        let materials =
            "\"wall\": (diffuse: (0.75, 0.75, 0.75)), \"thing\": (diffuse: (0.6, 0.5, 0.4)),
            \"mirror\": (reflective: (0.9, 0.9, 0.9))";
        let objects = self.0;
        scene(&format!(
            "Scene(materials: {{{materials}}}, lights: [{lights}], objects: [{objects}])"
        ))
    }
}

/// What a cache does in a frame.
#[derive(Debug)]
pub(crate) struct Outcome {
    /// The true relMSE, with its standard error.
    pub(crate) error: [f64; 2],
    /// The upper bound that is claimed.
    pub(crate) bound: f64,
    /// By how much the worst block of 8 x 8 pixels is off, relative to its mean and beyond three standard errors of path
    /// tracing.
    worst_block: f64,
}

fn cached_settings() -> RenderSettings {
    RenderSettings {
        sampling: PixelSampling::Center,
        ..settings(IntegratorSettings::Cached { bounces: 4 }, SIZE.0, SIZE.1)
    }
}

pub(crate) fn baked(scene: &Scene, path: &CameraPath) -> Baked {
    bake(scene, path, "path", &cached_settings(), None, &|_, _| ())
}

/// The pixels of a frame by a cache.
fn cached(scene: &Scene, path: &CameraPath, baked: &Baked, frame: u32) -> Vec<Vec3> {
    let renderer = Renderer::new(scene, cached_settings(), Some(&baked.cache)).unwrap();
    let pixels = renderer.render_pixels(&path.camera(frame), frame, &all_pixels());
    pixels.into_iter().map(|[a, _]| a).collect()
}

fn all_pixels() -> Vec<(u32, u32)> {
    (0..SIZE.0 * SIZE.1)
        .map(|i| (i % SIZE.0, i / SIZE.0))
        .collect()
}

pub(crate) fn outcome(
    scene: &Scene,
    path: &CameraPath,
    baked: &Baked,
    frame: u32,
    paths: u32,
) -> Outcome {
    let technique = cached(scene, path, baked, frame);
    let by_paths = RenderSettings {
        integrator: monte_carlo(4, &[paths]),
        seed: 77,
        ..cached_settings()
    };
    let by_paths = renderer(scene, &by_paths);
    let oracle = by_paths.render_pixels(&path.camera(frame), frame, &all_pixels());
    let both = technique.iter().zip(&oracle);
    let pixels: Vec<HeldOutPixel> = both
        .map(|(c, oracle)| HeldOutPixel {
            technique: [*c; 2],
            oracle: *oracle,
        })
        .collect();
    let error = BiasCheck::of(&pixels, 0.0).squared_bias;
    let mut worst_block = 0.0_f32;
    for top in (0..SIZE.1).step_by(BLOCK as usize) {
        for left in (0..SIZE.0).step_by(BLOCK as usize) {
            let of_block = |pixel: &(u32, u32)| {
                (left..left + BLOCK).contains(&pixel.0) && (top..top + BLOCK).contains(&pixel.1)
            };
            let numbers = all_pixels()
                .into_iter()
                .enumerate()
                .filter(|(_, p)| of_block(p));
            let (mut c, mut r, mut variance) = (0.0, 0.0, 0.0);
            for (number, _) in numbers {
                let [a, b] = oracle[number].map(Vec3::element_sum);
                c += technique[number].element_sum();
                r += 0.5 * (a + b);
                variance += 0.25 * (a - b).powi(2);
            }
            let off = (c - r).abs() - 3.0 * variance.sqrt();
            worst_block = worst_block.max(off / r.max(0.01 * 3.0 * 64.0));
        }
    }
    Outcome {
        error: [error.mean, error.error],
        bound: baked.errors[frame as usize].interval()[1],
        worst_block: worst_block.into(),
    }
}

/// The lamp of most rooms.
fn lamp() -> String {
    light("(1, 2.2, 0.5)", 9.0)
}

/// Closed boxes with walls of one or of two sheets, seen from outside and then from inside, at any size: no light comes in.
#[test]
fn closed_boxes_are_black_inside() {
    for (size, thickness) in [
        (0.001, 0.0),
        (0.01, 5e-4),
        (0.1, 0.0),
        (0.1, 0.005),
        (1.0, 0.0),
    ] {
        let half = 0.5 * size;
        let mut objects = Objects::default();
        // Their floor is that of the room.
        objects.cuboid(v(-half, -1.0, -half), v(half, size, half), "thing");
        if thickness > 0.0 {
            let inner = half - thickness;
            let top = size - thickness;
            objects.cuboid(v(-inner, -1.0, -inner), v(inner, top, inner), "thing");
        }
        let scene = objects.scene(true, &lamp());
        let near = v(-1.6, 1.4, 1.7).lerp(v(0.0, size, 0.0), 1.0 - size.min(0.5));
        let eye = v(-0.3 * size, 0.7 * size, 0.3 * size);
        let path = path_of(&[
            (v(-1.6, 1.4, 1.7), v(0.0, size, 0.0), 60.0),
            (near, v(0.0, size, 0.0), 60.0),
            (eye, v(0.2 * size, 0.0, -0.2 * size), 80.0),
            (v(-1.6, 1.4, 1.7), v(0.0, size, 0.0), 2.0),
        ]);
        let baked = baked(&scene, &path);
        let inside = cached(&scene, &path, &baked, 2);
        assert!(
            inside.iter().all(|pixel| *pixel == Vec3::ZERO),
            "{size} {thickness}"
        );
        let outside = cached(&scene, &path, &baked, 1);
        assert!(
            outside.iter().any(|pixel| pixel.min_element() > 0.01),
            "{size}"
        );
    }
}

/// Points behind a thin wall may not see what stands before it, however close they are to its foot.
#[test]
fn the_foot_of_a_wall_ends_what_is_free() {
    let mut objects = Objects::default();
    let wall = [
        v(0.0, 0.0, -2.0),
        v(0.0, 0.0, 2.0),
        v(0.0, 1.0, 2.0),
        v(0.0, 1.0, -2.0),
    ];
    objects.quad(wall, "thing");
    let scene = objects.scene(true, &lamp());
    let [x0, z0] = [-scene.origin.x as f32, -scene.origin.z as f32];
    let mut seen = 0;
    for step in 1..200 {
        let position = Vec3::new(x0 - 0.002 * step as f32, -scene.origin.y as f32, z0);
        let cell = CellKey::containing(position, Vec3::Y, -6);
        let query_state = &mut QueryState::default();
        let found = record_in_cell(&scene, &cell, 0.2, 0, query_state);
        let Some((_, record)) = found.filter(|(_, record)| record.position.x < x0) else {
            continue;
        };
        let distance = x0 - record.position.x;
        let at = |x: f32| Vec3 {
            x,
            ..record.position
        };
        let behind = at(x0 + 0.002 * distance);
        let before = at(x0 - 0.1 * distance);
        if distance < 0.19 {
            seen += 1;
            assert!(record.is_doubtful(behind, Vec3::Y), "{record:?}");
            assert!(!record.is_doubtful(before, Vec3::Y), "{record:?}");
        }
    }
    assert!(seen > 50, "{seen}");
}

/// Frames of hard scenes have an error within the bound that is claimed, and no block of pixels is far off.
#[test]
fn hard_scenes_are_right_and_their_bounds_hold() {
    // A figure of a centimetre, first seen from afar.
    let mut figure = Objects::default();
    figure.cuboid(v(-0.3, -1.0, -0.3), v(0.3, 1.0, 0.3), "thing");
    figure.sphere(v(0.0, 1.003, 0.0), 0.003, "wall");
    figure.cuboid(v(-0.006, 1.0, -0.006), v(0.006, 1.009, -0.005), "wall");
    let figure = (
        "figure",
        figure.scene(true, &lamp()),
        vec![
            (v(1.8, 1.6, 1.8), v(0.0, 1.0, 0.0), 60.0),
            (v(0.02, 1.02, 0.03), v(0.0, 1.004, 0.0), 30.0),
        ],
    );
    // A box over a gap of two centimetres, zoomed at late.
    let mut gap = Objects::default();
    gap.cuboid(v(-0.5, 0.02, -0.5), v(0.5, 0.6, 0.5), "wall");
    gap.sphere(v(0.75, 0.1, 0.3), 0.1, "wall");
    let gap = (
        "zoom",
        gap.scene(true, &light("(-1.2, 2.2, 1)", 9.0)),
        vec![
            (v(1.9, 1.4, 1.9), v(0.55, 0.05, 0.4), 60.0),
            (v(1.9, 1.4, 1.9), v(0.55, 0.05, 0.4), 5.0),
        ],
    );
    // A table under a shade: its bright inside throws a sharp shadow.
    let mut shade = Objects::default();
    for (x, z) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
        let (outer, inner) = (v(0.2 * x, 1.0, 0.2 * z), v(0.12 * x, 1.25, 0.12 * z));
        let along = v(z, 0.0, x);
        shade.quad(
            [
                outer - 0.2 * along,
                outer + 0.2 * along,
                inner + 0.12 * along,
                inner - 0.12 * along,
            ],
            "thing",
        );
    }
    shade.cuboid(v(-0.12, 1.25, -0.12), v(0.12, 1.26, 0.12), "thing");
    shade.cuboid(v(-0.4, 0.5, -0.4), v(0.4, 0.55, 0.4), "thing");
    let shade = (
        "shade",
        shade.scene(true, &light("(0, 1.18, 0)", 3.0)),
        vec![
            (v(1.5, 1.3, 1.6), v(0.0, 0.7, 0.0), 60.0),
            (v(0.9, 0.9, 0.9), v(0.0, 0.3, 0.0), 50.0),
        ],
    );
    // Sheets eight millimetres apart.
    let mut shelf = Objects::default();
    for sheet in 0..8 {
        let y = 0.8 + 0.008 * f64::from(sheet);
        shelf.cuboid(v(-0.15, y, -0.1), v(0.15, y + 5e-4, 0.1), "wall");
    }
    let shelf = (
        "shelf",
        shelf.scene(true, &lamp()),
        vec![
            (v(1.5, 1.4, 1.7), v(0.0, 0.85, 0.0), 60.0),
            (v(0.1, 0.9, 0.3), v(0.0, 0.82, 0.1), 30.0),
        ],
    );
    // A dim room beside a bright one, a sheet of a millimetre between them, and a slit at its end.
    let mut slit = Objects::default();
    slit.cuboid(v(-0.0005, -0.1, -1.96), v(0.0005, 2.6, 2.1), "thing");
    let slit = (
        "slit",
        slit.scene(true, &light("(-1.2, 2, 0.5)", 20.0)),
        vec![
            (v(1.8, 1.6, 1.6), v(0.3, 0.8, -1.5), 70.0),
            (v(0.8, 0.8, -0.8), v(0.1, 0.3, -1.9), 50.0),
        ],
    );
    let paths = scaled(64, 128, 1024);
    for (name, scene, views) in [figure, gap, shade, shelf, slit] {
        let path = path_of(&views);
        let baked = baked(&scene, &path);
        for frame in 0..2 {
            let outcome = outcome(&scene, &path, &baked, frame, paths);
            let [error, standard_error] = outcome.error;
            let is_bounded = error - 3.0 * standard_error <= outcome.bound;
            assert!(is_bounded, "{name} {frame}: {outcome:?}");
            assert!(outcome.worst_block < 0.05, "{name} {frame}: {outcome:?}");
        }
    }
}
