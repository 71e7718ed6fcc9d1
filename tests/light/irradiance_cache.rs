//! The irradiance cache of a camera path, against closed forms and path tracing.

use crate::support::*;
use flythrough::bake::{BakeState, Baked, Listener, NoKeeper, bake, cache_errors};
use flythrough::camera::{
    CameraPath, CameraPathTiming, Interpolation, Keyframe, Orientation, Segment,
};
use flythrough::integrator::IntegratorSettings;
use flythrough::metrics::{BiasCheck, HeldOutPixel};
use flythrough::render::{RenderSettings, Renderer};
use flythrough::scene::Scene;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

pub(crate) const SIZE: (u32, u32) = (64, 48);

/// A path of nine frames from one eye to another, that looks at a point.
pub(crate) fn glide(eyes: [DVec3; 2], target: DVec3) -> CameraPath {
    let key = |(time, position): (f64, DVec3)| Keyframe {
        time,
        position,
        orientation: Orientation::LookAt { target, roll: 0.0 },
        field_of_view: 60_f64.to_radians(),
        segment: Segment::of(Interpolation::Linear),
    };
    let keys: Vec<Keyframe> = [0.0, 1.0].into_iter().zip(eyes).map(key).collect();
    CameraPath::new(8.0, &keys, &CameraPathTiming::BY_KEYS).unwrap()
}

/// From the left to the right of `scenes/test3.ron`.
pub(crate) fn across_the_room() -> CameraPath {
    glide(
        [DVec3::new(-0.5, 0.0, 3.0), DVec3::new(0.5, 0.1, 2.6)],
        DVec3::new(0.0, -0.1, 0.0),
    )
}

pub(crate) fn cached_settings(bounces: u32) -> RenderSettings {
    settings(IntegratorSettings::Cached { bounces }, SIZE.0, SIZE.1)
}

/// The irradiance cache of a path.
pub(crate) fn baked(scene: &Scene, path: &CameraPath, bounces: u32) -> Baked {
    let settings = cached_settings(bounces);
    bake(scene, path, "path", &settings, None, &|_, _| ())
}

/// The pixels of a frame by path tracing.
fn path_traced(scene: &Scene, path: &CameraPath, paths: u32, frame: u32) -> Vec<Vec3> {
    let settings = settings(monte_carlo(4, &[paths]), SIZE.0, SIZE.1);
    render(scene, &path.camera(frame), &settings)
}

/// The pixels of a frame by a cache.
fn cached(scene: &Scene, path: &CameraPath, baked: &Baked, frame: u32) -> Vec<Vec3> {
    let settings = cached_settings(baked.cache.bounces());
    let renderer = Renderer::new(scene, settings, Some(&baked.cache)).unwrap();
    let rendered = renderer.render_frame(&path.camera(frame), 0);
    assert_eq!(rendered.non_finite_samples, 0);
    rendered.film.pixels().to_vec()
}

fn mean(pixels: &[Vec3]) -> Vec3 {
    pixels.iter().sum::<Vec3>() / pixels.len() as f32
}

/// Inside a sphere of radius R a light of intensity I anywhere gives the wall the irradiance
/// rho^k I / R^2 by bounce k, the same everywhere.
#[test]
fn light_inside_a_sphere_after_each_bounce() {
    let albedo = Vec3::new(0.9, 0.5, 0.2);
    let scene = inside_of_a_sphere("(5.9, -1.2, 7.4)");
    let eyes = [DVec3::new(4.5, -2.5, 6.5), DVec3::new(4.9, -1.5, 7.5)];
    let path = glide(eyes, DVec3::new(3.0, -3.0, 9.0));
    let direct = cached(&scene, &path, &baked(&scene, &path, 0), 4);
    for bounces in 1..=4 {
        let pixels = cached(&scene, &path, &baked(&scene, &path, bounces), 4);
        let expected: Vec3 = (1..=bounces as i32)
            .map(|k| albedo * albedo.powf(k as f32) * 3.0 / (4.0 * PI as f32))
            .sum();
        let indirect: Vec<Vec3> = pixels.iter().zip(&direct).map(|(all, d)| all - d).collect();
        let bias = mean(&indirect) / expected - 1.0;
        assert!(bias.abs().max_element() < 0.005, "{bounces}: {bias}");
        let squares = indirect.iter().map(|x| (x / expected - 1.0).powf(2.0));
        let square = squares.sum::<Vec3>() / indirect.len() as f32;
        assert!(square.max_element() < 0.03 * 0.03, "{bounces}: {square}");
    }
}

