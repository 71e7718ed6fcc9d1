//! How a surface changes over the footprint of a ray: texture coordinates, and the position and normal that mirrors need
//! (Igehy 1999, "Tracing Ray Differentials").

use super::resolved::{Scene, Triangle};
use crate::geometry::{Hit, Sphere};
use crate::math::{Ray, RayDifferential};
use glam::{DVec3, Vec2, Vec3};

impl Scene {
    /// The changes of a triangle's texture coordinates at `hit`, for the changes of the ray. Not finite for a ray within
    /// the triangle's plane.
    #[inline(always)]
    pub(super) fn triangle_footprint(
        &self,
        ray: &Ray,
        hit: &Hit,
        differential: &RayDifferential,
        triangle: &Triangle,
    ) -> [Vec2; 2] {
        if *differential == RayDifferential::ZERO {
            return [Vec2::ZERO; 2];
        }
        let mesh = &self.meshes[triangle.mesh as usize];
        let steps = differential.transfer(ray, hit.t as f32, triangle.normal);
        steps.map(|step| {
            let weight_changes = mesh.weight_changes(triangle.vertices, step);
            mesh.uv_change(triangle.vertices, weight_changes)
        })
    }

    /// The differential of the ray that leaves `hit` by mirror reflection at the shading normal, or at the geometric
    /// normal where `at_geometric_normal`.
    pub fn reflected_differential(
        &self,
        ray: &Ray,
        hit: &Hit,
        differential: &RayDifferential,
        at_geometric_normal: bool,
    ) -> RayDifferential {
        if *differential == RayDifferential::ZERO {
            return RayDifferential::ZERO;
        }
        let number = hit.primitive as usize;
        let t = hit.t as f32;
        // Both sides of a surface mirror alike: no normal is turned to the viewer's.
        let (normal, steps, turns) = match self.triangles.get(number) {
            Some(triangle) => {
                let mesh = &self.meshes[triangle.mesh as usize];
                let steps = differential.transfer(ray, t, triangle.normal);
                if mesh.normals.is_empty() || at_geometric_normal {
                    (triangle.normal, steps, [Vec3::ZERO; 2])
                } else {
                    let weights = mesh.weights(triangle.vertices, ray.at(hit.t));
                    let turn = |step| {
                        let weight_changes = mesh.weight_changes(triangle.vertices, step);
                        mesh.shading_normal_change(
                            triangle.vertices,
                            weights,
                            weight_changes,
                            triangle.normal,
                        )
                    };
                    let normal = mesh.shading_normal(triangle.vertices, weights, triangle.normal);
                    (normal, steps, steps.map(turn))
                }
            }
            None => {
                let sphere = &self.spheres[number - self.triangles.len()];
                let normal = (ray.at(hit.t) - sphere.center).normalize().as_vec3();
                let steps = differential.transfer(ray, t, normal);
                (normal, steps, steps.map(|step| step / sphere.radius as f32))
            }
        };
        differential.reflect(ray.direction, normal, steps, turns)
    }
}

/// The changes of a sphere's texture coordinates at `hit`, where its outward unit normal is `normal`, for the changes of
/// the ray. Not finite for a ray that touches the sphere.
#[inline(always)]
pub(super) fn sphere_footprint(
    ray: &Ray,
    hit: &Hit,
    differential: &RayDifferential,
    sphere: &Sphere,
    normal: DVec3,
) -> [Vec2; 2] {
    if *differential == RayDifferential::ZERO {
        return [Vec2::ZERO; 2];
    }
    let steps = differential.transfer(ray, hit.t as f32, normal.as_vec3());
    steps.map(|step| sphere.uv_change(normal, step.as_dvec3() / sphere.radius))
}

