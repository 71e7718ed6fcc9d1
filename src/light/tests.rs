//! Skies of every kind: orientation, radiance, and sampling by the pdf.

use super::{Sky, SkyGradient, SkyMap};
use crate::sampling::{Random, SobolSequence, uniform_sphere};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// A map of random radiance with black texels, of which some are far brighter than others.
fn random_map(width: usize, height: usize, rotation: f64) -> SkyMap {
    let mut random = Random::new(7);
    let mut texel = || match random.below(4) {
        0 => Vec3::new(random.unit(), random.unit(), random.unit()),
        1 => 50.0 * Vec3::new(0.0, 0.0, random.unit()),
        _ => Vec3::ZERO,
    };
    let texels = (0..width * height).map(|_| texel()).collect();
    SkyMap::new(width, height, texels, rotation).expect("whole")
}

/// One bright texel on black.
fn sun(width: usize, height: usize, bright: usize) -> SkyMap {
    let mut texels = vec![Vec3::ZERO; width * height];
    texels[bright] = Vec3::splat(1e6);
    SkyMap::new(width, height, texels, 0.0).expect("whole")
}

fn cosine_sky() -> Sky {
    Sky::Gradient(SkyGradient::new(Vec3::ONE, Vec3::ZERO, Vec3::ZERO))
}

fn skies() -> Vec<Sky> {
    let gradient = SkyGradient::new(
        Vec3::new(0.2, 0.4, 3.0),
        Vec3::ONE,
        Vec3::new(0.3, 0.0, 0.0),
    );
    vec![
        Sky::Uniform(Vec3::ONE),
        Sky::default(),
        cosine_sky(),
        Sky::Gradient(SkyGradient::new(Vec3::ZERO, Vec3::X, Vec3::ZERO)),
        Sky::Gradient(SkyGradient::new(Vec3::ZERO, Vec3::ZERO, 1e-40 * Vec3::ONE)),
        Sky::Gradient(SkyGradient::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO)),
        Sky::Gradient(gradient),
        Sky::Map(random_map(16, 8, 0.7)),
        Sky::Map(random_map(1, 1, 0.0)),
        Sky::Map(random_map(7, 3, -2.0)),
        Sky::Map(random_map(1100, 600, 0.1)),
        Sky::Map(sun(40, 20, 3)),
        Sky::Map(sun(1024, 512, 100_000)),
        Sky::Map(SkyMap::new(2, 2, vec![Vec3::ZERO; 4], 0.0).expect("whole")),
    ]
}

/// Directions and their solid angles on a grid of `columns` and half as many rows, equally high in angle.
fn grid(columns: usize) -> impl Iterator<Item = (Vec3, f64)> {
    let rows = columns / 2;
    (0..columns * rows).map(move |i| {
        let (column, row) = ((i % columns) as f64, (i / columns) as f64);
        let (sin, cos) = libm::sincos(2.0 * PI * (column + 0.5) / columns as f64);
        let (radius, y) = libm::sincos(PI * (row + 0.5) / rows as f64);
        let circle = |row: f64| libm::cos(PI * row / rows as f64);
        let solid_angle = 2.0 * PI / columns as f64 * (circle(row) - circle(row + 1.0));
        let direction = DVec3::new(radius * cos, y, radius * sin).as_vec3();
        (direction, solid_angle)
    })
}

/// The octant of a direction in a frame that lies askew to the axes.
fn octant(direction: Vec3) -> usize {
    let axes = [
        Vec3::new(0.48, 0.64, 0.6),
        Vec3::new(-0.8, 0.6, 0.0),
        Vec3::new(-0.36, -0.48, 0.8),
    ];
    let sides = axes.map(|axis| usize::from(direction.dot(axis) > 0.0));
    sides[0] + 2 * sides[1] + 4 * sides[2]
}

