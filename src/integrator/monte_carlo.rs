use super::direct::{Lit, direct_of_wave};
use super::path::{Choice, Path};
use super::{CameraSample, ambient, reflect, surfaces};
use crate::accel::Traversal;
use crate::irradiance_cache::SecondaryIrradiance;
use crate::material::Features;
use crate::math::{Ray, to_world};
use crate::sampling::{Dealt, cosine_hemisphere};
use crate::scene::{Scene, Surface};
use glam::Vec3;
use std::f32::consts::PI;
use std::marker::PhantomData;

/// So many paths take their next step together.
const WAVE: usize = 128;

/// The random numbers of points that lights see are those of the depth, beyond all depths.
const SPOT_PAIRS: u32 = 1 << 16;

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
        known: None,
        traversal,
        features: PhantomData,
    };
    let from_camera = |sample: &CameraSample| Path {
        ray: sample.ray,
        sequence: sample.sequence,
        depth: 0,
        diffuse_bounces: 0,
        index: sample.index,
        choice: Choice::Only,
    };
    let paths: Vec<Path> = samples.iter().map(from_camera).collect();
    estimator.leaving(&paths, surfaces, lit, radiance);
}

/// A path that goes on from another, and its share in the light of that.
struct Branch {
    parent: usize,
    share: Vec3,
    path: Path,
}

/// Follows paths.
pub(super) struct Estimator<'a, F> {
    pub(super) scene: &'a Scene,
    pub(super) bounces: u32,
    pub(super) splits: &'a [u32],
    /// The light that is gathered beyond the first diffuse bounce, as far as it is known already.
    pub(super) known: Option<&'a SecondaryIrradiance>,
    pub(super) traversal: &'a mut Traversal,
    pub(super) features: PhantomData<F>,
}

