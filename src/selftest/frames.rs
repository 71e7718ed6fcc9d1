//! Whole frames: invariance to scale, position, kernel and thread count; thin walls; slow camera moves.

use super::fixtures::{camera_at, path_traced, renderer, worse};
use super::room::room;
use super::shapes::Polyhedron;
use super::textures::Picture;
use crate::camera::Camera;
use crate::film::Film;
use crate::integrator::IntegratorSettings;
use crate::material::Material;
use crate::render::{PixelSampling, RenderSettings};
use crate::scene::{Scene, SceneBuilder, SourceMesh};
use crate::simd::Kernel;
use glam::{DMat3, DVec2, DVec3, Vec2, Vec3};

fn settings(integrator: IntegratorSettings, sampling: PixelSampling) -> RenderSettings {
    RenderSettings {
        sampling,
        seed: 1,
        ..RenderSettings::new(integrator, 96, 72)
    }
}

const WHITTED: IntegratorSettings = IntegratorSettings::Whitted { bounces: 4 };

fn four_modes() -> [RenderSettings; 4] {
    [
        settings(WHITTED, PixelSampling::Center),
        settings(WHITTED, PixelSampling::Corners),
        settings(path_traced(3, [2, 1]), PixelSampling::Spread(2)),
        settings(path_traced(3, [2, 1]), PixelSampling::Corners),
    ]
}

fn film((scene, camera): &(Scene, Camera), settings: &RenderSettings) -> Film {
    renderer(scene, settings).render_frame(camera, 0).film
}

/// How many pixels of two films differ, bit by bit.
fn differing(a: &Film, b: &Film) -> f64 {
    let bits = |film: &Film| -> Vec<[u32; 3]> {
        film.pixels()
            .iter()
            .map(|p| p.to_array().map(f32::to_bits))
            .collect()
    };
    let pairs = bits(a).into_iter().zip(bits(b));
    pairs.filter(|(a, b)| a != b).count() as f64
}

/// The largest difference of the ray-traced pictures of two rooms, in 8-bit codes.
fn code_difference(a: &(Scene, Camera), b: &(Scene, Camera)) -> f64 {
    let mut worst = 0;
    for settings in &four_modes()[..2] {
        let codes = film(a, settings)
            .to_srgb8()
            .into_iter()
            .zip(film(b, settings).to_srgb8());
        worst = codes.fold(worst, |worst, (a, b)| worst.max(a.abs_diff(b)));
    }
    worst.into()
}

/// Pictures of rooms that differ in nothing but their size.
pub(super) fn scales(kernel: Kernel) -> f64 {
    let one = room(1.0, DVec3::ZERO, kernel);
    let difference = |scale| code_difference(&one, &room(scale, DVec3::ZERO, kernel));
    difference(1e-3).max(difference(1e6))
}

/// Scaling by a power of two changes no bit of a significand: path-traced frames must be equal in every bit, unless some
/// length is not relative to the scene.
pub(super) fn powers_of_two(kernel: Kernel) -> f64 {
    let settings = settings(path_traced(3, [2, 1]), PixelSampling::Spread(1));
    let of = |scale: f64| film(&room(scale, DVec3::ZERO, kernel), &settings);
    let one = of(1.0);
    let scales = [2.0_f64.powi(-20), 2.0_f64.powi(20)];
    scales
        .map(|scale| differing(&one, &of(scale)))
        .into_iter()
        .sum()
}

/// A room of 1 m, here and a thousand kilometres away.
pub(super) fn far_away(kernel: Kernel) -> f64 {
    let here = room(1.0, DVec3::ZERO, kernel);
    let there = room(1.0, DVec3::new(1e6, -1e6, 1e6), kernel);
    code_difference(&here, &there)
}

/// A kernel against portable code.
pub(super) fn instructions(kernel: Kernel) -> f64 {
    let [this, portable] = [kernel, Kernel::PORTABLE].map(|kernel| room(1.0, DVec3::ONE, kernel));
    let modes = four_modes();
    modes
        .iter()
        .map(|mode| differing(&film(&this, mode), &film(&portable, mode)))
        .sum()
}

/// Pools of one, two and five threads.
pub(super) fn threads(kernel: Kernel) -> f64 {
    let room = room(1.0, DVec3::ONE, kernel);
    let on = |threads: usize, mode: &RenderSettings| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.map(|pool| pool.install(|| film(&room, mode)))
    };
    let mut sum = 0.0;
    for mode in &four_modes() {
        sum += match (on(1, mode), on(2, mode), on(5, mode)) {
            (Ok(one), Ok(two), Ok(five)) => differing(&one, &two) + differing(&one, &five),
            // Without threads nothing is measured.
            _ => f64::NAN,
        };
    }
    sum
}

/// Ambient light under which a surface has the colour of its material.
const EVEN: Vec3 = Vec3::splat(1.0 / 0.3);

