//! Look-ups, compiled for each set of instructions. The lanes are the same to the last bit: nothing in them is
//! fused or reordered.
#![expect(
    unsafe_code,
    reason = "calls into code compiled for a detected processor"
)]

use super::IrradianceRecords;
use super::lookup::{self, LANES};
use super::primary::LinearIrradiance;
use glam::Vec3;

type Points = [(Vec3, Vec3); LANES];
type Lights = [Option<Vec3>; LANES];

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn lights_avx512(
    points: &Points,
    numbers: &[u32],
    places: &IrradianceRecords,
    light: &[LinearIrradiance],
) -> Lights {
    lookup::lights(points, numbers, places, light)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn lights_avx2(
    points: &Points,
    numbers: &[u32],
    places: &IrradianceRecords,
    light: &[LinearIrradiance],
) -> Lights {
    lookup::lights(points, numbers, places, light)
}

/// [`lookup::lights`] with the best instructions that this processor has.
#[inline]
pub(super) fn lights(
    points: &Points,
    numbers: &[u32],
    places: &IrradianceRecords,
    light: &[LinearIrradiance],
) -> Lights {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: the instructions were detected.
            return unsafe { lights_avx512(points, numbers, places, light) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the instructions were detected.
            return unsafe { lights_avx2(points, numbers, places, light) };
        }
    }
    lookup::lights(points, numbers, places, light)
}

#[cfg(test)]
mod tests {
    use super::super::{IrradianceRecord, OccluderPlanes};
    use super::*;
    use crate::math::Aabb;
    use crate::sampling::Random;

    /// Whatever the processor has, and plain code.
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
            let plain = lookup::lights(&points, &numbers, &places, &light);
            let best = lights(&points, &numbers, &places, &light);
            let bits = |light: Option<Vec3>| light.map(|light| light.to_array().map(f32::to_bits));
            assert_eq!(plain.map(bits), best.map(bits));
            known += plain.iter().flatten().count();
        }
        assert!(known > 50 * LANES / 2, "{known}");
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            let points = [(Vec3::ZERO, Vec3::Y); LANES];
            let plain = lookup::lights(&points, &numbers, &places, &light);
            // SAFETY: the instructions were detected.
            let vector = unsafe { lights_avx2(&points, &numbers, &places, &light) };
            assert_eq!(plain, vector);
        }
    }
}
