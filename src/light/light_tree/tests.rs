//! Tests of light trees: against brute force, and by their promises.

use super::*;
use crate::math::{Aabb, to_world};
use crate::sampling::{Random, uniform_cone, uniform_sphere};
use glam::{DVec3, Vec3Swizzles};

/// A Lambertian triangle that emits from its front.
fn triangle_light(triangle: [Vec3; 3], power: f32) -> LightBounds {
    let [a, b, c] = triangle;
    LightBounds {
        bounds: Aabb::of(triangle),
        axis: (b - a).cross(c - a).normalize(),
        cos_theta_o: 1.0,
        cos_theta_e: 0.0,
        is_two_sided: false,
        power,
    }
}

/// Triangles of all sizes, some of them long, in the cube from -1 to 1.
fn triangles(random: &mut Random, count: usize) -> Vec<[Vec3; 3]> {
    (0..count)
        .map(|_| {
            let size = libm::exp2f(-12.0 * random.unit());
            let mut triangle = random.triangle(1.0, size);
            if random.below(4) == 0 {
                triangle[1] = triangle[0] + 1e-3 * (triangle[1] - triangle[0]);
            }
            triangle
        })
        .collect()
}

/// Emitters of all kinds: boxes with cones of normals, some of which emit beyond the horizon or from both sides.
fn emitters(random: &mut Random, count: usize) -> Vec<LightBounds> {
    (0..count)
        .map(|_| {
            let size = libm::exp2f(-10.0 * random.unit());
            LightBounds {
                bounds: Aabb::of(random.triangle(1.0, size)),
                axis: direction(random),
                cos_theta_o: [1.0, 0.9, 0.0, -0.7, -1.0][random.below(5)],
                cos_theta_e: [0.0, 0.0, 0.9, -0.3, -1.0][random.below(5)],
                is_two_sided: random.below(3) == 0,
                power: libm::exp2f(20.0 * random.unit() - 10.0),
            }
        })
        .collect()
}

fn direction(random: &mut Random) -> Vec3 {
    uniform_sphere(random.unit(), random.unit()).normalize()
}

/// Points far away, among the emitters, and within or next to the box of one of them.
fn point(random: &mut Random, lights: &[LightBounds]) -> Vec3 {
    let Aabb { min, max } = lights[random.below(lights.len())].bounds;
    let place = random.vector(0.5) + 0.5;
    match random.below(4) {
        0 => random.vector(20.0),
        1 => random.vector(1.0),
        2 => min + place * (max - min),
        _ => min + (4.0 * place - 1.5) * (max - min),
    }
}

#[test]
fn whatever_lights_a_point_has_a_probability() {
    let mut random = Random::new(1);
    for count in [1, 2, 5, 200] {
        let triangles = triangles(&mut random, count);
        let lights: Vec<LightBounds> = triangles.iter().map(|t| triangle_light(*t, 1.0)).collect();
        let tree = LightTree::new(&lights);
        let mut lit = 0;
        for i in 0..100_000 / count {
            let mut p = point(&mut random, &lights);
            let [a, b, c] = triangles[random.below(count)];
            let mut n = direction(&mut random);
            if i % 2 == 0 {
                // Edge-on: next to the plane of a triangle, which is itself next to the horizon.
                let axis = (b - a).cross(c - a).normalize();
                p = a + 3.0 * random.unit() * (b - a) - 2.0 * random.unit() * (c - a);
                p += (random.unit() - 0.5) * libm::exp2f(-20.0 * random.unit()) * axis;
                n = (to_world(axis, random.vector(1.0).with_z(0.0)) + 1e-3 * random.unit() * n)
                    .normalize();
            }
            for (light, triangle) in triangles.iter().enumerate() {
                let [a, b, c] = triangle.map(|vertex| vertex.as_dvec3() - p.as_dvec3());
                let faces = -a.dot((b - a).cross(c - a)) > 0.0;
                let is_above = [a, b, c].iter().any(|v| v.dot(n.as_dvec3()) > 0.0);
                if faces && is_above {
                    lit += 1;
                    assert!(tree.probability(p, n, light) > 0.0, "{p} {n} {triangle:?}");
                }
            }
        }
        assert!(lit > 10_000);
    }
}

