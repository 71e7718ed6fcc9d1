use super::direct::direct;
use super::{CameraSample, ambient, reflect};
use crate::accel::Traversal;
use crate::material::Features;
use crate::math::{Ray, to_world};
use crate::sampling::{Sequence, cosine_hemisphere};
use crate::scene::{Scene, Surface};
use glam::Vec3;
use std::marker::PhantomData;

/// An unbiased estimate of the light that `surface`, which a camera ray sees, sends along the ray,
/// given its direct light; all paths of up to `bounces` bounces counted. Light that a mirror throws
/// from a point light onto a surface (a caustic) is not.
pub(super) fn radiance<F: Features>(
    scene: &Scene,
    sample: &CameraSample,
    surface: &Surface,
    lit: Vec3,
    bounces: u32,
    splits: &[u32],
    traversal: &mut Traversal,
) -> Vec3 {
    let mut estimator = Estimator::<F> {
        scene,
        bounces,
        splits,
        sequence: sample.sequence,
        traversal,
        features: PhantomData,
    };
    let path = Path {
        depth: 0,
        diffuse_bounces: 0,
        index: sample.index,
    };
    estimator.leaving(&sample.ray, surface, lit, path)
}

struct Estimator<'a, F> {
    scene: &'a Scene,
    bounces: u32,
    splits: &'a [u32],
    sequence: Sequence,
    traversal: &'a mut Traversal,
    features: PhantomData<F>,
}

/// How a ray came to be.
#[derive(Clone, Copy)]
struct Path {
    /// Bounces since the camera.
    depth: u32,
    /// Those of them that were diffuse.
    diffuse_bounces: usize,
    /// Its number among the paths of this depth in the pixel.
    index: u32,
}

impl<F: Features> Estimator<'_, F> {
    fn radiance(&mut self, ray: &Ray, path: Path) -> Vec3 {
        let Some(hit) = self.scene.closest(ray, self.traversal) else {
            return self.scene.background;
        };
        let surface = self.scene.surface::<F>(ray, &hit);
        let lit = direct::<F>(self.scene, &surface, -ray.direction, self.traversal);
        self.leaving(ray, &surface, lit, path)
    }

    /// The light that the surface sends along the ray, given its direct light.
    fn leaving(&mut self, ray: &Ray, surface: &Surface, lit: Vec3, path: Path) -> Vec3 {
        let mirror = surface.reflectance.mirror::<F>();
        let own = surface.reflectance.own::<F>();
        let sum = own * lit;
        let diffuse = own * surface.reflectance.diffuse;
        if path.depth == self.bounces {
            sum + (diffuse + mirror) * ambient(self.scene)
        } else if path.diffuse_bounces == 0 {
            // What the camera sees, also through mirrors, is worth both.
            sum + self.gather(ray, surface, diffuse, Vec3::ZERO, path)
                + self.follow_mirror(ray, surface, mirror, path)
        } else {
            sum + self.gather(ray, surface, diffuse, mirror, path)
        }
    }

    fn follow_mirror(&mut self, ray: &Ray, surface: &Surface, mirror: Vec3, path: Path) -> Vec3 {
        if !F::MIRRORS || mirror == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let next = Path {
            depth: path.depth + 1,
            ..path
        };
        mirror * self.radiance(&reflect(surface, ray), next)
    }

    /// The mean over as many paths as the schedule gives, each leaving by the diffuse lobe or by
    /// the mirror with a chance in proportion to what they reflect.
    fn gather(
        &mut self,
        ray: &Ray,
        surface: &Surface,
        diffuse: Vec3,
        mirror: Vec3,
        path: Path,
    ) -> Vec3 {
        let (diffuse_share, mirror_share) = (diffuse.element_sum(), mirror.element_sum());
        if diffuse_share + mirror_share == 0.0 {
            return Vec3::ZERO;
        }
        let mirror_chance = if F::MIRRORS {
            mirror_share / (diffuse_share + mirror_share)
        } else {
            0.0
        };
        let count = self.splits.get(path.diffuse_bounces).copied().unwrap_or(1);
        let mut sum = Vec3::ZERO;
        for i in 0..count {
            let next = Path {
                depth: path.depth + 1,
                diffuse_bounces: path.diffuse_bounces + 1,
                index: path.index.wrapping_mul(count).wrapping_add(i),
            };
            let by_mirror = mirror_chance > 0.0
                && self.sequence.sample_1d(next.index, next.depth) < mirror_chance;
            if by_mirror {
                let index = next.index;
                let weight = mirror / mirror_chance;
                sum += self.follow_mirror(ray, surface, weight, Path { index, ..path });
                continue;
            }
            let [u, v] = self.sequence.sample_2d(next.index, next.depth);
            let direction = to_world(surface.shading_normal, cosine_hemisphere(u, v));
            // Below the shape's own horizon an interpolated normal gathers nothing.
            if direction.dot(surface.geometric_normal) > 0.0 {
                let weight = diffuse / (1.0 - mirror_chance);
                sum += weight * self.radiance(&surface.leave(direction), next);
            }
        }
        sum / count as f32
    }
}
