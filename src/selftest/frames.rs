//! Whole frames: invariance to scale, position, kernel and thread count; thin walls; slow camera moves.

use super::fixtures::{camera_at, path_traced, renderer, worse};
use super::room::room;
use super::shapes::Polyhedron;
use super::textures::ReferenceTexture;
use crate::camera::Camera;
use crate::film::Film;
use crate::integrator::IntegratorSettings;
use crate::light::Sky;
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

/// The number of pixels of two films that differ in any bit.
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

/// The largest difference of the ray-traced frames of two rooms, in 8-bit codes.
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

/// Rooms that differ in size only.
pub(super) fn scales(kernel: Kernel) -> f64 {
    let one = room(1.0, DVec3::ZERO, kernel);
    let difference = |scale| code_difference(&one, &room(scale, DVec3::ZERO, kernel));
    difference(1e-3).max(difference(1e6))
}

/// Scaling by a power of two changes no bit of a significand: path-traced frames differ only if some length is not
/// relative to the scene.
pub(super) fn powers_of_two(kernel: Kernel) -> f64 {
    let settings = settings(path_traced(3, [2, 1]), PixelSampling::Spread(1));
    let rendered = |scale: f64| film(&room(scale, DVec3::ZERO, kernel), &settings);
    let one = rendered(1.0);
    let scales = [2.0_f64.powi(-20), 2.0_f64.powi(20)];
    scales
        .map(|scale| differing(&one, &rendered(scale)))
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
            // Without threads nothing is measured, and NaN fails.
            _ => f64::NAN,
        };
    }
    sum
}

/// Ambient light under which the radiance of a surface is its diffuse colour.
const FULL_AMBIENT: Vec3 = Vec3::splat(1.0 / 0.3);

/// A camera flies through a wall of 1e-6 m in steps of 1e-6 m, 1e3 m from the middle of the scene, where an ulp is
/// 6e-5 m. Looking ahead it sees the wall, then the background; looking back, the background, then the wall. Each view
/// changes only once. Both sides of the wall round to the same coordinates, so the first mesh is hit from either side.
pub(super) fn through_a_wall(kernel: Kernel) -> f64 {
    const WALL: f64 = 1000.3;
    let [right, up] = [DVec3::Y, DVec3::Z].map(|side| 4.0 * side);
    let side = |x: f64| Polyhedron::quad(DVec3::new(x, -2.0, -2.0), right, up);
    let front = side(WALL);
    let mirrored = front.moved(|p| -p);
    let builder = SceneBuilder {
        ambient: FULL_AMBIENT,
        sky: Sky::Uniform(Vec3::Z),
        materials: vec![Material::lambert(Vec3::X), Material::lambert(Vec3::Y)],
        meshes: vec![
            front.mesh(0),
            side(WALL - 1e-6).mesh(1),
            mirrored.mesh(0),
            mirrored.mesh(0),
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
    let sees_wall = |x: f64, facing: f64| {
        let eye = DVec3::new(x, 0.1, 0.2);
        let camera = camera_at(eye, eye + DVec3::new(facing, 0.01, 0.02), 1.0);
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
    // The right side except within an ulp of the wall, and one change.
    let wrong = |seen: &[bool], first: bool| {
        let early = seen[..240].iter().filter(|&&wall| wall != first).count();
        let late = seen[361..].iter().filter(|&&wall| wall == first).count();
        let changes = seen.windows(2).filter(|pair| pair[0] != pair[1]).count();
        early + late + changes.abs_diff(1)
    };
    (wrong(&ahead, true) + wrong(&behind, false)) as f64
}

/// A camera moves 1e-4 m a frame, 1e4 m from the origin, past a post in front of a textured wall. Measured are the
/// deviation of each pixel from its value in double precision, and the change of that deviation from frame to frame:
/// jitter that the motion does not explain.
pub(super) fn slow_dolly(kernel: Kernel) -> f64 {
    const FRAMES: u32 = 2000;
    const SIZE: DVec2 = DVec2::new(24.0, 4.0);
    const POST: [f64; 2] = [-0.1, 0.05];
    let base = DVec3::splat(1e4);
    let wall_texture = ReferenceTexture::colorful(64, 64);
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
    let textured = SourceMesh {
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
        ..wall.mesh(1)
    };
    let post_radiance = 0.3;
    let builder = SceneBuilder {
        ambient: FULL_AMBIENT,
        materials: vec![
            Material::lambert(Vec3::splat(post_radiance as f32)),
            Material {
                texture: Some(0),
                ..Material::lambert(Vec3::ONE)
            },
        ],
        textures: vec![wall_texture.texture()],
        meshes: vec![textured, post.mesh(0)],
        kernel,
        ..SceneBuilder::default()
    };
    let (scene, _) = builder.build();
    let settings = RenderSettings {
        width: SIZE.x as u32,
        height: SIZE.y as u32,
        ..settings(WHITTED, PixelSampling::Center)
    };
    // Pixels of a twentieth of a texel, which are not filtered.
    let half_height = 0.003;
    let exact = |x: f64, film: DVec2| {
        let pixel = 2.0 * half_height / SIZE.y;
        let slope = (film - 0.5 * SIZE) * DVec2::new(pixel, -pixel);
        let on_post = x + slope.x;
        let on_wall = DVec2::new(x, 0.0) + 2.0 * slope;
        let wall_radiance = wall_texture.color((on_wall + 2.0) / 4.0).x;
        let to_edge = (on_post - POST[0]).min(POST[1] - on_post);
        // Within a micrometre of the edge either may be seen.
        match to_edge {
            _ if to_edge.abs() < 1e-6 => [post_radiance, wall_radiance],
            _ if to_edge > 0.0 => [post_radiance; 2],
            _ => [wall_radiance; 2],
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
