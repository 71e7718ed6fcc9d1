//! A distribution of directions, constant within the cells of a cube around a point.

use glam::Vec3;

/// Cells along the edge of a face.
const EDGE: usize = 8;

/// Cells of the cube.
const CELLS: usize = 6 * EDGE * EDGE;

/// Probabilities are whole numbers over this.
const STEPS: u16 = u16::MAX;

/// Where the search for a cell begins: by as many parts of the steps.
const STARTS: usize = 64;

/// What a neighbour adds to a cell, of its own weight: what is seen moves with the point.
const BLUR: f64 = 0.15;

/// A square of a face of the cube [-1, 1]^3.
#[derive(Clone, Copy, Debug)]
pub struct DirectionCell(u16);

/// Directions, constant within the cells of a cube.
#[derive(Clone, Debug)]
pub struct DirectionHistogram {
    /// The probability of all cells before each, in steps; that before the end, 1, is left out.
    before: [u16; CELLS],
    /// The last cell that begins at or before each part of the steps.
    starts: [u16; STARTS],
}

/// The face of the cube that a direction goes through: twice its axis, and 1 more on the negative side.
#[inline]
pub fn cube_face(direction: Vec3) -> usize {
    let size = direction.abs();
    let axis = match () {
        () if size.x >= size.y && size.x >= size.z => 0,
        () if size.y >= size.z => 1,
        () => 2,
    };
    2 * axis + usize::from(direction[axis] < 0.0)
}

impl DirectionCell {
    /// All cells, in the order of their weights in [`DirectionHistogram::new`].
    pub fn all() -> impl Iterator<Item = DirectionCell> {
        (0..CELLS as u16).map(DirectionCell)
    }

    /// The cell of a direction.
    #[inline]
    fn of(direction: Vec3) -> DirectionCell {
        let face = cube_face(direction);
        let size = direction[face / 2].abs();
        let place = |axis: usize| {
            let at = 0.5 * (direction[axis] / size + 1.0) * EDGE as f32;
            (at as usize).min(EDGE - 1)
        };
        let [column, row] = [[1, 2], [2, 0], [0, 1]][face / 2].map(place);
        DirectionCell(((face * EDGE + row) * EDGE + column) as u16)
    }

    /// The unit direction at a place of the cell, two numbers in [0, 1).
    #[inline]
    pub fn direction(self, place: [f32; 2]) -> Vec3 {
        let number = usize::from(self.0);
        let (face, row, column) = (number / (EDGE * EDGE), number / EDGE % EDGE, number % EDGE);
        let along = |cell: usize, place: f32| (cell as f32 + place) * (2.0 / EDGE as f32) - 1.0;
        let (a, b) = (along(column, place[0]), along(row, place[1]));
        let out = if face % 2 == 0 { 1.0 } else { -1.0 };
        let point = match face / 2 {
            0 => Vec3::new(out, a, b),
            1 => Vec3::new(b, out, a),
            _ => Vec3::new(a, b, out),
        };
        point.normalize()
    }

    /// The solid angle, in sr, that a cell would have if all of it were as close to the centre of the cube as in this unit
    /// direction: 1 over it is the pdf of [`DirectionCell::direction`].
    #[inline]
    pub fn solid_angle(direction: Vec3) -> f32 {
        let cosine = direction.abs().max_element();
        let edge = 2.0 / EDGE as f32;
        edge * edge * cosine * cosine * cosine
    }
}

impl DirectionHistogram {
    /// Cells in proportion to their weights, blurred a little; none if all are 0.
    pub fn new(weights: &[f64]) -> Option<DirectionHistogram> {
        let weights: Vec<f64> = weights.chunks(EDGE * EDGE).flat_map(blurred).collect();
        let sum: f64 = weights.iter().sum();
        // What weighs anything has a step at least.
        let least = |weight: &&f64| **weight > 0.0;
        let spare = f64::from(STEPS) - weights.iter().filter(least).count() as f64;
        let mut total = 0.0;
        let mut before = [0; CELLS];
        let mut counted = 0.0;
        for (cell, weight) in weights.iter().enumerate() {
            before[cell] = (counted + (total / sum * spare).floor()) as u16;
            total += weight;
            counted += f64::from(u8::from(*weight > 0.0));
        }
        let start = |part: usize| {
            let step = (part * usize::from(STEPS) / STARTS) as u16;
            before.partition_point(|&before| before <= step) as u16 - 1
        };
        (sum > 0.0).then(|| DirectionHistogram {
            starts: std::array::from_fn(start),
            before,
        })
    }

    /// A unit direction, by two numbers in [0, 1).
    #[inline]
    pub fn sample(&self, [u, v]: [f32; 2]) -> Vec3 {
        let steps = u * f32::from(STEPS);
        let mut cell = usize::from(self.starts[(u * STARTS as f32) as usize]);
        while self
            .before
            .get(cell + 1)
            .is_some_and(|&before| f32::from(before) <= steps)
        {
            cell += 1;
        }
        let rest = (steps - f32::from(self.before[cell])) / self.steps(cell);
        DirectionCell(cell as u16).direction([rest.min(1.0_f32.next_down()), v])
    }