/// The same for emitters with cones of normals: a point of the box and a normal of the cone are taken at random.
#[test]
fn whatever_a_normal_lights_has_a_probability() {
    let mut random = Random::new(2);
    let lights = emitters(&mut random, 100);
    let tree = LightTree::new(&lights);
    let mut lit = 0;
    for _ in 0..2_000 {
        let (p, n) = (point(&mut random, &lights), direction(&mut random));
        for (i, light) in lights.iter().enumerate() {
            let Aabb { min, max } = light.bounds;
            let q = min + (random.vector(0.5) + 0.5) * (max - min);
            let local = uniform_cone(random.unit(), random.unit(), 1.0 - light.cos_theta_o);
            let normal = to_world(light.axis, local).as_dvec3();
            let to_light: DVec3 = (q.as_dvec3() - p.as_dvec3()).normalize_or_zero();
            let mut cos = -normal.dot(to_light);
            if light.is_two_sided {
                cos = cos.abs();
            }
            // But for the rounding of the normal.
            let emits = cos > f64::from(light.cos_theta_e) + 1e-6;
            if emits && to_light.dot(n.as_dvec3()) > 0.0 {
                lit += 1;
                assert!(tree.probability(p, n, i) > 0.0, "{p} {n} {light:?}");
            }
        }
    }
    assert!(lit > 10_000);
}

#[test]
fn samples_are_as_frequent_as_their_probability() {
    let mut random = Random::new(3);
    let mut reached = 0;
    for count in [1, 2, 3, 7, 300] {
        let mut lights = emitters(&mut random, count);
        for light in &mut lights {
            (light.cos_theta_o, light.cos_theta_e) = (light.cos_theta_o.max(0.9), 0.0);
        }
        let tree = LightTree::new(&lights);
        for _ in 0..40 {
            let (p, n) = (point(&mut random, &lights), direction(&mut random));
            let expected: Vec<f32> = (0..count).map(|i| tree.probability(p, n, i)).collect();
            let sum: f64 = expected.iter().map(|p| f64::from(*p)).sum();
            let steps = 1 << 14;
            let mut counts = vec![0_u32; count];
            for i in 0..steps {
                let Some((light, probability)) = tree.sample(p, n, i as f32 / steps as f32) else {
                    assert_eq!(sum, 0.0);
                    break;
                };
                assert_eq!(probability.to_bits(), expected[light].to_bits());
                counts[light] += 1;
            }
            if sum > 0.0 {
                assert!((sum - 1.0).abs() < 1e-5, "{sum}");
                reached += 1;
            }
            // Every emitter has one interval of the numbers, which are evenly spaced.
            for (hits, probability) in counts.iter().zip(expected) {
                let hits_expected = probability * steps as f32;
                assert!(
                    (*hits as f32 - hits_expected).abs() < 1.01,
                    "{hits} {hits_expected}"
                );
            }
        }
    }
    assert!(reached > 100);
}

#[test]
fn nothing_without_power_is_chosen() {
    assert!(LightTree::new(&[]).is_empty());
    assert_eq!(LightTree::new(&[]).sample(Vec3::ZERO, Vec3::Z, 0.5), None);
    let mut random = Random::new(4);
    let mut lights = emitters(&mut random, 50);
    for (i, power) in [0.0, -1.0, f32::NAN, f32::INFINITY].into_iter().enumerate() {
        lights[10 * i].power = power;
    }
    let none: Vec<LightBounds> = (0..4).map(|i| lights[10 * i]).collect();
    assert!(LightTree::new(&none).is_empty());
    let tree = LightTree::new(&lights);
    for _ in 0..5_000 {
        let (p, n) = (point(&mut random, &lights), direction(&mut random));
        if let Some((light, probability)) = tree.sample(p, n, random.unit()) {
            assert!(lights[light].power > 0.0 && lights[light].power.is_finite());
            assert!(probability > 0.0 && probability <= 1.0);
        }
        assert!((0..4).all(|i| tree.probability(p, n, 10 * i) == 0.0));
    }
}