/// The estimated cache error holds for whole frames, of usual and of refined records, in a box of white walls with edges, a
/// ball on the floor, and a mirror.
#[test]
fn the_estimated_error_is_right() {
    let scene = shipped_scene("test3.ron");
    let path = across_the_room();
    let settings = settings(monte_carlo(4, &[scaled(128, 256, 2048)]), SIZE.0, SIZE.1);
    let by_paths = renderer(&scene, &settings);
    let all: Vec<(u32, u32)> = (0..SIZE.0 * SIZE.1)
        .map(|index| (index % SIZE.0, index / SIZE.0))
        .collect();
    let pixels =
        |renderer: &Renderer, frame: u32| renderer.render_pixels(&path.camera(frame), frame, &all);
    let references = [1, 4, 7].map(|frame| (frame, pixels(&by_paths, frame)));
    let caches = [0, 1].map(|refinement_level| {
        let mut state = BakeState::new(4, 0);
        let listener: Listener = &|_, _| ();
        let Ok(()) = state.add_camera_path(
            &scene,
            &path,
            "path",
            SIZE,
            refinement_level,
            listener,
            &mut NoKeeper,
        );
        assert_eq!(state.refinement_level("path"), Some(refinement_level));
        state.irradiance_cache(&scene, "path").unwrap()
    });
    let [usual, finer] = caches.each_ref().map(|cache| cache.record_count()[0]);
    assert!(2 * finer > 3 * usual, "{usual} {finer}");
    for cache in &caches {
        let errors = cache_errors(&scene, &path, &cached_settings(4), cache).unwrap();
        assert_eq!(errors.len(), 9);
        let cached = Renderer::new(&scene, cached_settings(4), Some(cache)).unwrap();
        for (frame, reference) in &references {
            let both = pixels(&cached, *frame).into_iter().zip(reference);
            let both = both.map(|(technique, oracle)| HeldOutPixel {
                technique,
                oracle: *oracle,
            });
            let check = BiasCheck::of(&both.collect::<Vec<_>>(), 0.0);
            let (bias, square) = (check.mean_bias, check.squared_bias);
            assert!(
                bias.mean.abs() < 0.005 + 3.0 * bias.error,
                "{frame}: {bias:?}"
            );
            let [low, high] = errors[*frame as usize].interval();
            let (least, greatest) = (low - 3.0 * square.error, high + 3.0 * square.error);
            assert!(
                (least..greatest).contains(&square.mean),
                "{low} {square:?} {high}"
            );
            assert!(high <= 0.001, "{high}");
        }
    }
}

