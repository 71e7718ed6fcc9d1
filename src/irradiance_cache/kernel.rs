//! Lookups, compiled for each instruction set. The lanes are the same to the last bit: nothing in them is
//! fused or reordered.

use super::IrradianceRecords;
use super::lookup::{self, LANES};
use super::primary::LinearIrradiance;
use crate::simd::{Simd, WithSimd};
use glam::Vec3;

/// [`lookup::lights`] for every instruction set.
pub(super) struct Lookup<'a> {
    pub(super) points: &'a [(Vec3, Vec3); LANES],
    pub(super) numbers: &'a [u32],
    pub(super) places: &'a IrradianceRecords,
    pub(super) light: &'a [LinearIrradiance],
}

impl WithSimd for Lookup<'_> {
    type Output = [Option<Vec3>; LANES];

    #[inline(always)]
    fn with_simd<S: Simd>(self) -> [Option<Vec3>; LANES] {
        // Plain loops over lanes, which are vectorised.
        lookup::lights(self.points, self.numbers, self.places, self.light)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{IrradianceRecord, OccluderPlanes};
    use super::*;
    use crate::math::Aabb;
    use crate::sampling::Random;
    use crate::simd::Kernel;

    #[test]
    fn all_instructions_agree_to_the_bit() {
        let mut random = Random::new(11);
        let bounds = Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::ONE,
        };
        let mut places = IrradianceRecords::new(bounds, 0.6);
        let mut light = Vec::new();
        for number in 0..500 {
            let mut walls = OccluderPlanes::default();
            if number % 3 == 0 {
                walls.add(random.vector(1.0), random.vector(1.0).normalize(), 0.3);
            }
            places.push(IrradianceRecord {
                position: random.vector(1.0),
                normal: random.vector(1.0).normalize(),
                radius: 0.2 + random.unit(),
                walls,
            });
            light.push(LinearIrradiance {
                light: random.vector(1.0),
                gradient: [0, 1, 2].map(|_| random.vector(1.0)),
            });
        }
        let numbers: Vec<u32> = (0..500).collect();
        let mut known = 0;
        for _ in 0..50 {
            let points = [(); LANES].map(|()| {
                let near = 0.2 * random.vector(1.0);
                (near, random.vector(1.0).normalize())
            });
            let of_kernel = |kernel: Kernel| {
                kernel.run(Lookup {
                    points: &points,
                    numbers: &numbers,
                    places: &places,
                    light: &light,
                })
            };
            let plain = of_kernel(Kernel::PORTABLE);
            let bits = |light: Option<Vec3>| light.map(|light| light.to_array().map(f32::to_bits));
            for kernel in Kernel::available() {
                assert_eq!(plain.map(bits), of_kernel(kernel).map(bits));
            }
            known += plain.iter().flatten().count();
        }
        assert!(known > 50 * LANES / 2, "{known}");
    }
}