/// Points at distances that halve, where the heuristic would take one off at a time; many at one place; on a line; and
/// of powers and distances that single precision hardly has.
#[test]
fn hard_sets_have_a_tree() {
    let at = |position: Vec3, power: f32| LightBounds {
        bounds: Aabb::of([position]),
        axis: Vec3::Z,
        cos_theta_o: -1.0,
        cos_theta_e: 0.0,
        is_two_sided: false,
        power,
    };
    let halving = (0..140).map(|i| libm::exp2f(-(i as f32)));
    let sets: [Vec<LightBounds>; 4] = [
        halving.map(|x| at(Vec3::new(x, x, 1.0), 1.0)).collect(),
        vec![at(Vec3::ONE, 2.0); 1000],
        (0..1000).map(|i| at(Vec3::X * i as f32, 1.0)).collect(),
        vec![
            at(Vec3::X, 1e-38),
            at(Vec3::Y, 3e38),
            at(Vec3::Z, 3e38),
            at(Vec3::Z * 1e9, 1e-20),
        ],
    ];
    for lights in sets {
        let tree = LightTree::new(&lights);
        for p in [Vec3::ZERO, Vec3::Z, Vec3::ONE, Vec3::splat(-1e6)] {
            let n = (Vec3::splat(0.5) - p).normalize();
            let sum: f64 = (0..lights.len())
                .map(|i| f64::from(tree.probability(p, n, i)))
                .sum();
            assert!((sum - 1.0).abs() < 1e-5, "{sum}");
        }
    }
}

#[test]
fn large_sets_take_little_memory() {
    let mut random = Random::new(5);
    let count = 50_000;
    let tree = LightTree::new(&emitters(&mut random, count));
    assert!(tree.memory() < 150 * count, "{}", tree.memory());
    for _ in 0..1000 {
        let (p, n) = (random.vector(1.0), direction(&mut random));
        let (light, probability) = tree.sample(p, n, random.unit()).expect("some emitter");
        assert_eq!(probability, tree.probability(p, n, light));
    }
}

/// The relative variance of one sample of the light that 1,000 small emitters on the ceiling of a hall send to points
/// of the floor: 3.7 where emitters are chosen by their power, a fortieth of that here.
#[test]
fn variance_in_a_hall() {
    let mut random = Random::new(6);
    let corner = Vec3::new(0.1, 0.0, 0.0);
    let lights: Vec<LightBounds> = (0..1000)
        .map(|_| {
            let place = Vec3::new(40.0 * random.unit(), 6.0, 20.0 * random.unit());
            triangle_light([place, place + corner, place + corner.zyx()], 1.0)
        })
        .collect();
    let tree = LightTree::new(&lights);
    let (mut by_tree, mut by_power) = (0.0, 0.0);
    let points = 200;
    for _ in 0..points {
        let p = Vec3::new(40.0 * random.unit(), 0.0, 20.0 * random.unit());
        let (mut sum, mut squares, mut weighted) = (0.0, 0.0, 0.0);
        for (i, light) in lights.iter().enumerate() {
            let to_light = (light.bounds.center() - p).as_dvec3();
            let geometry = to_light.y * to_light.y / to_light.length_squared().powi(2);
            sum += geometry;
            squares += geometry * geometry;
            weighted += geometry * geometry / f64::from(tree.probability(p, Vec3::Y, i));
        }
        by_power += (squares * lights.len() as f64 / (sum * sum) - 1.0) / f64::from(points);
        by_tree += (weighted / (sum * sum) - 1.0) / f64::from(points);
    }
    assert!(by_power > 3.0 && by_tree < 0.1, "{by_power} {by_tree}");
}
