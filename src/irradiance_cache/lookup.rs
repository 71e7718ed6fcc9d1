//! Interpolation between records at a packet of points: Shepard's method with weights of compact support, in lanes.

use super::irradiance_gradient::LinearIrradiance;
use super::record::{HEIGHT_WEIGHT, IrradianceRecord, MAX_RADIUS_RATIO, SURE_HEIGHT};
use super::records::IrradianceRecords;
use crate::math::Aabb;
use crate::simd::{PACKET_WIDTH, Simd, WithSimd};
use glam::Vec3;

/// Points that are looked up together.
pub(super) const LANES: usize = PACKET_WIDTH;

type Lanes = [f32; LANES];

/// What is known of a candidate record: masks of points.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sight {
    /// Whether the points see the record was asked.
    pub(super) asked: u32,
    /// They do not see it.
    pub(super) blocked: u32,
}

/// What an interpolation gives.
#[derive(Debug)]
pub(super) struct Interpolated {
    /// The value at each point; none where no candidate covers it.
    pub(super) values: [Option<Vec3>; LANES],
    /// The candidates, by their places in the list, that some points, in the mask, do not surely see: once that is asked,
    /// the interpolation has to be made again.
    pub(super) doubts: Vec<(usize, u32)>,
}

/// The weighted mean of the values of the candidate records at points with unit normals. Candidates come with growing
/// radii. The result at a point does not depend on the other points.
pub(super) struct Interpolate<'a> {
    pub(super) points: &'a [(Vec3, Vec3); LANES],
    pub(super) candidates: &'a [u32],
    pub(super) records: &'a IrradianceRecords,
    pub(super) values: &'a [LinearIrradiance],
    /// Of each candidate; empty if nothing is known.
    pub(super) sight: &'a [Sight],
}