/// A camera goes through a wall of 1e-6 m in steps of 1e-6 m, 1e3 m from the middle of the scene, where an
/// ulp is 6e-5 m. Ahead it sees the wall until it is there, and then the background; behind it the
/// background, and then the wall: nothing comes back. One colour, as both sides have the same coordinates.
pub(super) fn through_a_wall(kernel: Kernel) -> f64 {
    const WALL: f64 = 1000.3;
    let [right, up] = [DVec3::Y, DVec3::Z].map(|side| 4.0 * side);
    let side = |x: f64| Polyhedron::quad(DVec3::new(x, -2.0, -2.0), right, up);
    let front = side(WALL);
    let twin = front.moved(|p| -p);
    let builder = SceneBuilder {
        ambient: EVEN,
        background: Vec3::Z,
        materials: vec![Material::lambert(Vec3::X), Material::lambert(Vec3::Y)],
        meshes: vec![
            front.mesh(0),
            side(WALL - 1e-6).mesh(1),
            twin.mesh(0),
            twin.mesh(0),
        ],
        kernel,
        ..SceneBuilder::default()
    };
    let (scene, _) = builder.build();
    let settings = RenderSettings {
        width: 1,
        height: 1,
        ..settings(WHITTED, PixelSampling::Center)
    };
    let renderer = renderer(&scene, &settings);
    let sees_wall = |x: f64, way: f64| {
        let eye = DVec3::new(x, 0.1, 0.2);
        let camera = camera_at(eye, eye + DVec3::new(way, 0.01, 0.02), 1.0);
        let seen = renderer.render_frame(&camera, 0).film.pixels()[0];
        seen.distance(Vec3::X) < 1e-6
    };
    let steps = -300..=300;
    let ahead: Vec<bool> = steps
        .clone()
        .map(|i| sees_wall(WALL - 1e-6 * f64::from(i), -1.0))
        .collect();
    let behind: Vec<bool> = steps
        .map(|i| sees_wall(WALL - 1e-6 * f64::from(i), 1.0))
        .collect();
    // Right but for an ulp, and one change only.
    let wrong = |seen: &[bool], first: bool| {
        let early = seen[..240].iter().filter(|&&wall| wall != first).count();
        let late = seen[361..].iter().filter(|&&wall| wall == first).count();
        let changes = seen.windows(2).filter(|pair| pair[0] != pair[1]).count();
        early + late + changes.abs_diff(1)
    };
    (wrong(&ahead, true) + wrong(&behind, false)) as f64
}

/// A camera moves 1e-4 m a frame, 1e4 m from the origin, past a post in front of a papered wall. Every
/// pixel is computed in double precision; what a frame deviates from that, and what the deviation
/// changes from one frame to the next, is a jump that no motion explains.
pub(super) fn slow_dolly(kernel: Kernel) -> f64 {
    const FRAMES: u32 = 2000;
    const SIZE: DVec2 = DVec2::new(24.0, 4.0);
    const POST: [f64; 2] = [-0.1, 0.05];
    let base = DVec3::splat(1e4);
    let paper = Picture::colorful(64, 64);
    let wall = Polyhedron::quad(
        base + DVec3::new(-2.0, -2.0, -2.0),
        4.0 * DVec3::X,
        4.0 * DVec3::Y,
    );
    let width = DVec3::X * (POST[1] - POST[0]);
    let post = Polyhedron::quad(
        base + DVec3::new(POST[0], -2.0, -1.0),
        width,
        4.0 * DVec3::Y,
    );
    let papered = SourceMesh {
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
        ..wall.mesh(1)
    };
    let of_post = 0.3;
    let builder = SceneBuilder {
        ambient: EVEN,
        materials: vec![
            Material::lambert(Vec3::splat(of_post as f32)),
            Material {
                texture: Some(0),
                ..Material::lambert(Vec3::ONE)
            },
        ],
        textures: vec![paper.texture()],
        meshes: vec![papered, post.mesh(0)],
        kernel,
        ..SceneBuilder::default()
    };
    let (scene, _) = builder.build();
    let settings = RenderSettings {
        width: SIZE.x as u32,
        height: SIZE.y as u32,
        ..settings(WHITTED, PixelSampling::Center)
    };
    let half_height = 0.05;
    let exact = |x: f64, film: DVec2| {
        let pixel = 2.0 * half_height / SIZE.y;
        let slope = (film - 0.5 * SIZE) * DVec2::new(pixel, -pixel);
        let on_post = x + slope.x;
        let on_wall = DVec2::new(x, 0.0) + 2.0 * slope;
        let of_wall = paper.color((on_wall + 2.0) / 4.0).x;
        let to_edge = (on_post - POST[0]).min(POST[1] - on_post);
        // Within a micrometre of the edge either may be seen.
        match to_edge {
            _ if to_edge.abs() < 1e-6 => [of_post, of_wall],
            _ if to_edge > 0.0 => [of_post; 2],
            _ => [of_wall; 2],
        }
    };
    let mut worst: f64 = 0.0;
    let mut before: Vec<f64> = Vec::new();
    let renderer = renderer(&scene, &settings);
    for frame in 0..FRAMES {
        let x = -0.1 + 1e-4 * f64::from(frame);
        let camera = Camera {
            position: base + DVec3::X * x,
            rotation: DMat3::IDENTITY,
            half_height,
        };
        let film = renderer.render_frame(&camera, frame).film;
        let deviations = film.pixels().iter().enumerate().map(|(i, seen)| {
            let columns = SIZE.x as usize;
            let at = DVec2::new((i % columns) as f64, (i / columns) as f64) + 0.5;
            let [a, b] = exact(x, at).map(|exact| f64::from(seen.x) - exact);
            if a.abs() < b.abs() { a } else { b }
        });
        let deviations: Vec<f64> = deviations.collect();
        for (i, deviation) in deviations.iter().enumerate() {
            let jump = before.get(i).map_or(0.0, |before| deviation - before);
            worst = worse(worse(worst, deviation.abs()), jump.abs());
        }
        before = deviations;
    }
    worst
}