impl<F: Features> Estimator<'_, F> {
    /// The light along the last rays of up to [`WAVE`] paths.
    fn radiance(&mut self, paths: &[Path], radiance: &mut [Vec3]) {
        let rays: Vec<Ray> = paths.iter().map(|path| path.ray).collect();
        let mut hits = vec![None; rays.len()];
        self.scene
            .closest_incoherent(&rays, &mut hits, self.traversal);
        let mut surfaces = surfaces::<F>(self.scene, &rays, &hits);
        let spots = self.scene.spots();
        if spots.is_empty() {
            let lit = self.direct(&surfaces, &rays, |_| {});
            return self.leaving(paths, &surfaces, &lit, radiance);
        }
        let mut seen_by_lights = [0.0; WAVE];
        let lit = self.direct(&surfaces, &rays, |lit| {
            seen_by_lights[lit.number] += spots.density(lit.light, lit.distance, lit.cosine);
        });
        let mut weights = [0.0; WAVE];
        for (i, path) in paths.iter().enumerate() {
            let met = hits[i].as_ref().zip(surfaces[i].as_ref());
            weights[i] = path.weight(met, seen_by_lights[i]);
            if weights[i] == 0.0 {
                surfaces[i] = None;
            }
        }
        self.leaving(paths, &surfaces, &lit, radiance);
        for (radiance, weight) in radiance.iter_mut().zip(weights) {
            *radiance *= weight;
        }
    }

    fn direct(
        &mut self,
        surfaces: &[Option<Surface>],
        rays: &[Ray],
        reached: impl FnMut(&Lit),
    ) -> Vec<Vec3> {
        direct_of_wave::<F>(self.scene, surfaces, rays, self.traversal, reached)
    }

    /// The light that the surfaces at the ends of paths send along their last rays, given the direct
    /// light there.
    ///
    /// Every path's light is a sum over its own branches, in their order: it does not depend on which
    /// paths take their steps together.
    pub(super) fn leaving(
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
            } else if let Some(light) = self.known(path, surface) {
                radiance[parent] += diffuse * light;
                follow_mirror::<F>(path, surface, mirror, &mut branch);
            } else {
                self.gather(path, surface, diffuse, mirror, &mut branch);
            }
            // No more than needed for full waves: they stay in the cache.
            if branches.len() >= WAVE {
                self.follow(&mut branches, surfaces, radiance);
            }
        }
        self.follow(&mut branches, surfaces, radiance);
    }

    /// The light that arrives from the hemisphere at the end of a path, if it is known.
    fn known(&self, path: &Path, surface: &Surface) -> Option<Vec3> {
        let known = self.known?;
        let point = &surface.point;
        let distance = (point.position - path.ray.origin).length();
        let left = self.bounces - path.depth;
        known.light(point.position, point.shading_normal, left, distance)
    }

    /// Adds the light of branches to that of the paths that they go on from, which end at `surfaces`.
    fn follow(
        &mut self,
        branches: &mut Vec<Branch>,
        surfaces: &[Option<Surface>],
        radiance: &mut [Vec3],
    ) {
        if !self.scene.spots().is_empty() {
            self.aim(branches, surfaces);
        }
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

    /// Turns the rays that leave lights into rays from the surfaces towards the points that these lights
    /// see; branches that cannot reach theirs are left out.
    fn aim(&mut self, branches: &mut Vec<Branch>, surfaces: &[Option<Surface>]) {
        let from_lights: Vec<usize> = (0..branches.len())
            .filter(|&i| matches!(branches[i].path.choice, Choice::Spot { .. }))
            .collect();
        let rays: Vec<Ray> = from_lights.iter().map(|&i| branches[i].path.ray).collect();
        let mut hits = vec![None; rays.len()];
        self.scene
            .closest_incoherent(&rays, &mut hits, self.traversal);
        for (&i, hit) in from_lights.iter().zip(&hits) {
            let branch = &mut branches[i];
            let surface = surfaces[branch.parent].as_ref();
            let aimed = surface.zip(hit.as_ref());
            match aimed.and_then(|(surface, hit)| branch.path.aim(surface, hit)) {
                Some(path) => branch.path = path,
                None => branch.share = Vec3::ZERO,
            }
        }
        branches.retain(|branch| branch.share != Vec3::ZERO);
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
        let diffuse = diffuse / (1.0 - mirror_chance);
        for i in 0..count {
            let next = Path {
                depth: path.depth + 1,
                diffuse_bounces: path.diffuse_bounces + 1,
                index: path.index.wrapping_mul(count).wrapping_add(i),
                choice: Choice::Only,
                ..*path
            };
            let by_mirror = mirror_chance > 0.0
                && path.sequence.sample_1d(next.index, next.depth) < mirror_chance;
            if by_mirror {
                let index = next.index;
                let share = mirror / mirror_chance;
                follow_mirror::<F>(&Path { index, ..*path }, surface, share, branch);
            } else if let Some(next) = self.diffuse_branch(next, surface) {
                branch(diffuse, next);
            }
        }
    }

    /// The path with a direction of the diffuse lobe; none where the surface's shape is in the way.
    #[inline]
    fn diffuse_branch(&self, path: Path, surface: &Surface) -> Option<Path> {
        let spots = self.scene.spots();
        let mut number = path.index;
        if !spots.is_empty() {
            match path.sequence.deal(path.index, path.depth) {
                Dealt::Kept(kept) => number = kept,
                Dealt::Apart(apart) => {
                    let numbers = path.sequence.sample_2d(apart, SPOT_PAIRS + path.depth);
                    return Some(Path {
                        ray: spots.ray(self.scene, numbers),
                        choice: Choice::UNAIMED,
                        ..path
                    });
                }
            }
        }
        let [u, v] = path.sequence.sample_2d(number, path.depth);
        let local = cosine_hemisphere(u, v);
        let direction = to_world(surface.point.shading_normal, local);
        // Below the shape's own horizon an interpolated normal gathers nothing.
        (direction.dot(surface.point.geometric_normal) > 0.0).then(|| Path {
            ray: surface.point.spawn_ray(direction),
            choice: if spots.is_empty() {
                Choice::Only
            } else {
                let density = local.z / PI;
                Choice::Cosine { density }
            },
            ..path
        })
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
            choice: Choice::Only,
            ..*path
        };
        branch(mirror, next);
    }
}