/// The cache of another scene has the error that it should.
#[test]
fn the_error_of_a_wrong_cache_is_measured() {
    let of_intensity = |intensity: f64| {
        let light = light("(0, 0, 0)", intensity);
        scene(&format!(
            "Scene(materials: {{\"grey\": (diffuse: (0.5, 0.5, 0.5))}}, lights: [{light}],
             objects: [sphere(center: (0, 0, 0), radius: 1, material: \"grey\")])"
        ))
    };
    let eyes = [DVec3::new(0.3, 0.0, 0.0), DVec3::new(0.2, 0.1, 0.0)];
    let path = glide(eyes, DVec3::X);
    let right = of_intensity(1.0);
    let wrong = baked(&of_intensity(1.2), &path, 1);
    let direct = 0.5 / PI;
    let indirect = 0.5 * direct;
    // It is relative to the mean of the right and the wrong radiance.
    let expected = (0.2 * indirect).powi(2) / ((direct + 1.1 * indirect).powi(2) + 0.01);
    for error in cache_errors(&right, &path, &cached_settings(1), &wrong.cache).unwrap() {
        let off = error.rel_mse / expected - 1.0;
        assert!(off.abs() < 0.03, "{off}");
    }
}

/// The six sides of a box, two metres high and deep, from z = 0 on.
pub(crate) fn box_of(material: &str, x0: f64, x1: f64) -> String {
    let quad = |[a, b, c, d]: [&str; 4]| {
        format!(
            "triangle(vertices: [{a}, {b}, {c}], material: \"{material}\"),
             triangle(vertices: [{a}, {c}, {d}], material: \"{material}\"),"
        )
    };
    let vertex = |x: f64, y: i32, z: i32| format!("({x}, {y}, {z})");
    let [a, b, c, d] = [(0, 0), (2, 0), (2, 2), (0, 2)].map(|(y, z)| vertex(x0, y, z));
    let [e, f, g, h] = [(0, 0), (2, 0), (2, 2), (0, 2)].map(|(y, z)| vertex(x1, y, z));
    [
        quad([&a, &b, &c, &d]),
        quad([&e, &f, &g, &h]),
        quad([&a, &e, &f, &b]),
        quad([&d, &h, &g, &c]),
        quad([&a, &e, &h, &d]),
        quad([&b, &f, &g, &c]),
    ]
    .concat()
}

/// White corners, a light 3 cm from a corner, textures, highlights, mirrors and several lights.
#[test]
fn the_cache_agrees_with_path_tracing_in_varied_scenes() {
    let room = |light: String, albedo: f64| {
        let white = format!("\"white\": (diffuse: ({albedo}, {albedo}, {albedo}))");
        let walls = box_of("white", -1.0, 1.0);
        scene(&format!(
            "Scene(materials: {{{white}}}, lights: [{light}], objects: [{walls}])"
        ))
    };
    let corner = [DVec3::new(0.8, 1.2, 1.8), DVec3::new(0.5, 1.0, 1.6)];
    let low = DVec3::new(-0.9, 0.1, 0.1);
    let hall = [DVec3::new(0.3, 1.7, -22.0), DVec3::new(2.6, 1.8, -24.6)];
    let near_mirror = [DVec3::new(-0.3, 1.5, 3.7), DVec3::new(0.3, 1.4, 3.0)];
    for (name, scene, path) in [
        (
            "white",
            room(light("(0, 1.8, 1)", 0.5), 0.9),
            glide(corner, low),
        ),
        (
            "corner",
            room(light("(-0.97, 0.02, 0.03)", 2.0), 0.7),
            glide(corner, low),
        ),
        (
            "gallery",
            shipped_scene("gallery.ron"),
            glide(hall, DVec3::new(0.0, 1.6, -26.4)),
        ),
        (
            "test2",
            shipped_scene("test2.ron"),
            glide(near_mirror, DVec3::new(0.1, 0.8, -1.0)),
        ),
    ] {
        let by_cache = RenderSettings {
            target_error: Some(0.004),
            ..cached_settings(4)
        };
        let baked = bake(&scene, &path, "path", &by_cache, None, &|_, _| ());
        let by_paths = RenderSettings {
            integrator: monte_carlo(4, &[scaled(128, 128, 1024)]),
            ..by_cache.clone()
        };
        let renderers =
            [by_cache, by_paths].map(|s| Renderer::new(&scene, s, Some(&baked.cache)).unwrap());
        let mut held_out = Vec::new();
        let pixels: Vec<(u32, u32)> = (0..SIZE.0 * SIZE.1)
            .step_by(7)
            .map(|number| (number % SIZE.0, number / SIZE.0))
            .collect();
        for number in [0, 3, 8] {
            let camera = path.camera(number);
            let [technique, oracle] = renderers
                .each_ref()
                .map(|renderer| renderer.render_pixels(&camera, number, &pixels));
            let both = technique.into_iter().zip(oracle);
            held_out.extend(both.map(|(technique, oracle)| HeldOutPixel { technique, oracle }));
        }
        let check = BiasCheck::of(&held_out, 0.0);
        let [_, high] = check.squared_bias.interval(held_out.len() as u32 - 1);
        assert!(baked.missed.is_empty() && high < 0.004, "{name}: {check:?}");
        let [low, high] = check.mean_bias.interval(held_out.len() as u32 - 1);
        assert!(low < 0.005 && high > -0.005, "{name}: {check:?}");
    }
}

/// A bright room beside a dark one, a thin wall between them: no light comes through.
#[test]
fn a_closed_room_stays_dark() {
    let scene = scene(&format!(
        "Scene({GREY} lights: [{}], objects: [{}{}])",
        light("(-1, 1, 1)", 5.0),
        box_of("grey", -2.0, -0.005),
        box_of("grey", 0.005, 2.0)
    ));
    // From one room into the other, without a frame within the wall: records are on both sides of it.
    let path = glide(
        [DVec3::new(-1.8, 1.2, 1.7), DVec3::new(1.7, 1.2, 1.7)],
        DVec3::new(0.0, 0.1, 0.3),
    );
    let baked = baked(&scene, &path, 4);
    let bright = cached(&scene, &path, &baked, 0);
    assert!(bright.iter().all(|pixel| pixel.min_element() > 0.01));
    let dark = cached(&scene, &path, &baked, 8);
    assert!(
        dark.iter().all(|pixel| *pixel == Vec3::ZERO),
        "{}",
        mean(&dark)
    );
}

/// The same bits for any number of threads.
#[test]
fn threads_do_not_matter() {
    let scene = shipped_scene("test2.ron");
    let path = glide(
        [DVec3::new(-0.3, 1.5, 3.7), DVec3::new(0.3, 1.4, 3.2)],
        DVec3::new(0.1, 1.0, -1.0),
    );
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let baked = baked(&scene, &path, 3);
            [0, 5].map(|number| cached(&scene, &path, &baked, number))
        })
    };
    let one = on(1);
    assert!(one == on(2));
    assert!(one == on(4));
}

