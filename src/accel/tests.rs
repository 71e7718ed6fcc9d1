//! Against brute force in double precision, on random and on hostile scenes, for every kernel.

use super::node::Child;
use super::*;
use glam::{DMat3, DVec3, Vec3Swizzles};

/// A small generator, so that every run tests the same rays.
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn unit(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    pub(super) fn vector(&mut self, size: f32) -> Vec3 {
        Vec3::new(self.unit() - 0.5, self.unit() - 0.5, self.unit() - 0.5) * 2.0 * size
    }
}

pub(super) fn sphere(center: Vec3, radius: f64) -> Sphere {
    Sphere {
        center: center.as_dvec3(),
        radius,
        rotation: DMat3::IDENTITY,
    }
}

/// Ray parameter of a triangle by Cramer's rule in double precision, and how far inside its edges
/// the point lies (negative: outside), as a barycentric weight.
fn triangle_oracle(ray: &Ray, [a, b, c]: [Vec3; 3]) -> Option<(f64, f64)> {
    let [a, b, c] = [a, b, c].map(|p| p.as_dvec3());
    let d = ray.direction.as_dvec3();
    let (e1, e2) = (b - a, c - a);
    let p = d.cross(e2);
    let det = e1.dot(p);
    if det == 0.0 {
        return None;
    }
    let s = ray.origin.as_dvec3() - a;
    let u = s.dot(p) / det;
    let q = s.cross(e1);
    let v = d.dot(q) / det;
    Some((e2.dot(q) / det, u.min(v).min(1.0 - u - v)))
}

fn check(triangles: &[[Vec3; 3]], spheres: &[Sphere], rays: &[Ray]) {
    for kernel in Kernel::available() {
        let bvh = Bvh::new(triangles, spheres.to_vec(), kernel);
        assert_eq!(bvh.validate(), Ok(()));
        let mut traversal = Traversal::default();
        check_packets(&bvh, rays);
        for ray in rays {
            let hit = bvh.closest(ray, &mut traversal);
            check_against_oracle(triangles, spheres, ray, hit);
            // A shadow ray sees exactly what the nearest-hit query sees.
            for share in [0.5, 1.0, 2.0] {
                let t_max = hit.map_or(1e30, |h| h.t as f32) * share;
                let shadow = Ray { t_max, ..*ray };
                let expected = hit.is_some_and(|h| h.t < f64::from(t_max));
                assert_eq!(bvh.occluded(&shadow, &mut traversal), expected, "{ray:?}");
            }
        }
    }
}

/// Rays of a wave and of a packet find what they find alone: as they come, and side by side.
pub(super) fn check_packets(bvh: &Bvh, rays: &[Ray]) {
    let mut traversal = Traversal::default();
    let mut hits = vec![None; rays.len()];
    bvh.closest_of_wave(rays, &mut hits, &mut traversal);
    let mut occluded = vec![false; rays.len()];
    bvh.occluded_of_packet(rays, &mut occluded, &mut traversal);
    for ((ray, hit), occluded) in rays.iter().zip(hits).zip(occluded) {
        assert_eq!(hit, bvh.closest(ray, &mut traversal), "{ray:?}");
        assert_eq!(occluded, bvh.occluded(ray, &mut traversal), "{ray:?}");
    }
    let beside = |ray: &Ray, i: usize| {
        let turned = ray.direction + ray.direction.yzx() * (i as f32 * 1e-3);
        Ray::new(ray.origin, turned)
    };
    let beside: Vec<Ray> = rays
        .iter()
        .step_by(8)
        .flat_map(|ray| (0..PACKET).map(move |i| beside(ray, i)))
        .collect();
    for rays in rays.chunks(PACKET).chain(beside.chunks(PACKET)) {
        let mut hits = vec![None; rays.len()];
        bvh.closest_of_packet(rays, &mut hits, &mut traversal);
        for (ray, hit) in rays.iter().zip(&hits) {
            assert_eq!(*hit, bvh.closest(ray, &mut traversal), "{ray:?}");
        }
        let shadow_rays: Vec<Ray> = (0..)
            .zip(rays.iter().zip(&hits))
            .map(|(i, (ray, hit))| Ray {
                t_max: hit.map_or(1e30, |h| h.t as f32) * [0.5, 1.0, 2.0][i % 3],
                ..*ray
            })
            .collect();
        let mut occluded = vec![false; rays.len()];
        bvh.occluded_of_packet(&shadow_rays, &mut occluded, &mut traversal);
        for (ray, occluded) in shadow_rays.iter().zip(occluded) {
            assert_eq!(occluded, bvh.occluded(ray, &mut traversal), "{ray:?}");
        }
    }
}

