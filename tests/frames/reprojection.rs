//! Reprojection of one frame onto another, against known geometry.

use crate::support::*;
use flythrough::camera::Camera;
use flythrough::film::Film;
use flythrough::render::Reprojection;
use flythrough::scene::Scene;
use glam::{DVec2, DVec3, Vec3};

const WIDTH: u32 = 96;
const HEIGHT: u32 = 72;

fn reprojection(scene: &Scene, from: &Camera, to: &Camera) -> Reprojection {
    Reprojection::new(scene, from, to, WIDTH, HEIGHT)
}

/// The root mean square deviation of the channels from `mean`.
fn deviation(pixels: &[Vec3], mean: Vec3) -> f32 {
    let squares: f32 = pixels.iter().map(|p| p.distance_squared(mean)).sum();
    (squares / (3 * pixels.len()) as f32).sqrt()
}

#[test]
fn a_lit_plane_has_no_residual() {
    let scene = scene(
        "Scene(
            materials: {
                \"red\": (diffuse: (0.9, 0.1, 0.1)),
                \"green\": (diffuse: (0.1, 0.9, 0.1)),
                \"blue\": (diffuse: (0.1, 0.1, 0.9)),
            },
            lights: [(position: (0.5, 1.5, 0.3), intensity: (1, 1, 1))],
            objects: [triangle(
                vertices: [(-9, 0, 9), (9, 0, 9), (0, 0, -9)],
                vertex_materials: [\"red\", \"green\", \"blue\"],
            )],
        )",
    );
    let from = camera(DVec3::new(-0.5, 2.0, 3.0), DVec3::new(0.0, 0.0, 0.5), 40.0);
    let to = camera(DVec3::new(-0.2, 2.1, 2.8), DVec3::new(0.1, 0.0, 0.4), 40.0);
    let reprojection = reprojection(&scene, &from, &to);
    let settings = settings(ray_tracing(), WIDTH, HEIGHT);
    let films = [&from, &to].map(|camera| renderer(&scene, &settings).render_frame(camera, 0).film);
    let [from, to] = films.each_ref();
    let mean = to.pixels().iter().sum::<Vec3>() / (WIDTH * HEIGHT) as f32;
    let contrast = deviation(to.pixels(), mean);
    let residual = deviation(&reprojection.residual([from, to]), Vec3::ZERO);
    let pairs = to.pixels().iter().zip(from.pixels());
    let moved: Vec<Vec3> = pairs.map(|(to, from)| to - from).collect();
    let moved = deviation(&moved, Vec3::ZERO);
    assert!(moved > 0.1 * contrast);
    assert!(residual < 1e-3 * contrast);
    assert!(reprojection.matched() > 0.85);
}

