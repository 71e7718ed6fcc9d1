//! Hard cases with known answers, run on the machine that will render: numerical robustness, and radiance with a closed
//! form.
//!
//! Each case measures its largest deviation from an answer that is derived, not recorded, with every kernel that the
//! processor supports. Knows nothing of files or terminals.

mod boxes;
mod degenerate;
mod fixtures;
mod frames;
mod light;
mod room;
mod shapes;
mod spheres;
mod surfaces;
mod textures;
mod watertight;

use crate::simd::Kernel;
use rayon::prelude::*;

/// A numerically hard case with a known answer.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// The topic; cases of one group are neighbours in [`CASES`].
    pub group: &'static str,
    /// What is computed.
    pub name: &'static str,
    /// What is counted or measured: 0 is exact.
    pub measures: &'static str,
    /// The largest value that passes.
    pub limit: f64,
    measure: fn(Kernel) -> f64,
}

impl Case {
    /// Runs the case on the threads of the current pool; returns the largest value with each of
    /// [`Kernel::available`].
    pub fn run(&self) -> Vec<f64> {
        let kernels = Kernel::available().into_par_iter();
        kernels.map(self.measure).collect()
    }

    /// Whether all values are within the limit. NaN is not.
    pub fn holds(&self, worst: &[f64]) -> bool {
        worst.iter().all(|worst| *worst <= self.limit)
    }
}

/// The cases, and a test for each of them.
macro_rules! cases {
    ($($module:ident { $($function:ident, $name:literal: $measures:literal, at most $limit:expr;)* })*) => {
        /// All cases.
        pub const CASES: &[Case] = &[$($(Case {
            group: stringify!($module),
            name: $name,
            measures: $measures,
            limit: $limit,
            measure: $module::$function,
        },)*)*];

        #[cfg(test)]
        mod tests {
            use super::*;
            $($(
                #[test]
                fn $function() {
                    let case = CASES.iter().find(|case| case.name == $name).expect("it is listed");
                    let worst = case.run();
                    assert!(case.holds(&worst), "{worst:?}, {case:?}");
                }
            )*)*
        }
    };
}

cases! {
    watertight {
        vertices_and_edges, "rays through vertices of 2 to 64 triangles": "missed or ambiguous", at most 0.0;
        closed_mesh, "rays at edges of a mesh of 1e-6 to 1e6 m": "escapes of 20,000 each", at most 0.0;
        closed_mesh_anywhere, "the same 0, 1e4, 1e6 m from the origin": "escapes of 20,000 each", at most 0.0;
        scaled_unevenly, "scales of (1, 1e-3, 1e3), mirrored": "sine; 1 for an escape", at most 1e-6;
    }
    degenerate {
        edge_on, "rays in a triangle's plane; without area": "hits", at most 0.0;
        slivers, "a sliver of 1 to 1e-7 among others": "rays that pass between", at most 0.0;
        sliver_normals, "normals of slivers": "sine of the angle to the exact one", at most 2e-7;
        coincident, "100,000 coincident triangles": "hits of any but the first", at most 0.0;
        without_area, "coincident or collinear vertices": "not dropped, not counted", at most 0.0;
    }
    boxes {
        brute_force, "2 x 1,000,000 rays, double precision": "other hits than brute force", at most 0.0;
        along_axes, "rays along axes, 0, -0, 1e-38, 1e-45": "other hits than brute force", at most 0.0;
        small_scenes, "no shape, one, two, a few": "other hits than brute force", at most 0.0;
        on_huge_ground, "triangles of 1e-3 m on a ground of 1e6 m": "other hits than brute force", at most 0.0;
        deep_trees, "100,000 equal centres; huge among tiny": "other hits, faults of the BVH", at most 0.0;
    }
    spheres {
        hits_and_misses, "0 to 1e6 radii away, exact arithmetic": "wrong hits and misses", at most 0.0;
        distances, "distances to these spheres": "error, in radii", at most 1e-6;
        tangents, "tangents, within 4 ulp": "error, in radii; 1 if wrong", at most 1e-6;
        concentric, "radii of 10,000 and 10,001": "wrong order", at most 0.0;
        ground, "a ground of radius 1e6 m from 1 m above": "relative error of the radiance", at most 1e-4;
    }
    surfaces {
        leaving_triangles, "1,000,000 rays leave each of five quads": "hit the quad again", at most 0.0;
        leaving_spheres, "rays leave spheres, out- and inwards": "hit it where they left", at most 0.0;
        closed_corner, "1,000,000 rays from 1e-4 m beside edges": "escapes", at most 0.0;
        thin_wall, "a wall thinner than an ulp before a lamp": "points with wrong shadow", at most 0.0;
    }
    textures {
        coordinates, "coordinates of 0, 1, -1e-30, 1e6; one texel": "error of the colour", at most 1e-6;
        poles_and_seam, "a globe's poles and seam": "error of the colour", at most 1e-5;
        equal_vertices, "vertices with equal coordinates": "error of the colour", at most 1e-5;
    }
    light {
        terminator, "the terminator of a coarse smooth mesh": "error of the radiance", at most 1e-5;
        mirror_corridor, "images of a ball by 1 to 4 mirrors": "error of the radiance", at most 1e-6;
        grazing_mirror, "a mirror seen at 89.99, 89.9999 degrees": "error of the radiance", at most 1e-6;
        near_and_far, "lamps 0 to 1e15 m away, in the surface": "relative error", at most 1e-5;
        sphere_interior, "inside a sphere, 0 to 20 bounces": "error of the radiance", at most 5e-6;
        furnace, "white, grey and mirror under a sky of 1": "error of the radiance", at most 1e-6;
    }
    frames {
        scales, "a room of 1e-3 m, 1e6 m beside one of 1 m": "difference, in 8-bit codes", at most 1.0;
        powers_of_two, "montecarlo in rooms of 2^-20, 2^20 m": "pixels that differ", at most 0.0;
        far_away, "a room of 1 m, 1e6 m from the origin": "difference, in 8-bit codes", at most 1.0;
        through_a_wall, "through a wall thinner than an ulp": "frames of the wrong side", at most 0.0;
        slow_dolly, "2,000 frames 1e-4 m apart, at 1e4 m": "error of the radiance; its jumps", at most 2e-5;
        instructions, "all four modes, SIMD and portable code": "pixels that differ", at most 0.0;
        threads, "all four modes on 1, 2 and 5 threads": "pixels that differ", at most 0.0;
    }
}