    /// The pdf of a unit direction, over solid angle.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        let cell = DirectionCell::of(direction);
        self.steps(usize::from(cell.0)) / (f32::from(STEPS) * DirectionCell::solid_angle(direction))
    }

    /// The probability of a cell, in steps.
    #[inline]
    fn steps(&self, cell: usize) -> f32 {
        let end = self.before.get(cell + 1).unwrap_or(&STEPS);
        f32::from(end - self.before[cell])
    }
}

/// The cells of a face, with a part of their neighbours.
fn blurred(face: &[f64]) -> impl Iterator<Item = f64> {
    face.iter().enumerate().map(|(index, own)| {
        let (row, column) = (index / EDGE, index % EDGE);
        let neighbour = |[dx, dy]: [usize; 2]| {
            let (x, y) = ((column + dx).checked_sub(1)?, (row + dy).checked_sub(1)?);
            (x < EDGE && y < EDGE).then(|| face[y * EDGE + x])
        };
        let neighbours = [[0, 1], [2, 1], [1, 0], [1, 2]];
        own + BLUR * neighbours.into_iter().filter_map(neighbour).sum::<f64>()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Random, SobolSequence, uniform_sphere};
    use std::f64::consts::PI;

    /// Every direction lies in the cell that it was chosen in, and the mean of the solid angle's inverse makes up the cell.
    #[test]
    fn cells_tile_the_sphere() {
        let mut sum = 0.0;
        let n = 8;
        for cell in DirectionCell::all() {
            for i in 0..n * n {
                let place = [i % n, i / n].map(|k| (k as f32 + 0.5) / n as f32);
                let direction = cell.direction(place);
                assert!((direction.length() - 1.0).abs() < 1e-6);
                assert_eq!(DirectionCell::of(direction).0, cell.0);
                sum += f64::from(DirectionCell::solid_angle(direction)) / f64::from(n * n);
            }
        }
        assert!((sum - 4.0 * PI).abs() < 1e-3, "{sum}");
    }

    /// Some histograms: of one cell, of a few, of many of very different weights.
    fn histograms() -> Vec<(Vec<f64>, DirectionHistogram)> {
        let mut random = Random::new(3);
        let mut sparse = vec![0.0; CELLS];
        let mut dense = vec![0.0; CELLS];
        for (cell, weight) in dense.iter_mut().enumerate() {
            *weight = 10.0_f64.powf(f64::from(random.unit()) * 12.0);
            if cell % 29 == 28 {
                sparse[cell] = *weight;
            }
        }
        let mut last = vec![0.0; CELLS];
        last[CELLS - 1] = 1e-20;
        let of = |weights: Vec<f64>| {
            let histogram = DirectionHistogram::new(&weights).expect("a weight");
            (weights, histogram)
        };
        vec![of(sparse), of(dense), of(last), of(vec![1.0; CELLS])]
    }

    #[test]
    fn the_pdf_integrates_to_one() {
        for (_, histogram) in histograms() {
            let n = 1000;
            let mut sum = 0.0;
            for i in 0..n * n {
                let [u, v] = [i % n, i / n].map(|k| (k as f32 + 0.5) / n as f32);
                sum += f64::from(histogram.pdf(uniform_sphere(u, v))) * 4.0 * PI;
            }
            let mean = sum / f64::from(n * n);
            assert!((mean - 1.0).abs() < 0.01, "{mean}");
        }
    }

    /// Directions are found as often as their pdf says: in every cell of some weight, and in none without but its neighbours'.
    #[test]
    fn directions_are_chosen_by_the_pdf() {
        let sequence = SobolSequence::new(1, 2, 3, 4);
        let n = 1 << 18;
        for (weights, histogram) in histograms() {
            let mut seen = vec![0.0; CELLS];
            for i in 0..n {
                let direction = histogram.sample(sequence.sample_2d(i, 0));
                seen[usize::from(DirectionCell::of(direction).0)] += 1.0 / f64::from(n);
            }
            let blurred: Vec<f64> = weights.chunks(EDGE * EDGE).flat_map(blurred).collect();
            let sum: f64 = blurred.iter().sum();
            for (cell, seen) in seen.into_iter().enumerate() {
                let expected = blurred[cell] / sum;
                assert!((seen - expected).abs() < 0.007, "{cell}: {seen} {expected}");
                assert_eq!(seen > 0.0, blurred[cell] > 0.0);
                let centre = DirectionCell(cell as u16).direction([0.5; 2]);
                let pdf = f64::from(histogram.pdf(centre));
                let solid_angle = f64::from(DirectionCell::solid_angle(centre));
                assert!((pdf * solid_angle - seen).abs() < 1e-4);
            }
        }
        assert!(DirectionHistogram::new(&[0.0; CELLS]).is_none());
    }
}
