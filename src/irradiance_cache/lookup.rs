//! Interpolation between records at a packet of points: Shepard's method with weights of compact support, in lanes.

use super::irradiance_gradient::LinearIrradiance;
use super::record::{HEIGHT_WEIGHT, IrradianceRecord};
use super::records::IrradianceRecords;
use crate::math::Aabb;
use crate::simd::{PACKET_WIDTH, Simd, WithSimd};
use glam::Vec3;

/// Points that are looked up together.
pub(super) const LANES: usize = PACKET_WIDTH;

type Lanes = [f32; LANES];

/// The weighted mean of the values of the candidate records at points with unit normals; none where no candidate
/// covers a point. The result at a point does not depend on the other points.
pub(super) struct Interpolate<'a> {
    pub(super) points: &'a [(Vec3, Vec3); LANES],
    pub(super) candidates: &'a [u32],
    pub(super) records: &'a IrradianceRecords,
    pub(super) values: &'a [LinearIrradiance],
}

impl WithSimd for Interpolate<'_> {
    type Output = [Option<Vec3>; LANES];

    #[inline(always)]
    fn with_simd<S: Simd>(self) -> [Option<Vec3>; LANES] {
        let mut sums = WeightedSums::new(self.points, self.records.normal_weight());
        for &index in self.candidates {
            let index = index as usize;
            sums.add(&self.records[index], &self.values[index]);
        }
        sums.means()
    }
}

/// Points, as structure of arrays, and the weighted sums of values there. Plain loops over independent lanes,
/// which compile to vector code.
struct WeightedSums {
    position: [Lanes; 3],
    normal: [Lanes; 3],
    normal_weight: f32,
    /// Bounding sphere of the points.
    center: Vec3,
    bounding_radius: f32,
    sums: [Lanes; 3],
    weights: Lanes,
}

impl WeightedSums {
    #[inline(always)]
    fn new(points: &[(Vec3, Vec3); LANES], normal_weight: f32) -> WeightedSums {
        let (mut position, mut normal) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for (lane, (p, n)) in points.iter().enumerate() {
            for axis in 0..3 {
                position[axis][lane] = p[axis];
                normal[axis][lane] = n[axis];
            }
        }
        let bounds = Aabb::of(points.iter().map(|(position, _)| *position));
        WeightedSums {
            position,
            normal,
            normal_weight,
            center: bounds.center(),
            bounding_radius: 0.5 * bounds.extent().length(),
            sums: [[0.0; LANES]; 3],
            weights: [0.0; LANES],
        }
    }

    /// Whether a record may cover any of the points.
    #[inline]
    fn may_cover(&self, record: &IrradianceRecord) -> bool {
        const ROUNDING: f32 = 1.001;
        let distance = ROUNDING * (record.radius + self.bounding_radius);
        record.position.distance_squared(self.center) < distance * distance
    }

    /// Adds a record's value, with its [`IrradianceRecord::weight`] for a support radius of 1.
    #[inline(always)]
    fn add(&mut self, record: &IrradianceRecord, value: &LinearIrradiance) {
        if !self.may_cover(record) {
            return;
        }
        let [px, py, pz] = &self.position;
        let [nx, ny, nz] = &self.normal;
        let (p, n) = (record.position, record.normal);
        let scale = 1.0 / (record.radius * record.radius);
        let mut weights = [0.0; LANES];
        for (lane, weight) in weights.iter_mut().enumerate() {
            let (x, y, z) = (px[lane] - p.x, py[lane] - p.y, pz[lane] - p.z);
            let height = x * n.x + y * n.y + z * n.z;
            let squared = x * x + y * y + z * z + HEIGHT_WEIGHT * height * height;
            let cos = nx[lane] * n.x + ny[lane] * n.y + nz[lane] * n.z;
            let rest = (1.0 - (squared * scale + (1.0 - cos) * self.normal_weight)).max(0.0);
            *weight = rest * rest * scale;
        }
        if all_zero(&weights) {
            return;
        }
        for plane in record.occluders.planes() {
            for (lane, weight) in weights.iter_mut().enumerate() {
                let distance =
                    plane.x * px[lane] + plane.y * py[lane] + plane.z * pz[lane] + plane.w;
                *weight = if distance < 0.0 { 0.0 } else { *weight };
            }
        }
        for (sum, weight) in self.weights.iter_mut().zip(weights) {
            *sum += weight;
        }
        for (channel, sums) in self.sums.iter_mut().enumerate() {
            let (center, gradient) = (value.mean_radiance[channel], value.gradient[channel]);
            for (lane, sum) in sums.iter_mut().enumerate() {
                let (x, y, z) = (px[lane] - p.x, py[lane] - p.y, pz[lane] - p.z);
                let value = center + (gradient.x * x + gradient.y * y + gradient.z * z);
                *sum += weights[lane] * value;
            }
        }
    }

