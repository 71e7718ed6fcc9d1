//! Look-ups, compiled for each SIMD instruction set. Results are equal to the last bit: no operation is fused or
//! reordered.
#![expect(
    unsafe_code,
    reason = "calls into code compiled for a detected processor"
)]

use super::linear::LinearIrradiance;
use super::lookup::{self, LANES};
use super::records::IrradianceRecords;
use glam::Vec3;

type Points = [(Vec3, Vec3); LANES];
type Values = [Option<Vec3>; LANES];

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn interpolate_avx512(
    points: &Points,
    candidates: &[u32],
    records: &IrradianceRecords,
    values: &[LinearIrradiance],
) -> Values {
    lookup::interpolate(points, candidates, records, values)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn interpolate_avx2(
    points: &Points,
    candidates: &[u32],
    records: &IrradianceRecords,
    values: &[LinearIrradiance],
) -> Values {
    lookup::interpolate(points, candidates, records, values)
}

/// [`lookup::interpolate`] with the widest instruction set of this processor.
#[inline]
pub(super) fn interpolate(
    points: &Points,
    candidates: &[u32],
    records: &IrradianceRecords,
    values: &[LinearIrradiance],
) -> Values {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: the instructions were detected.
            return unsafe { interpolate_avx512(points, candidates, records, values) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the instructions were detected.
            return unsafe { interpolate_avx2(points, candidates, records, values) };
        }
    }
    lookup::interpolate(points, candidates, records, values)
}

#[cfg(test)]
mod tests {
    use super::super::record::{IrradianceRecord, OccluderPlanes};
    use super::*;
    use crate::math::Aabb;
    use crate::sampling::Random;

    /// Instruction sets of this processor and portable code.
    #[test]
    fn all_instruction_sets_agree_to_the_bit() {
        let mut random = Random::new(11);
        let bounds = Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::ONE,
        };
        let mut records = IrradianceRecords::new(bounds, 0.6);
        let mut values = Vec::new();
        for number in 0..500 {
            let mut occluders = OccluderPlanes::default();
            if number % 3 == 0 {
                occluders.add(random.vector(1.0), random.vector(1.0).normalize(), 0.3);
            }
            records.push(IrradianceRecord {
                position: random.vector(1.0),
                normal: random.vector(1.0).normalize(),
                radius: 0.2 + random.unit(),
                occluders,
            });
            values.push(LinearIrradiance {
                mean_radiance: random.vector(1.0),
                gradient: [0, 1, 2].map(|_| random.vector(1.0)),
            });
        }
        let candidates: Vec<u32> = (0..500).collect();
        let mut covered = 0;
        for _ in 0..50 {
            let points = [(); LANES].map(|()| {
                let position = 0.2 * random.vector(1.0);
                (position, random.vector(1.0).normalize())
            });
            let plain = lookup::interpolate(&points, &candidates, &records, &values);
            let best = interpolate(&points, &candidates, &records, &values);
            let bits = |value: Option<Vec3>| value.map(|value| value.to_array().map(f32::to_bits));
            assert_eq!(plain.map(bits), best.map(bits));
            covered += plain.iter().flatten().count();
        }
        assert!(covered > 50 * LANES / 2, "{covered}");
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            let points = [(Vec3::ZERO, Vec3::Y); LANES];
            let plain = lookup::interpolate(&points, &candidates, &records, &values);
            // SAFETY: the instructions were detected.
            let vector = unsafe { interpolate_avx2(&points, &candidates, &records, &values) };
            assert_eq!(plain, vector);
        }
    }
}