#[test]
fn samples_follow_the_pdf_which_integrates_to_one() {
    for (i, sky) in skies().iter().enumerate() {
        // A multiple of the columns of the cells of suns.
        let mut expected = [0.0; 8];
        for (direction, solid_angle) in grid(2560) {
            expected[octant(direction)] += f64::from(sky.pdf(direction)) * solid_angle;
        }
        let integral: f64 = expected.iter().sum();
        assert!((integral - 1.0).abs() < 2e-3, "sky {i}: {integral}");

        let sequence = SobolSequence::new(3, 0, 0, 0);
        const SAMPLES: u32 = 1 << 18;
        let mut seen = [0.0; 8];
        for index in 0..SAMPLES {
            let (direction, pdf) = sky.sample(sequence.sample_2d(index, 0));
            assert!((direction.length() - 1.0).abs() < 1e-6);
            assert_eq!(pdf, sky.pdf(direction));
            let is_black = sky.radiance(direction) == Vec3::ZERO;
            assert!(
                pdf.is_finite() && (pdf > 0.0 || is_black),
                "sky {i}: {direction}"
            );
            seen[octant(direction)] += 1.0 / f64::from(SAMPLES);
        }
        for (seen, expected) in seen.iter().zip(expected) {
            assert!((seen - expected).abs() < 3e-3, "sky {i}: {seen} {expected}");
        }
    }
}

#[test]
fn the_pdf_is_above_0_wherever_light_comes_from() {
    let mut random = Random::new(2);
    for (i, sky) in skies().iter().enumerate() {
        for _ in 0..200_000 {
            let direction = uniform_sphere(random.unit(), random.unit());
            let radiance = sky.radiance(direction);
            assert!(radiance.is_finite() && radiance.min_element() >= 0.0);
            assert!(
                radiance == Vec3::ZERO || sky.pdf(direction) > 0.0,
                "sky {i}: {direction} {radiance}"
            );
        }
    }
}

/// The irradiance on a horizontal plate, by sampling the sky: pi L of a uniform one, 2 pi / 3 L of the cosine sky, whose
/// samples all have the same ratio of radiance to pdf.
#[test]
fn irradiance_by_sampling_the_sky() {
    let sequence = SobolSequence::new(1, 0, 0, 0);
    for (sky, expected) in [
        (Sky::Uniform(Vec3::ONE), PI),
        (cosine_sky(), 2.0 * PI / 3.0),
    ] {
        const SAMPLES: u32 = 1 << 16;
        let sum: f64 = (0..SAMPLES)
            .map(|index| {
                let (direction, pdf) = sky.sample(sequence.sample_2d(index, 0));
                f64::from(sky.radiance(direction).x * direction.y.max(0.0) / pdf)
            })
            .sum();
        let irradiance = sum / f64::from(SAMPLES);
        assert!((irradiance - expected).abs() < 1e-3, "{irradiance}");
    }
}

/// A small bright sun in a dim sky: sampled by its luminance, a few hundred samples give the irradiance that a fine grid
/// gives.
#[test]
fn a_sun_is_found() {
    let mut texels = vec![Vec3::splat(0.1); 512 * 256];
    texels[40 * 512 + 300] = Vec3::splat(1e5);
    let sky = Sky::Map(SkyMap::new(512, 256, texels, 0.0).expect("whole"));
    let cosine = |direction: Vec3| f64::from(direction.y.max(0.0));
    let exact: f64 = grid(4096)
        .map(|(d, solid_angle)| f64::from(sky.radiance(d).x) * cosine(d) * solid_angle)
        .sum();
    let sequence = SobolSequence::new(1, 0, 0, 0);
    let sum: f64 = (0..512)
        .map(|index| {
            let (direction, pdf) = sky.sample(sequence.sample_2d(index, 0));
            f64::from(sky.radiance(direction).x / pdf) * cosine(direction)
        })
        .sum();
    let sampled = sum / 512.0;
    assert!((sampled / exact - 1.0).abs() < 0.05, "{sampled} {exact}");
}