    #[inline(always)]
    fn means(&self) -> [Option<Vec3>; LANES] {
        let mut means = self.sums;
        for channel in &mut means {
            for (mean, weight) in channel.iter_mut().zip(&self.weights) {
                *mean = (*mean / weight).max(0.0);
            }
        }
        let [red, green, blue] = means;
        let mut values = [None; LANES];
        for (lane, value) in values.iter_mut().enumerate() {
            if self.weights[lane] > 0.0 {
                *value = Some(Vec3::new(red[lane], green[lane], blue[lane]));
            }
        }
        values
    }
}

/// Whether all weights are +0; none is negative.
fn all_zero(weights: &Lanes) -> bool {
    weights.iter().fold(0, |bits, w| bits | w.to_bits()) == 0
}

#[cfg(test)]
mod tests {
    use super::super::record::OccluderPlanes;
    use super::*;
    use crate::sampling::Random;
    use crate::simd::Kernel;

    /// Lanes agree with the records evaluated one by one.
    #[test]
    fn lanes_agree_with_records_one_by_one() {
        let mut random = Random::new(1);
        let mut normal = move || random.vector(1.0).normalize();
        let mut random = Random::new(2);
        let points = [(); LANES].map(|()| (random.vector(1.0), normal()));
        let normal_weight = 0.7;
        let mut lanes = WeightedSums::new(&points, normal_weight);
        let mut sums = [(Vec3::ZERO, 0.0); LANES];
        for _ in 0..400 {
            let mut occluders = OccluderPlanes::default();
            if random.below(3) == 0 {
                occluders.add(random.vector(1.0), normal(), 0.5);
            }
            let record = IrradianceRecord {
                position: random.vector(1.0),
                normal: normal(),
                radius: 0.1 + random.unit(),
                occluders,
            };
            let value = LinearIrradiance {
                mean_radiance: random.vector(1.0) + 1.0,
                gradient: [0, 1, 2].map(|_| random.vector(0.3)),
            };
            lanes.add(&record, &value);
            for ((position, normal), (sum, weights)) in points.iter().zip(&mut sums) {
                let weight = record.weight(*position, *normal, normal_weight, 1.0);
                *sum += weight * value.at(position - record.position);
                *weights += weight;
            }
        }
        let mut covered = 0;
        for (value, (sum, weights)) in lanes.means().into_iter().zip(sums) {
            let expected = (weights > 0.0).then(|| (sum / weights).max(Vec3::ZERO));
            covered += usize::from(expected.is_some());
            match (value, expected) {
                (Some(value), Some(expected)) => {
                    assert!((value - expected).length() < 1e-5, "{value} {expected}");
                }
                (value, expected) => assert_eq!(value, expected),
            }
        }
        assert!(covered > LANES / 2);
    }

    #[test]
    fn all_instruction_sets_agree_to_the_bit() {
        let mut random = Random::new(11);
        let bounds = Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::ONE,
        };
        let mut records = IrradianceRecords::new(bounds, 0.6);
        let mut values = Vec::new();
        for index in 0..500 {
            let mut occluders = OccluderPlanes::default();
            if index % 3 == 0 {
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
            let of_kernel = |kernel: Kernel| {
                let interpolate = Interpolate {
                    points: &points,
                    candidates: &candidates,
                    records: &records,
                    values: &values,
                };
                let bits = |value: Vec3| value.to_array().map(f32::to_bits);
                kernel.run(interpolate).map(|value| value.map(bits))
            };
            let portable = of_kernel(Kernel::PORTABLE);
            for kernel in Kernel::available() {
                assert_eq!(of_kernel(kernel), portable, "{kernel}");
            }
            covered += portable.iter().flatten().count();
        }
        assert!(covered > 50 * LANES / 2, "{covered}");
    }
}