/// How sixteen points or fewer see a light, by hand; with every kernel the same bits; and what is in the way,
/// as rays find it one by one.
#[test]
fn sights_agree_with_single_rays() {
    let mut random = Random(11);
    let triangles: Vec<[Vec3; 3]> = (0..300)
        .map(|_| {
            let at = random.vector(2.0);
            [at, at + random.vector(0.5), at + random.vector(0.5)]
        })
        .collect();
    for (count, triangles) in [(300, &triangles[..]), (9, &triangles[..9])] {
        let bvhs = Kernel::available()
            .into_iter()
            .map(|k| Bvh::new(triangles, vec![], k));
        let bvhs: Vec<Bvh> = bvhs.collect();
        assert_eq!(bvhs[0].nodes.is_empty(), count == 9);
        let mut traversal = Traversal::default();
        for round in 0..200 {
            let target = random.vector(2.0);
            // Side by side in half of the rounds, all over the scene in the others.
            let size = if round % 2 == 0 { 0.05 } else { 2.0 };
            let middle = random.vector(2.0);
            let listed: Vec<Point> = (0..1 + round % PACKET)
                .map(|i| Point {
                    position: if i == 3 {
                        target
                    } else {
                        middle + random.vector(size)
                    },
                    geometric_normal: random.vector(1.0).normalize(),
                    shading_normal: random.vector(1.0).normalize(),
                    offset: 1e-6,
                    exclude: i as u32,
                })
                .collect();
            let mut points = Points::default();
            listed.iter().for_each(|point| points.push(point));
            let sights: Vec<Sight> = bvhs.iter().map(|b| b.look(&points, target)).collect();
            for (lane, point) in listed.iter().enumerate() {
                let way = target - point.position;
                let faces =
                    way.dot(point.geometric_normal) > 0.0 && way.dot(point.shading_normal) > 0.0;
                assert_eq!(sights[0].facing() >> lane & 1 != 0, faces);
            }
            assert!(sights[0].facing() < 1 << listed.len());
            for (bvh, sight) in bvhs.iter().zip(&sights) {
                assert_eq!(sight.facing(), sights[0].facing());
                let together = bvh.occluded_of_sight(sight, &mut traversal);
                assert_eq!(
                    bvh.occluded_of_sights(std::slice::from_ref(sight), &mut traversal),
                    [together]
                );
                for lane in sight.rays.lanes() {
                    let (ray, same) = (sight.rays.ray(lane), sights[0].rays.ray(lane));
                    assert_eq!(format!("{ray:?}"), format!("{same:?}"));
                    let point = &listed[lane];
                    let start = point.leave(ray.direction);
                    assert_eq!((ray.origin, ray.exclude), (start.origin, start.exclude));
                    assert!((ray.at(ray.t_max.into()).as_vec3() - target).length() < 1e-5);
                    assert!(ray.t_max < sight.distance(lane));
                    let cosine = ray.direction.dot(point.geometric_normal);
                    assert!((cosine - sight.cosine(lane)).abs() < 1e-6);
                    assert_eq!(
                        together >> lane & 1 != 0,
                        bvh.occluded(&ray, &mut traversal)
                    );
                }
            }
        }
    }
}

fn check_against_oracle(triangles: &[[Vec3; 3]], spheres: &[Sphere], ray: &Ray, hit: Option<Hit>) {
    const MARGIN: f64 = 1e-4;
    let mut nearest: Option<f64> = None;
    let mut certain = |t: f64| nearest = Some(nearest.map_or(t, |n: f64| n.min(t)));
    for corners in triangles {
        if let Some((t, margin)) = triangle_oracle(ray, *corners)
            && t > 0.0
            && margin > MARGIN
        {
            certain(t);
        }
    }
    for s in spheres {
        if let Some(t) = s.intersect(ray) {
            certain(t);
        }
    }
    match (hit, nearest) {
        (None, None) => {}
        (None, Some(t)) => panic!("missed a hit at {t}: {ray:?}"),
        (Some(hit), nearest) => {
            let t = hit.t;
            if let Some(nearest) = nearest {
                // Nearest to single precision: nearer hits may share its rounding.
                assert!(t as f32 <= nearest as f32, "{t} behind {nearest}: {ray:?}");
            }
            // What was hit is really there.
            if let Some(corners) = triangles.get(hit.primitive as usize) {
                let (expected, margin) = triangle_oracle(ray, *corners).expect("not parallel");
                assert!(margin > -MARGIN, "outside by {margin}: {ray:?}");
                assert!(
                    (t - expected).abs() <= 1e-9 * expected,
                    "{t} for {expected}"
                );
            } else {
                let s = spheres[hit.primitive as usize - triangles.len()];
                assert_eq!(s.intersect(ray), Some(hit.t));
            }
        }
    }
}