impl WithSimd for Interpolate<'_> {
    type Output = Interpolated;

    #[inline(always)]
    fn with_simd<S: Simd>(self) -> Interpolated {
        let mut sums = WeightedSums::new(self.points, self.records.normal_weight());
        let mut doubts = Vec::new();
        for (place, &index) in self.candidates.iter().enumerate() {
            let index = index as usize;
            let sight = self.sight.get(place).copied().unwrap_or_default();
            let doubtful = sums.add(&self.records[index], &self.values[index], sight);
            if doubtful != 0 {
                doubts.push((place, doubtful));
            }
        }
        Interpolated {
            values: sums.means(),
            doubts,
        }
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
    /// The largest radius of records that count.
    max_radius: Lanes,
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
            max_radius: [f32::INFINITY; LANES],
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

    /// Adds a record's value, with its [`IrradianceRecord::weight`], at points that see it. Returns the mask of points where
    /// that [is doubtful](IrradianceRecord::is_doubtful) and was not asked.
    #[inline(always)]
    fn add(&mut self, record: &IrradianceRecord, value: &LinearIrradiance, sight: Sight) -> u32 {
        if !self.may_cover(record) {
            return 0;
        }
        let [px, py, pz] = &self.position;
        let [nx, ny, nz] = &self.normal;
        let (p, n) = (record.position, record.normal);
        let scale = 1.0 / (record.radius * record.radius);
        let sure = SURE_HEIGHT * record.radius;
        let sure = if record.is_obstructed {
            -1.0
        } else {
            sure * sure
        };
        let (mut weights, mut excess) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let (x, y, z) = (px[lane] - p.x, py[lane] - p.y, pz[lane] - p.z);
            let height = x * n.x + y * n.y + z * n.z;
            let length_squared = x * x + y * y + z * z;
            let squared = length_squared + HEIGHT_WEIGHT * height * height;
            let cos = nx[lane] * n.x + ny[lane] * n.y + nz[lane] * n.z;
            let rest = (1.0 - (squared * scale + (1.0 - cos) * self.normal_weight)).max(0.0);
            let weight = rest * rest * scale * scale;
            let counts = record.radius <= self.max_radius[lane];
            weights[lane] = if counts { weight } else { 0.0 };
            let turned = (1.0 - cos * cos).max(0.0) * length_squared;
            let turned = if record.is_obstructed { 0.0 } else { turned };
            excess[lane] = height * height - (sure + turned);
        }
        if sight.blocked != 0 {
            for (lane, weight) in weights.iter_mut().enumerate() {
                *weight = if sight.blocked >> lane & 1 == 1 {
                    0.0
                } else {
                    *weight
                };
            }
        }
        if all_zero(&weights) {
            return 0;
        }
        let mut doubtful = 0;
        for lane in 0..LANES {
            doubtful |= u32::from(weights[lane] > 0.0 && excess[lane] > 0.0) << lane;
        }
        let limit = MAX_RADIUS_RATIO * record.radius;
        for (max_radius, weight) in self.max_radius.iter_mut().zip(weights) {
            *max_radius = if weight > 0.0 {
                max_radius.min(limit)
            } else {
                *max_radius
            };
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
        doubtful & !sight.asked
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
    use super::*;
    use crate::sampling::Random;
    use crate::simd::Kernel;

    fn record(random: &mut Random, size: f32, is_obstructed: bool) -> IrradianceRecord {
        let position = random.vector(size);
        IrradianceRecord {
            position,
            normal: random.vector(1.0).normalize(),
            radius: 0.2 + random.unit(),
            eye: position,
            is_obstructed,
        }
    }

    /// Lanes agree with the records evaluated one by one, where some points do not see some records.
    #[test]
    fn lanes_agree_with_records_one_by_one() {
        let mut random = Random::new(2);
        let points = [(); LANES].map(|()| (random.vector(1.0), random.vector(1.0).normalize()));
        let normal_weight = 0.7;
        let mut lanes = WeightedSums::new(&points, normal_weight);
        let mut sums = [(Vec3::ZERO, 0.0, f32::INFINITY); LANES];
        let mut records: Vec<IrradianceRecord> = (0..400)
            .map(|index| record(&mut random, 1.0, index % 5 == 0))
            .collect();
        records.sort_by(|a, b| a.radius.total_cmp(&b.radius));
        for (index, record) in records.iter().enumerate() {
            let value = LinearIrradiance {
                mean_radiance: random.vector(1.0) + 1.0,
                gradient: [0, 1, 2].map(|_| random.vector(0.3)),
            };
            let sight = Sight {
                asked: 0xff,
                blocked: if index % 3 == 0 { 0x3 } else { 0 },
            };
            let doubtful = lanes.add(record, &value, sight);
            for (lane, ((position, normal), (sum, weights, limit))) in
                points.iter().zip(&mut sums).enumerate()
            {
                let weight = record.weight(*position, *normal, normal_weight);
                let is_blocked = sight.blocked >> lane & 1 == 1;
                if weight == 0.0 || is_blocked || record.radius > *limit {
                    assert_eq!(doubtful >> lane & 1, 0);
                    continue;
                }
                let is_doubtful = record.is_doubtful(*position, *normal) && lane >= 8;
                assert_eq!(doubtful >> lane & 1 == 1, is_doubtful);
                *limit = limit.min(MAX_RADIUS_RATIO * record.radius);
                *sum += weight * value.at(*position - record.position);
                *weights += weight;
            }
        }
        let mut covered = 0;
        for (value, (sum, weights, _)) in lanes.means().into_iter().zip(sums) {
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
        let list = (0..500).map(|index| record(&mut random, 1.0, index % 3 == 0));
        let (records, _) = IrradianceRecords::new(bounds, 0.6, list.collect());
        let mut value = || LinearIrradiance {
            mean_radiance: random.vector(1.0),
            gradient: [0, 1, 2].map(|_| random.vector(1.0)),
        };
        let values: Vec<LinearIrradiance> = (0..500).map(|_| value()).collect();
        let candidates: Vec<u32> = (0..500).collect();
        let mut covered = 0;
        for _ in 0..50 {
            let points = [(); LANES].map(|()| {
                let position = 0.2 * random.vector(1.0);
                (position, random.vector(1.0).normalize())
            });
            let of_kernel = |kernel: Kernel| {
                let interpolated = kernel.run(Interpolate {
                    points: &points,
                    candidates: &candidates,
                    records: &records,
                    values: &values,
                    sight: &[],
                });
                let bits = |value: Vec3| value.to_array().map(f32::to_bits);
                let values = interpolated.values.map(|value| value.map(bits));
                (values, interpolated.doubts)
            };
            let portable = of_kernel(Kernel::PORTABLE);
            for kernel in Kernel::available() {
                assert_eq!(of_kernel(kernel), portable, "{kernel}");
            }
            covered += portable.0.iter().flatten().count();
        }
        assert!(covered > 50 * LANES / 2, "{covered}");
    }
}
