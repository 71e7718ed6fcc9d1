use super::IrradianceRecords;
use super::primary::LinearIrradiance;
use super::record::{HEIGHT, IrradianceRecord};
use crate::math::Aabb;
use crate::simd::PACKET_WIDTH;
use glam::Vec3;

/// So many points are looked up together.
pub(super) const LANES: usize = PACKET_WIDTH;

type Lanes = [f32; LANES];

/// The mean of what the places with the numbers given say at points with unit normals; none where they say
/// nothing. Each point gets what it would get alone.
#[inline(always)]
pub(super) fn lights(
    points: &[(Vec3, Vec3); LANES],
    numbers: &[u32],
    places: &IrradianceRecords,
    light: &[LinearIrradiance],
) -> [Option<Vec3>; LANES] {
    let mut look_up = LookUp::new(points, places.turn());
    for &number in numbers {
        let number = number as usize;
        look_up.add(&places[number], &light[number]);
    }
    look_up.lights()
}

/// Points, coordinate by coordinate, and the sums of what places say there. Plain loops over lanes, which
/// become vector code; no lane knows of another.
struct LookUp {
    position: [Lanes; 3],
    normal: [Lanes; 3],
    turn: f32,
    /// The middle of the points, and how far they are from it.
    center: Vec3,
    extent: f32,
    sums: [Lanes; 3],
    weights: Lanes,
}

impl LookUp {
    #[inline(always)]
    fn new(points: &[(Vec3, Vec3); LANES], turn: f32) -> LookUp {
        let (mut position, mut normal) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for (lane, (p, n)) in points.iter().enumerate() {
            for axis in 0..3 {
                position[axis][lane] = p[axis];
                normal[axis][lane] = n[axis];
            }
        }
        let bounds = Aabb::of(points.iter().map(|(position, _)| *position));
        LookUp {
            position,
            normal,
            turn,
            center: bounds.center(),
            extent: 0.5 * bounds.extent().length(),
            sums: [[0.0; LANES]; 3],
            weights: [0.0; LANES],
        }
    }

    /// Whether a place may reach any of the points.
    #[inline]
    fn may_reach(&self, place: &IrradianceRecord) -> bool {
        const ROUNDING: f32 = 1.001;
        let reach = ROUNDING * (place.radius + self.extent);
        place.position.distance_squared(self.center) < reach * reach
    }

    /// Adds what a place says, with its [`IrradianceRecord::weight`].
    #[inline(always)]
    fn add(&mut self, place: &IrradianceRecord, light: &LinearIrradiance) {
        if !self.may_reach(place) {
            return;
        }
        let [px, py, pz] = &self.position;
        let [nx, ny, nz] = &self.normal;
        let (p, n) = (place.position, place.normal);
        let scale = 1.0 / (place.radius * place.radius);
        let mut weights = [0.0; LANES];
        for (lane, weight) in weights.iter_mut().enumerate() {
            let (x, y, z) = (px[lane] - p.x, py[lane] - p.y, pz[lane] - p.z);
            let height = x * n.x + y * n.y + z * n.z;
            let squared = x * x + y * y + z * z + HEIGHT * height * height;
            let cos = nx[lane] * n.x + ny[lane] * n.y + nz[lane] * n.z;
            let rest = (1.0 - (squared * scale + (1.0 - cos) * self.turn)).max(0.0);
            *weight = rest * rest * scale;
        }
        if is_none(&weights) {
            return;
        }
        for plane in place.walls.planes() {
            for (lane, weight) in weights.iter_mut().enumerate() {
                let before = plane.x * px[lane] + plane.y * py[lane] + plane.z * pz[lane] + plane.w;
                *weight = if before < 0.0 { 0.0 } else { *weight };
            }
        }
        for (sum, weight) in self.weights.iter_mut().zip(weights) {
            *sum += weight;
        }
        for (channel, sums) in self.sums.iter_mut().enumerate() {
            let (middle, gradient) = (light.light[channel], light.gradient[channel]);
            for (lane, sum) in sums.iter_mut().enumerate() {
                let (x, y, z) = (px[lane] - p.x, py[lane] - p.y, pz[lane] - p.z);
                let light = middle + (gradient.x * x + gradient.y * y + gradient.z * z);
                *sum += weights[lane] * light;
            }
        }
    }

    #[inline(always)]
    fn lights(&self) -> [Option<Vec3>; LANES] {
        let mut means = self.sums;
        for channel in &mut means {
            for (mean, weight) in channel.iter_mut().zip(&self.weights) {
                *mean = (*mean / weight).max(0.0);
            }
        }
        let [red, green, blue] = means;
        let mut lights = [None; LANES];
        for (lane, light) in lights.iter_mut().enumerate() {
            if self.weights[lane] > 0.0 {
                *light = Some(Vec3::new(red[lane], green[lane], blue[lane]));
            }
        }
        lights
    }
}

/// Whether no weight is above 0; none is below.
fn is_none(weights: &Lanes) -> bool {
    weights.iter().fold(0, |any, w| any | w.to_bits()) == 0
}

#[cfg(test)]
mod tests {
    use super::super::OccluderPlanes;
    use super::*;
    use crate::sampling::Random;

    /// Lanes say what one point after the other would.
    #[test]
    fn lanes_agree_with_places_one_by_one() {
        let mut random = Random::new(1);
        let mut normal = move || random.vector(1.0).normalize();
        let mut random = Random::new(2);
        let points = [(); LANES].map(|()| (random.vector(1.0), normal()));
        let turn = 0.7;
        let mut look_up = LookUp::new(&points, turn);
        let mut sums = [(Vec3::ZERO, 0.0); LANES];
        for _ in 0..400 {
            let mut walls = OccluderPlanes::default();
            if random.below(3) == 0 {
                walls.add(random.vector(1.0), normal(), 0.5);
            }
            let place = IrradianceRecord {
                position: random.vector(1.0),
                normal: normal(),
                radius: 0.1 + random.unit(),
                walls,
            };
            let light = LinearIrradiance {
                light: random.vector(1.0) + 1.0,
                gradient: [0, 1, 2].map(|_| random.vector(0.3)),
            };
            look_up.add(&place, &light);
            for ((position, normal), (sum, weights)) in points.iter().zip(&mut sums) {
                let weight = place.weight(*position, *normal, turn, 1.0);
                *sum += weight * light.at(position - place.position);
                *weights += weight;
            }
        }
        let mut known = 0;
        for (light, (sum, weights)) in look_up.lights().into_iter().zip(sums) {
            let expected = (weights > 0.0).then(|| (sum / weights).max(Vec3::ZERO));
            known += usize::from(expected.is_some());
            match (light, expected) {
                (Some(light), Some(expected)) => {
                    assert!((light - expected).length() < 1e-5, "{light} {expected}");
                }
                (light, expected) => assert_eq!(light, expected),
            }
        }
        assert!(known > LANES / 2);
    }
}