/// Mitsuba 3.9.1 gives the same colours: -Z at the left edge, then +X, +Z in the middle and -X; the top row is at +Y.
#[test]
fn columns_go_from_the_back_by_way_of_x() {
    let texels = (1..=8).map(|i| Vec3::splat(i as f32)).collect();
    let map = |rotation: f64| {
        let texels: &Vec<Vec3> = &texels;
        Sky::Map(SkyMap::new(4, 2, texels.clone(), rotation).expect("whole"))
    };
    // Centres of texels: an eighth of a turn from the axes, 45 degrees above and below the horizon.
    let center = |x: f32, y: f32, z: f32| Vec3::new(x, y * 2.0_f32.sqrt(), z).normalize();
    let centers = [[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]];
    for (column, [x, z]) in centers.into_iter().enumerate() {
        for (row, y) in [1.0, -1.0].into_iter().enumerate() {
            let expected = (4 * row + column + 1) as f32;
            let seen = map(0.0).radiance(center(x, y, z)).x;
            assert!((seen - expected).abs() < 1e-5, "{seen} {expected}");
        }
    }
    // Halfway between two columns and over the seam; constant towards the poles.
    for (direction, expected) in [
        (Vec3::X, 0.5 * (1.5 + 5.5)),
        (Vec3::Z, 0.5 * (2.5 + 6.5)),
        (Vec3::NEG_Z, 0.5 * (2.5 + 6.5)),
        (Vec3::new(1e-4, 1.0, -1e-4), 1.0),
        (Vec3::new(1e-4, -1.0, 1e-4), 6.0),
    ] {
        let seen = map(0.0).radiance(direction.normalize()).x;
        assert!((seen - expected).abs() < 1e-3, "{seen} {expected}");
    }
    // Counter-clockwise from above takes +Z to +X: what was in front is at the right of it.
    let turned = map(0.5 * PI);
    for (direction, _) in grid(32) {
        let Vec3 { x, y, z } = direction;
        let seen = turned.radiance(Vec3::new(z, y, -x)).x;
        let expected = map(0.0).radiance(direction).x;
        assert!((seen - expected).abs() < 1e-4, "{seen} {expected}");
    }
}

#[test]
fn gradients_are_linear_in_the_sine_of_the_elevation() {
    let [zenith, horizon, nadir] = [Vec3::X, Vec3::Y, Vec3::Z];
    let sky = Sky::Gradient(SkyGradient::new(zenith, horizon, nadir));
    assert_eq!(sky.radiance(Vec3::Y), zenith);
    assert_eq!(sky.radiance(Vec3::NEG_X), horizon);
    assert_eq!(sky.radiance(Vec3::NEG_Y), nadir);
    let seen = sky.radiance(Vec3::new(0.6, 0.8, 0.0));
    assert!((seen - Vec3::new(0.8, 0.2, 0.0)).length() < 1e-6);
    let seen = sky.radiance(Vec3::new(0.0, -0.6, 0.8));
    assert!((seen - Vec3::new(0.0, 0.4, 0.6)).length() < 1e-6);
}

#[test]
fn means_are_over_the_sphere() {
    for (i, sky) in skies().iter().enumerate() {
        let sum: DVec3 = grid(1024)
            .map(|(d, solid_angle)| sky.radiance(d).as_dvec3() * solid_angle)
            .sum();
        let mean = sum / (4.0 * PI);
        let found = sky.mean_radiance().as_dvec3();
        assert_eq!(sky.is_black(), found == DVec3::ZERO, "sky {i}");
        let error = (mean - found).length();
        assert!(error <= 2e-3 * found.length(), "sky {i}: {mean} {found}");
    }
}

#[test]
fn only_whole_images_are_maps_and_count_their_texels() {
    for (width, height, texels) in [(0, 0, 0), (2, 2, 3), (usize::MAX, 2, 4)] {
        assert!(SkyMap::new(width, height, vec![Vec3::ONE; texels], 0.0).is_none());
    }
    assert!(Sky::Map(random_map(100, 50, 0.0)).memory() >= 100 * 50 * 12);
}
