use super::direct::direct_of_wave;
use super::{CameraSample, ambient, reflect, surfaces};
use crate::accel::Traversal;
use crate::material::Features;
use crate::math::{Ray, to_world};
use crate::sampling::{Sequence, cosine_hemisphere};
use crate::scene::{Scene, Surface};
use glam::Vec3;
use std::marker::PhantomData;

/// So many paths take their next step together.
const WAVE: usize = 64;

/// Unbiased estimates of the light that reaches the camera along the samples' rays, given the surfaces
/// that they see and the direct light there; all paths of up to `bounces` bounces counted. Light that
/// a mirror throws from a point light onto a surface (a caustic) is not.
#[expect(
    clippy::too_many_arguments,
    reason = "what is known of the samples, side by side"
)]
pub(super) fn radiance<F: Features>(
    scene: &Scene,
    samples: &[CameraSample],
    surfaces: &[Option<Surface>],
    lit: &[Vec3],
    bounces: u32,
    splits: &[u32],
    traversal: &mut Traversal,
    radiance: &mut [Vec3],
) {
    let mut estimator = Estimator::<F> {
        scene,
        bounces,
        splits,
        traversal,
        features: PhantomData,
    };
    let from_camera = |sample: &CameraSample| Path {
        ray: sample.ray,
        sequence: sample.sequence,
        depth: 0,
        diffuse_bounces: 0,
        index: sample.index,
    };
    let paths: Vec<Path> = samples.iter().map(from_camera).collect();
    estimator.leaving(&paths, surfaces, lit, radiance);
}

/// The last ray of a path, and how it came to be.
#[derive(Clone, Copy)]
struct Path {
    ray: Ray,
    /// The random numbers of its pixel.
    sequence: Sequence,
    /// Bounces since the camera.
    depth: u32,
    /// Those of them that were diffuse.
    diffuse_bounces: usize,
    /// Its number among the paths of this depth in the pixel.
    index: u32,
}

/// A path that goes on from another, and its share in the light of that.
struct Branch {
    parent: usize,
    share: Vec3,
    path: Path,
}

struct Estimator<'a, F> {
    scene: &'a Scene,
    bounces: u32,
    splits: &'a [u32],
    traversal: &'a mut Traversal,
    features: PhantomData<F>,
}

impl<F: Features> Estimator<'_, F> {
    /// The light along the last rays of up to [`WAVE`] paths.
    fn radiance(&mut self, paths: &[Path], radiance: &mut [Vec3]) {
        let rays: Vec<Ray> = paths.iter().map(|path| path.ray).collect();
        let mut hits = vec![None; rays.len()];
        self.scene.closest_of_wave(&rays, &mut hits, self.traversal);
        let surfaces = surfaces::<F>(self.scene, &rays, &hits);
        let lit = direct_of_wave::<F>(self.scene, &surfaces, &rays, self.traversal);
        self.leaving(paths, &surfaces, &lit, radiance);
    }

    /// The light that the surfaces at the ends of paths send along their last rays, given the direct
    /// light there.
    ///
    /// Every path's light is a sum over its own branches, in their order: it does not depend on which
    /// paths take their steps together.
    fn leaving(
        &mut self,
        paths: &[Path],
        surfaces: &[Option<Surface>],
        lit: &[Vec3],
        radiance: &mut [Vec3],
    ) {
        let mut branches = Vec::with_capacity(WAVE);
        for (parent, path) in paths.iter().enumerate() {
            let Some(surface) = &surfaces[parent] else {
                radiance[parent] = self.scene.background;
                continue;
            };
            let own = surface.reflectance.own::<F>();
            let mirror = surface.reflectance.mirror::<F>();
            let diffuse = own * surface.reflectance.diffuse;
            radiance[parent] = own * lit[parent];
            let mut branch = |share, path| {
                branches.push(Branch {
                    parent,
                    share,
                    path,
                });
            };
            if path.depth == self.bounces {
                radiance[parent] += (diffuse + mirror) * ambient(self.scene);
            } else if path.diffuse_bounces == 0 {
                // What the camera sees, also through mirrors, is worth both.
                self.gather(path, surface, diffuse, Vec3::ZERO, &mut branch);
                follow_mirror::<F>(path, surface, mirror, &mut branch);
            } else {
                self.gather(path, surface, diffuse, mirror, &mut branch);
            }
            // No more than needed for full waves: they stay in the cache.
            if branches.len() >= WAVE {
                self.follow(&mut branches, radiance);
            }
        }
        self.follow(&mut branches, radiance);
    }

    /// Adds the light of branches to that of the paths that they go on from.
    fn follow(&mut self, branches: &mut Vec<Branch>, radiance: &mut [Vec3]) {
        for wave in branches.chunks(WAVE) {
            let paths: Vec<Path> = wave.iter().map(|branch| branch.path).collect();
            let mut light = [Vec3::ZERO; WAVE];
            self.radiance(&paths, &mut light);
            for (branch, light) in wave.iter().zip(light) {
                radiance[branch.parent] += branch.share * light;
            }
        }
        branches.clear();
    }

    /// As many branches as the schedule gives, whose mean it is, each leaving by the diffuse lobe or by
    /// the mirror with a chance in proportion to what they reflect.
    fn gather(
        &self,
        path: &Path,
        surface: &Surface,
        diffuse: Vec3,
        mirror: Vec3,
        branch: &mut impl FnMut(Vec3, Path),
    ) {
        let (diffuse_share, mirror_share) = (diffuse.element_sum(), mirror.element_sum());
        if diffuse_share + mirror_share == 0.0 {
            return;
        }
        let mirror_chance = if F::MIRRORS {
            mirror_share / (diffuse_share + mirror_share)
        } else {
            0.0
        };
        let count = self.splits.get(path.diffuse_bounces).copied().unwrap_or(1);
        let (diffuse, mirror) = (diffuse / count as f32, mirror / count as f32);
        for i in 0..count {
            let mut next = Path {
                depth: path.depth + 1,
                diffuse_bounces: path.diffuse_bounces + 1,
                index: path.index.wrapping_mul(count).wrapping_add(i),
                ..*path
            };
            let by_mirror = mirror_chance > 0.0
                && path.sequence.sample_1d(next.index, next.depth) < mirror_chance;
            if by_mirror {
                let index = next.index;
                let share = mirror / mirror_chance;
                follow_mirror::<F>(&Path { index, ..*path }, surface, share, branch);
                continue;
            }
            let [u, v] = path.sequence.sample_2d(next.index, next.depth);
            let direction = to_world(surface.shading_normal, cosine_hemisphere(u, v));
            // Below the shape's own horizon an interpolated normal gathers nothing.
            if direction.dot(surface.geometric_normal) > 0.0 {
                next.ray = surface.leave(direction);
                branch(diffuse / (1.0 - mirror_chance), next);
            }
        }
    }
}

fn follow_mirror<F: Features>(
    path: &Path,
    surface: &Surface,
    mirror: Vec3,
    branch: &mut impl FnMut(Vec3, Path),
) {
    if F::MIRRORS && mirror != Vec3::ZERO {
        let next = Path {
            ray: reflect(surface, &path.ray),
            depth: path.depth + 1,
            ..*path
        };
        branch(mirror, next);
    }
}