#[test]
fn what_a_sphere_hides_is_not_matched() {
    let (center, radius) = (DVec3::new(0.0, 1.5, 1.0), 0.5);
    let scene = scene(
        "Scene(
            materials: {\"grey\": (diffuse: (0.5, 0.5, 0.5))},
            objects: [
                sphere(center: (0, 1.5, 1), radius: 0.5, material: \"grey\"),
                triangle(vertices: [(-9, -9, 0), (9, -9, 0), (0, 20, 0)], material: \"grey\"),
            ],
        )",
    );
    let target = DVec3::new(0.0, 1.5, 0.5);
    let from = camera(DVec3::new(-0.5, 1.5, 5.0), target, 40.0);
    let to = camera(DVec3::new(0.5, 1.6, 5.2), target, 40.0);
    let reprojection = reprojection(&scene, &from, &to);
    let size = DVec2::new(WIDTH.into(), HEIGHT.into());
    let rays = to.rays(size, DVec3::ZERO);
    let pixel = 2.0 * from.half_height / size.y;
    // The distance of the sphere's centre from the line through an eye and a point.
    let line_distance = |eye: DVec3, point: DVec3| {
        let direction = (point - eye).normalize();
        (center - eye).cross(direction).length()
    };
    let (mut hidden, mut seen, mut of_sphere) = (0, 0, [0, 0]);
    for number in 0..(WIDTH * HEIGHT) as usize {
        let (x, y) = (number as u32 % WIDTH, number as u32 / WIDTH);
        let ray = rays.through(DVec2::new(x.into(), y.into()) + 0.5);
        let wall = ray.at(f64::from(-ray.origin.z / ray.direction.z));
        let found = reprojection.matches().iter().find(|of| of.pixel == number);
        if line_distance(to.position, wall) < radius {
            of_sphere[usize::from(found.is_some())] += 1;
            continue;
        }
        // How far from the sphere's outline the other camera sees the wall, in pixels.
        let margin = (line_distance(from.position, wall) - radius) / (4.0 * pixel);
        let film = from.project(size, wall).unwrap();
        let inside = film.cmpge(DVec2::splat(0.501)).all() && film.cmple(size - 0.501).all();
        if margin < 0.0 {
            assert_eq!(found, None);
            hidden += 1;
        } else if margin > 1.5 && inside {
            assert!((found.unwrap().position + 0.5 - film).length() < 1e-3);
            seen += 1;
        }
    }
    assert!(hidden > 100 && seen > 3000);
    // A part of the sphere is hidden from the other eye.
    assert!(of_sphere[1] > 5 * of_sphere[0], "{of_sphere:?}");
}

#[test]
fn opposite_sides_of_a_surface_do_not_match() {
    let text = format!("Scene({GREY} objects: [{}])", plate(0.0, 9.0, "grey"));
    let plate = scene(&text);
    let above = camera(DVec3::new(0.0, 2.0, 3.0), DVec3::ZERO, 40.0);
    let below = camera(DVec3::new(0.0, -2.0, 3.0), DVec3::ZERO, 40.0);
    assert_eq!(reprojection(&plate, &above, &below).matched(), 0.0);
    assert_eq!(reprojection(&plate, &above, &above).matched(), 1.0);
}

#[test]
fn any_number_of_threads_gives_the_same() {
    let scene = shipped_scene("test2.ron");
    let path = shipped_path("translate_rotate.ron");
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| reprojection(&scene, &path.camera(10), &path.camera(11)))
    };
    let (one, many) = (on(1), on(5));
    assert_eq!(one.matches(), many.matches());
    assert!(one.matched() > 0.8);
}

#[test]
fn frames_without_matches_do_not_flicker() {
    let room = shipped_scene("test3.ron");
    let nothing = scene("Scene(objects: [])");
    let at = |x, y, z| camera(DVec3::new(x, y, z), DVec3::new(x + 1.0, y, z), 60.0);
    let back = camera(DVec3::ZERO, -DVec3::X, 60.0);
    // On a wall, within the mirror sphere, and in free space.
    let cameras = [
        at(-1.0, 0.0, 0.0),
        at(0.35, -0.5, -0.2),
        at(0.0, 0.0, 0.0),
        back,
    ];
    for (width, height) in [(1, 1), (2, 1), (7, 5)] {
        let film = Film::new(width, height);
        let films = [&film, &film];
        for from in &cameras {
            for to in &cameras {
                for scene in [&room, &nothing] {
                    let reprojection = Reprojection::new(scene, from, to, width, height);
                    let flicker = reprojection.flicker(films, films, films, 1.0);
                    assert!(flicker.standard_error == 0.0 && flicker.square == 0.0);
                    assert_eq!(flicker.matched, reprojection.matched());
                    let is_same = std::ptr::eq(scene, &room) && from == to;
                    assert!(!is_same || flicker.matched > 0.0);
                }
            }
        }
        let opposite = Reprojection::new(&room, &cameras[2], &cameras[3], width, height);
        assert_eq!(opposite.matched(), 0.0);
    }
    let still = Reprojection::new(&room, &cameras[2], &cameras[2], 1, 1);
    assert_eq!(still.matched(), 1.0);
    let reprojection = Reprojection::new(&nothing, &cameras[2], &cameras[2], 7, 5);
    assert_eq!(reprojection.matched(), 0.0);
}