/// The texture coordinates in the middle of a ray's footprint, given those where the ray hits.
#[inline(always)]
pub(super) fn middle_of(footprint: [Vec2; 2], uv: Vec2, differential: &RayDifferential) -> Vec2 {
    let middle = differential.middle;
    uv + middle.x * footprint[0] + middle.y * footprint[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::QueryState;
    use crate::camera::{Camera, CameraRays};
    use crate::material::{FeatureMask, Material, reflect};
    use crate::scene::{MeshMaterial, SceneBuilder, SourceMesh};
    use crate::texture::Texture;
    use glam::{DMat3, DVec2};

    /// Pixels of 1/200 of the distance.
    fn camera_rays(scene: &Scene) -> CameraRays {
        let camera = Camera::from_axes(DVec3::ZERO, DVec3::Z, DVec3::Y, 2.0 * 0.25_f64.atan());
        camera.rays(DVec2::splat(100.0), scene.origin)
    }

    const CHECKER: Material = Material {
        texture: Some(0),
        ..Material::lambert(Vec3::ONE)
    };

    /// A scene of textured meshes and spheres, whose texture is a checker of 8 x 8 fields.
    fn scene(meshes: Vec<SourceMesh>, spheres: Vec<Sphere>) -> Scene {
        let texels = (0..64).map(|i| [if (i + i / 8) % 2 == 0 { 255 } else { 0 }; 3]);
        let builder = SceneBuilder {
            materials: vec![CHECKER],
            textures: Texture::new(8, 8, texels.collect()).into_iter().collect(),
            spheres: spheres.into_iter().map(|sphere| (sphere, 0)).collect(),
            meshes,
            ..SceneBuilder::default()
        };
        builder.build().0
    }

    /// A large triangle around `middle`, with its texture upright and not skewed, a repeat a metre.
    fn plane(middle: DVec3, right: DVec3, up: DVec3) -> SourceMesh {
        let corners = [
            DVec2::new(-300.0, -200.0),
            DVec2::new(300.0, -200.0),
            DVec2::new(0.0, 400.0),
        ];
        SourceMesh {
            positions: corners.map(|p| middle + p.x * right + p.y * up).to_vec(),
            normals: vec![],
            uvs: corners.map(|p| p.as_vec2()).to_vec(),
            triangles: vec![[0, 1, 2]],
            material: MeshMaterial::Uniform(0),
        }
    }

    /// A mirror whose interpolated normals turn by some 10 degrees.
    fn curved_mirror() -> SourceMesh {
        let normal = |x, y| Vec3::new(x, y, 1.0).normalize();
        SourceMesh {
            positions: [(-2.0, -1.0), (2.0, -1.5), (0.3, 2.0)]
                .map(|(x, y)| DVec3::new(x, y, -4.0 + 0.2 * x))
                .to_vec(),
            normals: vec![normal(-0.1, -0.05), normal(0.05, -0.1), Vec3::ZERO],
            uvs: vec![],
            triangles: vec![[0, 1, 2]],
            material: MeshMaterial::Uniform(0),
        }
    }

    /// The ray beyond some mirrors, its differential, and its hit.
    fn follow(
        scene: &Scene,
        mut ray: Ray,
        mut differential: RayDifferential,
        mirrors: usize,
    ) -> (Ray, RayDifferential, Hit) {
        let mut query_state = QueryState::default();
        let mut closest = |ray: &Ray| scene.closest(ray, &mut query_state).expect("a hit");
        for _ in 0..mirrors {
            let hit = closest(&ray);
            let surface = scene.surface::<FeatureMask<1>>(&ray, &hit);
            let reflected = reflect(-ray.direction, surface.point.shading_normal);
            differential = scene.reflected_differential(&ray, &hit, &differential, false);
            ray = surface.point.spawn_ray(reflected);
        }
        let hit = closest(&ray);
        (ray, differential, hit)
    }

    fn uv(scene: &Scene, ray: &Ray, hit: &Hit) -> Vec2 {
        let number = hit.primitive as usize;
        match scene.triangles.get(number) {
            Some(triangle) => {
                let mesh = &scene.meshes[triangle.mesh as usize];
                let weights = mesh.weights(triangle.vertices, ray.at(hit.t));
                mesh.uv(triangle.vertices, weights)
            }
            None => {
                let sphere = &scene.spheres[number - scene.triangles.len()];
                sphere.uv((ray.at(hit.t) - sphere.center).normalize())
            }
        }
    }

    fn footprint(scene: &Scene, ray: &Ray, hit: &Hit, differential: &RayDifferential) -> [Vec2; 2] {
        let number = hit.primitive as usize;
        match scene.triangles.get(number) {
            Some(triangle) => scene.triangle_footprint(ray, hit, differential, triangle),
            None => {
                let sphere = &scene.spheres[number - scene.triangles.len()];
                let normal = (ray.at(hit.t) - sphere.center).normalize();
                sphere_footprint(ray, hit, differential, sphere, normal)
            }
        }
    }

    /// Compares the footprints of some pixels with the differences of the texture coordinates that neighbouring rays see.
    fn assert_footprints(scene: &Scene, mirrors: usize) {
        let rays = camera_rays(scene);
        for film in [(50.0, 50.0), (45.0, 52.5), (57.0, 46.0)].map(DVec2::from) {
            let seen = |film| {
                let (ray, _, hit) =
                    follow(scene, rays.through(film), RayDifferential::ZERO, mirrors);
                uv(scene, &ray, &hit).as_dvec2()
            };
            let differential = rays.differential(film, film, 0.5);
            let (ray, differential, hit) = follow(scene, rays.through(film), differential, mirrors);
            let found = footprint(scene, &ray, &hit, &differential);
            for (axis, half) in [0.25 * DVec2::X, 0.25 * DVec2::Y].into_iter().enumerate() {
                let exact = seen(film + half) - seen(film - half);
                let error = (found[axis].as_dvec2() - exact).length();
                assert!(
                    error < 0.01 * exact.length(),
                    "{} instead of {exact}",
                    found[axis]
                );
            }
        }
    }

    fn tilted_sphere(center: DVec3, radius: f64) -> Sphere {
        Sphere {
            rotation: DMat3::from_rotation_x(1.0) * DMat3::from_rotation_y(0.5),
            ..Sphere::new(center, radius)
        }
    }

    #[test]
    fn footprints_on_a_plane_across_the_view_are_exact() {
        let scene = scene(
            vec![plane(DVec3::new(0.0, 0.0, -6.0), DVec3::X, DVec3::Y)],
            vec![],
        );
        let rays = camera_rays(&scene);
        for film in [DVec2::new(50.0, 50.0), DVec2::new(3.0, 90.0)] {
            let differential = rays.differential(film, film, 0.5);
            let (ray, differential, hit) = follow(&scene, rays.through(film), differential, 0);
            let [across, down] = footprint(&scene, &ray, &hit, &differential);
            let size = 0.5 * 6.0 / 200.0;
            assert!((across - size * Vec2::X).length() < 1e-5 * size, "{across}");
            assert!((down + size * Vec2::Y).length() < 1e-5 * size, "{down}");
        }
    }

    #[test]
    fn footprints_on_planes_and_spheres_are_differences_of_rays() {
        let floor = plane(
            DVec3::new(0.0, -1.0, -8.0),
            DVec3::new(1.0, 0.0, 0.2),
            DVec3::new(0.1, 0.3, -1.0),
        );
        assert_footprints(&scene(vec![floor], vec![]), 0);
        let sphere = tilted_sphere(DVec3::new(0.1, 0.1, -5.0), 1.0);
        assert_footprints(&scene(vec![], vec![sphere]), 0);
    }

    #[test]
    fn footprints_in_mirrors_are_differences_of_rays() {
        let behind = || {
            plane(
                DVec3::new(0.0, 0.0, 7.0),
                DVec3::new(1.0, 0.0, 0.2),
                DVec3::Y,
            )
        };
        let flat = || {
            plane(
                DVec3::new(0.0, 0.0, -6.0),
                DVec3::new(1.0, 0.0, 0.1),
                DVec3::Y,
            )
        };
        let ball = tilted_sphere(DVec3::new(0.1, 0.2, -5.0), 1.0);
        let near = tilted_sphere(DVec3::new(-1.2, 0.1, 5.0), 3.0);
        assert_footprints(&scene(vec![flat(), behind()], vec![]), 1);
        assert_footprints(&scene(vec![flat()], vec![near]), 1);
        assert_footprints(&scene(vec![behind()], vec![ball]), 1);
        assert_footprints(&scene(vec![curved_mirror(), behind()], vec![]), 1);
        let front = plane(DVec3::new(0.0, 0.0, -30.0), DVec3::X, DVec3::Y);
        let aside = plane(
            DVec3::new(0.0, 0.0, 7.0),
            DVec3::new(1.0, 0.0, 0.6),
            DVec3::Y,
        );
        let meshes = vec![curved_mirror(), aside, front];
        assert_footprints(&scene(meshes, vec![]), 2);
    }

    #[test]
    fn far_away_a_texture_is_its_mean() {
        let scene = scene(
            vec![plane(DVec3::new(0.0, 0.0, -600.0), DVec3::X, DVec3::Y)],
            vec![],
        );
        let rays = camera_rays(&scene);
        for film in [DVec2::new(50.3, 50.1), DVec2::new(42.2, 71.9)] {
            let differential = rays.differential(film, film, 1.0);
            let (ray, differential, hit) = follow(&scene, rays.through(film), differential, 0);
            let surface = scene.filtered_surface::<FeatureMask<1>>(&ray, &hit, &differential);
            assert!((surface.bsdf.diffuse - 0.5).length() < 1e-3);
        }
    }

    #[test]
    fn zero_differentials_do_not_filter() {
        let floor = plane(DVec3::new(0.0, -1.0, -8.0), DVec3::X, DVec3::NEG_Z);
        let scene = scene(
            vec![floor],
            vec![tilted_sphere(DVec3::new(0.0, 0.5, -5.0), 1.0)],
        );
        let rays = camera_rays(&scene);
        for i in 0..100 {
            let film = DVec2::new(f64::from(i % 10), 45.0 + f64::from(i / 10)) * 5.0 % 100.0;
            let ray = rays.through(film);
            let Some(hit) = scene.closest(&ray, &mut QueryState::default()) else {
                continue;
            };
            let differential = rays.differential(film, film + 0.5, 0.0);
            let found = scene.filtered_surface::<FeatureMask<1>>(&ray, &hit, &differential);
            let exact = scene.textures[0].sample(uv(&scene, &ray, &hit));
            assert_eq!(found.bsdf.diffuse, exact);
        }
    }

    /// A sphere's poles, its silhouette, triangles of one texture coordinate, and rays within a plane.
    #[test]
    fn degenerate_footprints_give_colors() {
        let flat = |uvs: [Vec2; 3]| SourceMesh {
            uvs: uvs.to_vec(),
            ..plane(DVec3::new(0.0, 0.0, -9.0), DVec3::X, DVec3::Y)
        };
        let one = flat([Vec2::ONE; 3]);
        let line = flat([Vec2::ZERO, Vec2::X, 1e30 * Vec2::X]);
        let edge_on = plane(DVec3::ZERO, DVec3::X, DVec3::NEG_Z);
        for (meshes, spheres) in [
            (vec![one], vec![]),
            (vec![line], vec![]),
            (vec![edge_on], vec![]),
            (
                vec![],
                vec![Sphere {
                    rotation: DMat3::from_rotation_x(std::f64::consts::FRAC_PI_2),
                    ..Sphere::new(DVec3::new(0.0, 0.0, -5.0), 1.0)
                }],
            ),
            (vec![], vec![Sphere::new(DVec3::new(1.0, 0.0, -5.0), 1.0)]),
        ] {
            let scene = scene(meshes, spheres);
            let film = DVec2::splat(50.0);
            let rays = camera_rays(&scene);
            let ray = rays.through(film);
            let t = scene
                .closest(&ray, &mut QueryState::default())
                .map_or(5.0, |hit| hit.t);
            let hit = Hit { t, primitive: 0 };
            for width in [1e-30, 1.0, 1e30] {
                let differential = rays.differential(film, film, width);
                let surface = scene.filtered_surface::<FeatureMask<1>>(&ray, &hit, &differential);
                let color = surface.bsdf.diffuse;
                assert!(
                    color.min_element() >= 0.0 && color.max_element() <= 1.00001,
                    "{color}"
                );
            }
        }
    }
}
