//! Everything of a scene that emits and is sampled as a light: triangles, spheres and the balls of point lights, in a
//! light tree.

use super::emitter::Shape;
use crate::light::LightTree;
use glam::Vec3;

/// The emitters of a scene; empty in most.
#[derive(Debug, Default)]
pub(super) struct Emitters {
    /// Those of each primitive; empty if no primitive emits.
    pub(super) of_primitive: Vec<Option<Pieces>>,
    pub(super) emitters: Vec<Emitter>,
    pub(super) tree: LightTree,
}

#[derive(Debug)]
pub(super) struct Emitter {
    pub(super) shape: Shape,
    pub(super) source: Source,
    /// Its mean radiance.
    pub(super) radiance: Vec3,
}

/// Where the light of an emitter comes from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    /// A primitive of the scene.
    Primitive(u32),
    /// The ball of a point light.
    Ball(usize),
}

/// The emitters of a primitive: one, or those of the equal parts that a textured triangle is cut into.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pieces {
    pub(super) first: u32,
    /// Into so many parts each of its edges is cut.
    pub(super) rows: u32,
}

impl Emitters {
    pub(super) fn is_empty(&self) -> bool {
        self.emitters.is_empty()
    }

    /// Whether a primitive emits.
    #[inline(always)]
    pub(super) fn is_emitter(&self, primitive: u32) -> bool {
        matches!(self.of_primitive.get(primitive as usize), Some(Some(_)))
    }

    pub(super) fn memory(&self) -> usize {
        size_of_val(&*self.of_primitive) + size_of_val(&*self.emitters) + self.tree.memory()
    }
}

impl Pieces {
    /// The number of the piece at the weights of the second and third vertex. Row i, between weights of i and i + 1 rows of
    /// the second vertex, has 2 (rows - i) - 1 pieces.
    pub(super) fn piece_at(self, u: f32, v: f32) -> usize {
        let rows = self.rows as usize;
        let (u, v) = (u * rows as f32, v * rows as f32);
        let row = (u as usize).min(rows - 1);
        let column = (v as usize).min(rows - 1 - row);
        let is_upper = (u - row as f32) + (v - column as f32) > 1.0 && column + 1 < rows - row;
        2 * rows * row - row * row + 2 * column + usize::from(is_upper)
    }

    /// The weights of the second and third vertex at the corners of all pieces, in the order of [`Pieces::piece_at`].
    pub(super) fn corners(rows: u32) -> impl Iterator<Item = [[f64; 2]; 3]> {
        let at = move |i: u32, j: u32| [i, j].map(|k| f64::from(k) / f64::from(rows));
        (0..rows).flat_map(move |row| {
            (0..rows - row).flat_map(move |column| {
                let lower = [at(row, column), at(row + 1, column), at(row, column + 1)];
                let upper = [
                    at(row + 1, column),
                    at(row + 1, column + 1),
                    at(row, column + 1),
                ];
                let has_upper = column + 1 < rows - row;
                [Some(lower), has_upper.then_some(upper)]
                    .into_iter()
                    .flatten()
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_found_where_their_corners_are() {
        for rows in [1, 2, 3, 8, 32] {
            let pieces = Pieces { first: 0, rows };
            let mut count = 0;
            for (number, corners) in Pieces::corners(rows).enumerate() {
                let middle = |k: usize| corners.iter().map(|c| c[k]).sum::<f64>() / 3.0;
                let found = pieces.piece_at(middle(0) as f32, middle(1) as f32);
                assert_eq!(found, number, "{rows} rows");
                count += 1;
            }
            assert_eq!(count, rows * rows);
            // Rounding may lead to an edge.
            for (u, v) in [(1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.0, 0.0)] {
                assert!(pieces.piece_at(u, v) < count as usize);
            }
        }
    }
}
