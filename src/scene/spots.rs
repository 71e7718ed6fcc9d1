use super::Scene;
use crate::accel::Traversal;
use crate::light::{Falloff, PointLight};
use crate::material::Only;
use crate::math::Ray;
use crate::sampling::{Sequence, uniform_sphere};
use std::f32::consts::PI;

/// A light whose surroundings are lit so many times more unevenly than a sphere about it would be
/// throws spots.
const UNEVEN: f32 = 2.0;

/// How many rays find out.
const RAYS: u32 = 1024;

/// The lights so close to a surface that they light a small part of it far more brightly than all the
/// rest: few rays gathered over a hemisphere meet such a spot, and those that do bring most of the light.
///
/// Knows a way to the spots: rays that leave these lights in all directions alike.
#[derive(Debug, Default)]
pub struct Spots {
    /// For each light of the scene the share of the rays that leave it; or none at all.
    shares: Vec<f32>,
}

impl Spots {
    /// Looks around the lights of a scene.
    pub(super) fn find(scene: &Scene) -> Spots {
        let power = |light: &PointLight| {
            if light.falloff == Falloff::InverseSquare && unevenness(scene, light) > UNEVEN {
                light.intensity.as_dvec3().element_sum()
            } else {
                0.0
            }
        };
        let powers: Vec<f64> = scene.lights.iter().map(power).collect();
        let sum: f64 = powers.iter().sum();
        if sum == 0.0 {
            return Spots::default();
        }
        let shares = powers.iter().map(|power| (power / sum) as f32).collect();
        Spots { shares }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.shares.is_empty()
    }

    /// A ray from one of the lights, chosen by two numbers in [0, 1).
    ///
    /// There are spots.
    pub fn ray(&self, scene: &Scene, [u, v]: [f32; 2]) -> Ray {
        let mut rest = u;
        let mut chosen = 0;
        for (light, share) in self.shares.iter().enumerate() {
            if *share > 0.0 {
                chosen = light;
                if rest < *share {
                    break;
                }
                rest -= share;
            }
        }
        // What is left of the number is even over the share; rounding may leave too much.
        let u = (rest / self.shares[chosen]).min(1.0);
        Ray::new(scene.lights[chosen].position, uniform_sphere(u, v))
    }

    /// How many rays from `light` arrive on a unit of area, of all that [`Spots::ray`] returns: at a
    /// point at `distance` that the light sees, where it stands at an angle of cosine `cos` to the
    /// normal. There are spots.
    #[inline]
    pub fn density(&self, light: usize, distance: f32, cos: f32) -> f32 {
        self.shares[light] * cos / (4.0 * PI * distance * distance)
    }
}

/// The mean irradiance where rays from a light arrive, over that on a sphere whose radius is their mean
/// length.
fn unevenness(scene: &Scene, light: &PointLight) -> f32 {
    let sequence = Sequence::new(0, 0, 0, 0);
    let mut traversal = Traversal::default();
    let (mut count, mut lengths, mut irradiances) = (0.0, 0.0, 0.0);
    for i in 0..RAYS {
        let [u, v] = sequence.sample_2d(i, 0);
        let ray = Ray::new(light.position, uniform_sphere(u, v));
        let Some(hit) = scene.bvh.closest(&ray, &mut traversal) else {
            continue;
        };
        let cos = scene
            .surface::<Only<0>>(&ray, &hit)
            .point
            .geometric_normal
            .dot(-ray.direction);
        let length = hit.t as f32;
        count += 1.0;
        lengths += length;
        irradiances += cos / (length * length);
    }
    if count == 0.0 {
        return 0.0;
    }
    let mean = lengths / count;
    irradiances / count * mean * mean
}

#[cfg(test)]
mod tests {
    use super::super::{MeshMaterial, SceneBuilder, SourceMesh};
    use super::*;
    use crate::material::Material;
    use glam::{DVec3, Vec3, Vec3Swizzles};

    /// A floor of 20 m by 20 m with lights at these heights above its middle.
    fn floor_below(heights: &[f64]) -> Scene {
        let light = |height: &f64| {
            let light = PointLight {
                position: Vec3::ZERO,
                intensity: Vec3::ONE,
                falloff: Falloff::InverseSquare,
            };
            (DVec3::Y * *height, light)
        };
        let corner = |x: f64, z: f64| DVec3::new(x, 0.0, z);
        let floor = SourceMesh {
            positions: vec![
                corner(-10.0, -10.0),
                corner(-10.0, 10.0),
                corner(10.0, 10.0),
                corner(10.0, -10.0),
            ],
            normals: vec![],
            uvs: vec![],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            material: MeshMaterial::Uniform(0),
        };
        let builder = SceneBuilder {
            lights: heights.iter().map(light).collect(),
            materials: vec![Material::lambert(Vec3::ONE)],
            meshes: vec![floor],
            ..SceneBuilder::default()
        };
        builder.build().0
    }

    #[test]
    fn only_lights_close_to_surfaces_throw_spots() {
        assert!(floor_below(&[]).spots().is_empty());
        assert!(floor_below(&[30.0]).spots().is_empty());
        let scene = floor_below(&[30.0, 0.5]);
        for i in 0..100 {
            let ray = scene.spots().ray(&scene, [i as f32 / 100.0, 0.3]);
            assert_eq!(ray.origin, scene.lights[1].position);
        }
    }

    /// Of all rays, those that arrive within a disc below the light are as many as the density there
    /// says, and as many as the disc's share of the sphere.
    #[test]
    fn rays_arrive_with_the_density() {
        let scene = floor_below(&[0.5, 0.5]);
        let spots = scene.spots();
        let (radius, height) = (0.3_f32, 0.5_f32);
        let sequence = Sequence::new(1, 0, 0, 0);
        let mut traversal = Traversal::default();
        let arrives = |i: u32| {
            let ray = spots.ray(&scene, sequence.sample_2d(i, 0));
            let hit = scene.bvh.closest(&ray, &mut traversal);
            hit.is_some_and(|hit| (ray.at(hit.t).as_vec3() - ray.origin).xz().length() < radius)
        };
        let share = (0..1 << 16).map(arrives).filter(|a| *a).count() as f32 / 65536.0;
        let steps = 1000;
        let step = radius / steps as f32;
        let expected: f32 = (0..steps)
            .map(|i| {
                let r = (i as f32 + 0.5) * step;
                let distance = r.hypot(height);
                let of_either = |light| spots.density(light, distance, height / distance);
                2.0 * PI * r * step * (of_either(0) + of_either(1))
            })
            .sum();
        let solid_angle_share = 0.5 * (1.0 - height / radius.hypot(height));
        assert!((expected - solid_angle_share).abs() < 1e-5);
        assert!((share - expected).abs() < 5e-4, "{share} {expected}");
    }
}