/// Scenes without diffuse surfaces, and empty ones, have no records.
#[test]
fn scenes_without_diffuse_surfaces_have_no_records() {
    let black = format!(
        "Scene(materials: {{\"black\": ()}}, background: (1, 1, 1), objects: [{}])",
        plate(0.0, 3.0, "black")
    );
    for text in [&*black, "Scene(background: (1, 1, 1), objects: [])"] {
        let scene = scene(text);
        let eyes = [DVec3::new(0.0, 1.0, 3.0), DVec3::new(0.0, 1.0, 2.0)];
        let path = glide(eyes, DVec3::ZERO);
        let baked = baked(&scene, &path, 4);
        assert_eq!(baked.cache.record_count(), [0, 0]);
        let expected = path_traced(&scene, &path, 1, 3);
        assert_eq!(cached(&scene, &path, &baked, 3), expected);
    }
}

/// A plate under a sky of radiance L has its albedo times L, or two thirds of it under a cosine sky: what records gather and
/// what is sampled where the camera sees it add up to the whole, no more.
#[test]
fn the_sky_is_counted_once() {
    for (background, part) in [
        ("(1, 2, 4)", 1.0),
        ("gradient(zenith: (1, 2, 4), horizon: (0, 0, 0))", 2.0 / 3.0),
    ] {
        let scene = scene(&format!(
            "Scene(
                background: {background},
                materials: {{\"grey\": (diffuse: (0.5, 0.5, 0.5))}},
                objects: [{}],
            )",
            plate(0.0, 50.0, "grey")
        ));
        let path = glide(
            [DVec3::new(0.0, 2.0, 2.0), DVec3::new(1.0, 2.0, 2.0)],
            DVec3::ZERO,
        );
        let baked = baked(&scene, &path, 2);
        let seen = mean(&cached(&scene, &path, &baked, 3));
        let expected = 0.5 * part * Vec3::new(1.0, 2.0, 4.0);
        assert!(
            (seen / expected - 1.0).abs().max_element() < 0.02,
            "{background}: {seen}"
        );
    }
}

/// The room of `scenes/test3.ron`, lit by a lamp on the ceiling, by the sky through its open front and by a sun.
#[test]
fn emitters_sky_and_sun_are_counted_once() {
    let text = std::fs::read_to_string(root().join("scenes/test3.ron")).unwrap();
    let (head, rest) = text.split_once("    lights: [").unwrap();
    let (_, objects) = rest.split_once("    objects: [").unwrap();
    let lamp = plate(0.9, 0.3, "lamp");
    let head = head.replace(
        "materials: {",
        "background: (0.5, 1, 2), materials: {\"lamp\": (emission: (4, 3, 2), two_sided: true),",
    );
    let scene = scene(&format!(
        "{head} lights: [sun(direction: (0.5, -0.6, -1), irradiance: (2, 1.5, 1), angle: 5)],
         objects: [{lamp}{objects}"
    ));
    let path = across_the_room();
    let baked = baked(&scene, &path, 4);
    for frame in [0, 8] {
        let seen = mean(&cached(&scene, &path, &baked, frame));
        let expected = mean(&path_traced(&scene, &path, 64, frame));
        let ratio = seen / expected;
        assert!((ratio - 1.0).abs().max_element() < 0.02, "{frame}: {ratio}");
    }
}
