//! A pseudo-random generator for tests and the self-test: the upper bits of a linear
//! congruential generator with the constants of MMIX (Knuth, "The Art of Computer Programming", volume 2, section
//! 3.3.4).

use glam::{DVec3, Vec3};

/// A generator of pseudo-random numbers. The same seed gives the same numbers on every machine.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A generator with a seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0
    }

    /// A number uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1 << 24) as f32
    }

    /// A point uniform in the cube from -`size` to `size`.
    pub fn vector(&mut self, size: f32) -> Vec3 {
        Vec3::new(self.unit() - 0.5, self.unit() - 0.5, self.unit() - 0.5) * 2.0 * size
    }

    /// A triangle with one vertex in the box of `spread` and the others within the box of `size` from it.
    pub fn triangle(&mut self, spread: f32, size: f32) -> [Vec3; 3] {
        let vertex = self.vector(spread);
        [
            vertex,
            vertex + self.vector(size),
            vertex + self.vector(size),
        ]
    }

    /// A point uniform in the cube from -1 to 1.
    pub fn point(&mut self) -> DVec3 {
        self.vector(1.0).as_dvec3()
    }

    /// An integer uniform in 0..`count`.
    pub fn below(&mut self, count: usize) -> usize {
        (((self.next() >> 32) * count as u64) >> 32) as usize
    }

    /// An integer uniform in -`size`..=`size`.
    pub fn whole(&mut self, size: i64) -> i64 {
        self.below(2 * size as usize + 1) as i64 - size
    }
}
