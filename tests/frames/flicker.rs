//! The flicker metric on synthetic noise of known variance.

use crate::support::*;
use flythrough::film::Film;
use flythrough::render::{Flicker, Match, Reprojection};
use flythrough::sampling::Random;
use glam::Vec3;
use std::sync::LazyLock;

const WIDTH: u32 = 96;
const HEIGHT: u32 = 72;
const WHITE: f32 = 0.5;

/// Two frames of a room without noise, and the reprojection between them.
struct Room {
    reprojection: Reprojection,
    truth: [Film; 2],
}

fn room(scene: &str, path: &str, frames: [u32; 2]) -> Room {
    let scene = shipped_scene(scene);
    let [from, to] = frames.map(|frame| shipped_path(path).camera(frame));
    let settings = settings(ray_tracing(), WIDTH, HEIGHT);
    let film = |camera| renderer(&scene, &settings).render_frame(camera, 0).film;
    Room {
        reprojection: Reprojection::new(&scene, &from, &to, WIDTH, HEIGHT),
        truth: [film(&from), film(&to)],
    }
}

static MOVING: LazyLock<Room> = LazyLock::new(|| room("test3.ron", "test3.ron", [0, 2]));
static STILL: LazyLock<Room> = LazyLock::new(|| room("test2.ron", "zoom.ron", [5, 5]));

/// A film with noise added: of mean 0, and of standard deviation `sigma` by pixel.
fn noisy(film: &Film, seed: u64, sigma: impl Fn(usize) -> f32) -> Film {
    let mut random = Random::new(seed);
    let mut noisy = film.clone();
    for (number, pixel) in noisy.pixels_mut().iter_mut().enumerate() {
        // The sum of twelve uniform numbers has the variance 1, and is nearly normal but for its tails.
        let normal: Vec3 = (0..12).map(|_| random.vector(0.5)).sum();
        *pixel += sigma(number) * normal;
    }
    noisy
}

impl Room {
    fn flicker(&self, picture: &[Film; 2], a: &[Film; 2], b: &[Film; 2]) -> Flicker {
        let [picture, a, b] = [picture, a, b].map(|films| films.each_ref());
        self.reprojection.flicker(picture, a, b, WHITE)
    }

    /// The expected flicker of noise of standard deviation 1, whose `correlation` is that of the same pixel in both
    /// frames.
    fn square(&self, correlation: f64) -> f64 {
        let later = self.truth[1].pixels();
        let of_match = |of: &Match| {
            let mut weights = 1.0;
            for (pixel, weight) in self.reprojection.taps(of) {
                weights += weight * weight;
                if pixel == of.pixel {
                    weights -= 2.0 * correlation * weight;
                }
            }
            let dark = f64::from(0.1 * WHITE).powi(2);
            let inverse = |r: f32| 1.0 / (f64::from(r).powi(2) + dark);
            weights * later[of.pixel].to_array().map(inverse).iter().sum::<f64>() / 3.0
        };
        let matches = self.reprojection.matches();
        matches.iter().map(of_match).sum::<f64>() / matches.len() as f64
    }
}

fn assert_within(flicker: Flicker, expected: f64, errors: f64) {
    let off = (flicker.square - expected).abs();
    assert!(
        off <= errors * flicker.standard_error,
        "{flicker:?} instead of {expected}"
    );
}

#[test]
fn the_truth_does_not_flicker() {
    let room = &*MOVING;
    let [a, b] = [10, 20]
        .map(|seed| [0, 1].map(|frame| noisy(&room.truth[frame], seed + frame as u64, |_| 0.005)));
    let flicker = room.flicker(&room.truth, &a, &b);
    assert_within(flicker, 0.0, 3.0);
    assert!(flicker.standard_error > 0.0);
    // Compared with itself a picture has no error at all.
    let itself = room.flicker(&a, &a, &b);
    assert_eq!((itself.square, itself.relative), (0.0, 0.0));
}

#[test]
fn independent_noise_is_measured() {
    let room = &*MOVING;
    let sigma = 0.01;
    let picture = [0, 1].map(|frame| noisy(&room.truth[frame], 1 + frame as u64, |_| sigma));
    let expected = f64::from(sigma).powi(2) * room.square(0.0);
    let exact = room.flicker(&picture, &room.truth, &room.truth);
    assert_within(exact, expected, 4.0);
    assert!(exact.standard_error < 0.02 * expected, "{exact:?}");
    assert_eq!(exact.relative, exact.square.sqrt());
    // The same with references of half the noise, though less precisely.
    let [a, b] = [10, 20].map(|seed| {
        [0, 1].map(|frame| noisy(&room.truth[frame], seed + frame as u64, |_| 0.5 * sigma))
    });
    let flicker = room.flicker(&picture, &a, &b);
    assert_within(flicker, expected, 4.0);
    assert!(flicker.standard_error > exact.standard_error);
}

#[test]
fn noise_that_is_fixed_to_the_film_flickers_if_the_camera_moves() {
    let sigma = 0.01;
    let fixed_noise = |room: &Room| {
        let picture = [0, 1].map(|frame| noisy(&room.truth[frame], 1, |_| sigma));
        room.flicker(&picture, &room.truth, &room.truth)
    };
    let still = fixed_noise(&STILL);
    assert_eq!((still.square, still.standard_error), (0.0, 0.0));
    // The room is closed.
    assert_eq!(still.matched, 1.0);
    let expected = f64::from(sigma).powi(2) * MOVING.square(1.0);
    let moving = fixed_noise(&MOVING);
    assert_within(moving, expected, 4.0);
    assert!(moving.square > 20.0 * moving.standard_error);
}

/// With noise that grows from left to right and is correlated between neighbours.
#[test]
fn the_standard_error_is_the_deviation_of_repeated_runs() {
    let room = &*MOVING;
    let sigma = |pixel: usize| 0.005 + 2e-4 * (pixel % WIDTH as usize) as f32;
    let shared = |film: &Film, seed| {
        let noise = noisy(&Film::new(WIDTH, HEIGHT), seed, sigma);
        let neighbours = noise.pixels().iter().cycle().skip(1);
        let mut film = film.clone();
        let pixels = film.pixels_mut().iter_mut();
        for (pixel, (own, other)) in pixels.zip(noise.pixels().iter().zip(neighbours)) {
            *pixel += own + other;
        }
        film
    };
    let run = |seed: u64| {
        let picture =
            [0, 1].map(|frame: usize| shared(&room.truth[frame], 2 * seed + frame as u64));
        let [picture, truth] = [&picture, &room.truth].map(|films| films.each_ref());
        // So bright that bright and dark pixels count alike.
        let white = 20.0 * WHITE;
        room.reprojection.flicker(picture, truth, truth, white)
    };
    let runs: Vec<Flicker> = (0..64).map(run).collect();
    let mean = |of: &dyn Fn(&Flicker) -> f64| runs.iter().map(of).sum::<f64>() / 64.0;
    let square = mean(&|run| run.square);
    let variance = mean(&|run| (run.square - square).powi(2)) * 64.0 / 63.0;
    let estimated = mean(&|run| run.standard_error.powi(2));
    let ratio = (estimated / variance).sqrt();
    assert!((0.75..1.3).contains(&ratio), "{ratio}");
}