fn random_rays(random: &mut Random, count: usize, size: f32) -> Vec<Ray> {
    (0..count)
        .map(|_| Ray::new(random.vector(size), random.vector(1.0)))
        .collect()
}

#[test]
fn random_triangles_and_spheres() {
    let mut random = Random(1);
    for (triangle_count, sphere_count) in [(1, 0), (0, 1), (7, 2), (9, 0), (100, 20), (3000, 300)] {
        let triangles: Vec<_> = (0..triangle_count)
            .map(|_| {
                let at = random.vector(10.0);
                [at, at + random.vector(2.0), at + random.vector(2.0)]
            })
            .collect();
        let spheres: Vec<_> = (0..sphere_count)
            .map(|_| sphere(random.vector(10.0), f64::from(random.unit()) + 0.01))
            .collect();
        let rays = random_rays(&mut random, 1000, 12.0);
        check(&triangles, &spheres, &rays);
    }
}

#[test]
fn nothing_is_hit_in_an_empty_scene() {
    check(&[], &[], &random_rays(&mut Random(2), 10, 1.0));
    assert_eq!(
        Bvh::new(&[], vec![], Kernel::default()).bounds(),
        Aabb::EMPTY
    );
}

#[test]
fn flat_boxes_and_rays_in_their_planes() {
    // A floor, a wall and a side of 8x8 quads: every box has zero thickness.
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for i in 0..64 {
            let at = |x: usize, y: usize| {
                let mut p = [0.0; 3];
                p[(axis + 1) % 3] = (i % 8 + x) as f32;
                p[(axis + 2) % 3] = (i / 8 + y) as f32;
                Vec3::from_array(p)
            };
            triangles.push([at(0, 0), at(1, 0), at(1, 1)]);
            triangles.push([at(0, 0), at(1, 1), at(0, 1)]);
        }
    }
    let mut rays = Vec::new();
    let mut random = Random(3);
    for axis in 0..3 {
        for zero in [0.0, -0.0, 1e-38, -1e-45] {
            for _ in 0..100 {
                let mut direction = Vec3::splat(zero);
                direction[axis] = -1.0;
                let origin = (random.vector(4.0) + 4.0).max(Vec3::splat(0.1));
                rays.push(Ray::new(origin, direction));
                // Starting on the grid lines, where box faces and triangle edges are.
                rays.push(Ray::new(origin.round() + Vec3::Y * 0.5, direction));
            }
        }
    }
    check(&triangles, &[], &rays);
    // A ray inside the plane of a floor misses it.
    let floor: Vec<_> = triangles[..128].to_vec();
    let bvh = Bvh::new(&floor, vec![], Kernel::default());
    let mut traversal = Traversal::default();
    for direction in [Vec3::Y, Vec3::Z, Vec3::new(0.0, 1.0, 1.0)] {
        let ray = Ray::new(Vec3::new(0.0, -1.0, -1.0), direction);
        assert_eq!(bvh.closest(&ray, &mut traversal), None);
    }
}

#[test]
fn a_hundred_thousand_equal_triangles_give_the_lowest_number() {
    let corners = [
        Vec3::new(-1.0, -1.0, -2.0),
        Vec3::new(1.0, -1.0, -2.0),
        Vec3::new(0.0, 1.0, -2.0),
    ];
    let triangles = vec![corners; 100_000];
    let bvh = Bvh::new(&triangles, vec![], Kernel::default());
    let mut traversal = Traversal::default();
    let mut ray = Ray::new(Vec3::ZERO, Vec3::NEG_Z);
    assert_eq!(
        bvh.closest(&ray, &mut traversal).map(|h| h.primitive),
        Some(0)
    );
    ray.exclude = 0;
    assert_eq!(
        bvh.closest(&ray, &mut traversal).map(|h| h.primitive),
        Some(1)
    );
}

