//! Boxes as triangle meshes.

use glam::DVec3;

/// The vertices of a box from `min` to `max`, and its triangles, counter-clockwise seen from outside.
pub fn cuboid(min: DVec3, max: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let vertex = |i: usize| {
        let pick = |axis: usize| {
            if i >> axis & 1 == 0 {
                min[axis]
            } else {
                max[axis]
            }
        };
        DVec3::new(pick(0), pick(1), pick(2))
    };
    let sides = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let triangles = sides.into_iter().flat_map(halves);
    ((0..8).map(vertex).collect(), triangles.collect())
}
