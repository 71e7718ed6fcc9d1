//! Interpolation between records at a packet of points: Shepard's method with weights of compact support, in lanes.

use super::irradiance_gradient::LinearIrradiance;
use super::record::{HEIGHT_WEIGHT, IrradianceRecord, MAX_RADIUS_RATIO, SURE_HEIGHT};
use super::records::IrradianceRecords;
use crate::math::Aabb;
use crate::simd::{Floats, PACKET_WIDTH, SetBits, Simd, WithSimd};
use glam::Vec3;

/// Points that are looked up together.
pub(super) const LANES: usize = PACKET_WIDTH;

/// So many candidates ahead are asked for from memory.
const AHEAD: usize = 4;

/// What is known of a candidate record: masks of points.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sight {
    /// Whether they see the record was asked.
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
        let angle_weight = self.records.angle_weight();
        let mut sums = WeightedSums::<S::F32x16>::new(self.points, angle_weight);
        let mut doubts = Vec::new();
        for (place, &index) in self.candidates.iter().enumerate() {
            if let Some(&ahead) = self.candidates.get(place + AHEAD) {
                S::prefetch(&self.records[ahead as usize]);
                S::prefetch(&self.values[ahead as usize]);
            }
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

/// Points, as structure of arrays, and the weighted sums of values there.
struct WeightedSums<F> {
    position: [F; 3],
    normal: [F; 3],
    angle_weight: F,
    /// Bounding sphere of the points.
    center: Vec3,
    bounding_radius: f32,
    /// The largest radius of records that count.
    max_radius: F,
    sums: [F; 3],
    weights: F,
}

impl<F: Floats<LANES>> WeightedSums<F> {
    #[inline(always)]
    fn new(points: &[(Vec3, Vec3); LANES], angle_weight: f32) -> WeightedSums<F> {
        let (mut position, mut normal) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for (lane, (p, n)) in points.iter().enumerate() {
            for axis in 0..3 {
                position[axis][lane] = p[axis];
                normal[axis][lane] = n[axis];
            }
        }
        let bounds = Aabb::of(points.iter().map(|(position, _)| *position));
        let zero = F::splat(0.0);
        WeightedSums {
            position: position.map(|lanes| F::load(&lanes)),
            normal: normal.map(|lanes| F::load(&lanes)),
            angle_weight: F::splat(angle_weight),
            center: bounds.center(),
            bounding_radius: 0.5 * bounds.extent().length(),
            max_radius: F::splat(f32::INFINITY),
            sums: [zero; 3],
            weights: zero,
        }
    }

    /// Whether a record may cover any of the points.
    #[inline(always)]
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
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let scale = F::splat(1.0 / (record.radius * record.radius));
        let normal = record.normal.to_array().map(F::splat);
        let mut offset = self.position;
        for (offset, position) in offset.iter_mut().zip(record.position.to_array()) {
            *offset = offset.sub(F::splat(position));
        }
        let height = dot(&offset, &normal);
        let length_squared = dot(&offset, &offset);
        let cos = dot(&self.normal, &normal);
        let height_squared = height.mul(height);
        let squared = length_squared.add(F::splat(HEIGHT_WEIGHT).mul(height_squared));
        let turned = one.sub(cos).mul(self.angle_weight);
        let rest = one.sub(squared.mul(scale).add(turned)).max(zero);
        let weight = rest.mul(rest).mul(scale.mul(scale));
        let mut weight = F::splat(record.radius).select_le(self.max_radius, weight, zero);
        if sight.blocked != 0 {
            let mut lanes = weight.store();
            SetBits(sight.blocked).for_each(|lane| lanes[lane] = 0.0);
            weight = F::load(&lanes);
        }
        let covered = zero.lt(weight);
        if covered == 0 {
            return 0;
        }
        let sure = SURE_HEIGHT * record.radius;
        let turned = one.sub(cos.mul(cos)).max(zero).mul(length_squared);
        let above = height_squared.sub(F::splat(sure * sure).add(turned));
        let beyond = length_squared.sub(F::splat(record.free_radius * record.free_radius));
        let doubtful = covered & zero.lt(above.max(beyond));
        let limit = F::splat(MAX_RADIUS_RATIO * record.radius);
        self.max_radius = weight.select_le(zero, self.max_radius, self.max_radius.min(limit));
        self.weights = self.weights.add(weight);
        for (channel, sum) in self.sums.iter_mut().enumerate() {
            let gradient = value.gradient[channel].to_array().map(F::splat);
            let value = F::splat(value.mean_radiance[channel]).add(dot(&offset, &gradient));
            *sum = sum.add(weight.mul(value));
        }
        doubtful & !sight.asked
    }

    #[inline(always)]
    fn means(&self) -> [Option<Vec3>; LANES] {
        let zero = F::splat(0.0);
        let mean = |sum: F| sum.div(self.weights).max(zero).store();
        let [red, green, blue] = self.sums.map(mean);
        let mut values = [None; LANES];
        for lane in SetBits(zero.lt(self.weights)) {
            values[lane] = Some(Vec3::new(red[lane], green[lane], blue[lane]));
        }
        values
    }
}

#[inline(always)]
fn dot<F: Floats<LANES>>(a: &[F; 3], b: &[F; 3]) -> F {
    let [x, y, z] = [0, 1, 2].map(|axis| a[axis].mul(b[axis]));
    x.add(y).add(z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;
    use crate::simd::{Kernel, PortableFloats};

    fn record(random: &mut Random, size: f32, free_radius: f32) -> IrradianceRecord {
        let position = random.vector(size);
        IrradianceRecord {
            position,
            normal: random.vector(1.0).normalize(),
            radius: 0.2 + random.unit(),
            eye: position,
            free_radius,
        }
    }

    /// Lanes agree with the records evaluated one by one, where some points do not see some records.
    #[test]
    fn lanes_agree_with_records_one_by_one() {
        let mut random = Random::new(2);
        let points = [(); LANES].map(|()| (random.vector(1.0), random.vector(1.0).normalize()));
        let angle_weight = 0.7;
        let mut lanes = WeightedSums::<PortableFloats<LANES>>::new(&points, angle_weight);
        let mut sums = [(Vec3::ZERO, 0.0, f32::INFINITY); LANES];
        let mut records: Vec<IrradianceRecord> = (0..400)
            .map(|index| record(&mut random, 1.0, 0.1 * (index % 20) as f32))
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
                let weight = record.weight(*position, *normal, angle_weight);
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
        let list = (0..500).map(|index| record(&mut random, 1.0, 0.3 * (index % 9) as f32));
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