#[test]
fn one_huge_among_many_tiny() {
    let mut random = Random(4);
    let mut triangles = vec![[
        Vec3::new(-1e6, 0.0, -1e6),
        Vec3::new(1e6, 0.0, -1e6),
        Vec3::new(0.0, 0.0, 1e6),
    ]];
    triangles.extend((0..2000).map(|_| {
        let at = random.vector(1.0);
        [at, at + random.vector(0.01), at + random.vector(0.01)]
    }));
    let rays = random_rays(&mut random, 500, 2.0);
    check(&triangles, &[], &rays);
}

/// The test of performance note B.1: from inside a closed icosphere, rays aimed at its vertices and
/// at points of its edges; none may escape.
#[test]
fn no_ray_escapes_a_closed_mesh_through_its_edges() {
    let (vertices, faces) = icosphere(2);
    for (scale, shift) in [
        (1.0, 0.0),
        (1e-3, 0.0),
        (1e-6, 0.0),
        (1e6, 0.0),
        (1.0, 1e4),
        (1.0, 1e6),
    ] {
        let place = |v: DVec3| (v * scale + DVec3::splat(shift)).as_vec3();
        let triangles: Vec<[Vec3; 3]> = faces
            .iter()
            .map(|f| f.map(|i| place(vertices[i])))
            .collect();
        for kernel in Kernel::available() {
            let bvh = Bvh::new(&triangles, vec![], kernel);
            let mut traversal = Traversal::default();
            let mut random = Random(5);
            for i in 0..20_000 {
                let face = triangles[i % triangles.len()];
                let target = if i % 2 == 0 {
                    face[i % 3]
                } else {
                    face[0].lerp(face[1], random.unit())
                };
                let origin = place(random.vector(0.3).as_dvec3());
                let ray = Ray::new(origin, target - origin);
                assert!(
                    bvh.closest(&ray, &mut traversal).is_some(),
                    "{scale} {shift} {ray:?}"
                );
            }
        }
    }
}

fn icosphere(levels: usize) -> (Vec<DVec3>, Vec<[usize; 3]>) {
    let phi = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut vertices = Vec::new();
    for (a, b) in [(1.0, phi), (-1.0, phi), (1.0, -phi), (-1.0, -phi)] {
        vertices.extend([
            DVec3::new(0.0, a, b),
            DVec3::new(a, b, 0.0),
            DVec3::new(b, 0.0, a),
        ]);
    }
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let near = |a: usize, b: usize| vertices[a].distance(vertices[b]) < 2.1;
                if near(i, j) && near(j, k) && near(i, k) {
                    faces.push([i, j, k]);
                }
            }
        }
    }
    for v in &mut vertices {
        *v = v.normalize();
    }
    for _ in 0..levels {
        let mut middles = std::collections::BTreeMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |a: usize, b: usize| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    vertices.push((vertices[a] + vertices[b]).normalize());
                    vertices.len() - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = finer;
    }
    (vertices, faces)
}

#[test]
fn validation_finds_faults() {
    let mut random = Random(6);
    let triangles: Vec<_> = (0..200)
        .map(|_| {
            let at = random.vector(10.0);
            [at, at + random.vector(1.0), at + random.vector(1.0)]
        })
        .collect();
    let sound = || Bvh::new(&triangles, vec![], Kernel::default());
    assert_eq!(sound().validate(), Ok(()));

    let mut small = sound();
    small.nodes[0].planes[0] = small.nodes[0].planes[0].map(|x| x + 0.01);
    let fault = small.validate();
    assert!(
        matches!(fault, Err(TreeFault::Outside { node: 0, .. })),
        "{fault:?}"
    );

    let mut lost = sound();
    lost.nodes[0].planes[0][1] = f32::INFINITY;
    for axis in 0..3 {
        lost.nodes[0].planes[axis][1] = f32::INFINITY;
        lost.nodes[0].planes[axis + 3][1] = f32::NEG_INFINITY;
    }
    let fault = lost.validate();
    assert!(
        matches!(fault, Err(TreeFault::Primitive { leaves: 0, .. })),
        "{fault:?}"
    );

    let mut dangling = sound();
    dangling.nodes[0].children[0] = Child::Triangles(1 << 20).pack();
    let expected = TreeFault::Dangling { node: 0, lane: 0 };
    assert_eq!(dangling.validate(), Err(expected));

    let mut endless = sound();
    let last = endless.nodes.len() - 1;
    endless.nodes[last].children = [Child::Node(last as u32).pack(); 8];
    let fault = endless.validate();
    assert!(matches!(fault, Err(TreeFault::TooDeep { .. })), "{fault:?}");
}
