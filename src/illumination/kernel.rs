//! Look-ups, compiled for each set of instructions. The lanes are the same to the last bit: nothing in them is
//! fused or reordered.
#![expect(
    unsafe_code,
    reason = "calls into code compiled for a detected processor"
)]

use super::Places;
use super::look_up::LookUp;
use super::visible::Linear;

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn add_avx512(look_up: &mut LookUp, numbers: &[u32], places: &Places, light: &[Linear]) {
    look_up.add_all(numbers, places, light);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_avx2(look_up: &mut LookUp, numbers: &[u32], places: &Places, light: &[Linear]) {
    look_up.add_all(numbers, places, light);
}

/// [`LookUp::add_all`] with the best instructions that this processor has.
#[inline]
pub(super) fn add_all(look_up: &mut LookUp, numbers: &[u32], places: &Places, light: &[Linear]) {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: the instructions were detected.
            return unsafe { add_avx512(look_up, numbers, places, light) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the instructions were detected.
            return unsafe { add_avx2(look_up, numbers, places, light) };
        }
    }
    look_up.add_all(numbers, places, light);
}

#[cfg(test)]
mod tests {
    use super::super::look_up::LANES;
    use super::super::{Place, Walls};
    use super::*;
    use crate::math::Aabb;
    use crate::sampling::Random;
    use glam::Vec3;

    /// Whatever the processor has, and plain code.
    #[test]
    fn all_instructions_agree_to_the_bit() {
        let mut random = Random::new(11);
        let bounds = Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::ONE,
        };
        let mut places = Places::new(bounds, 0.6);
        let mut light = Vec::new();
        for number in 0..500 {
            let mut walls = Walls::default();
            if number % 3 == 0 {
                walls.add(random.vector(1.0), random.vector(1.0).normalize(), 0.3);
            }
            places.push(Place {
                position: random.vector(1.0),
                normal: random.vector(1.0).normalize(),
                radius: 0.2 + random.unit(),
                walls,
            });
            light.push(Linear {
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
            let mut plain = LookUp::new(points, 2.0);
            plain.add_all(&numbers, &places, &light);
            let mut best = LookUp::new(points, 2.0);
            add_all(&mut best, &numbers, &places, &light);
            for lane in 0..LANES {
                let [a, b] = [&plain, &best].map(|of| of.light(lane));
                let bits = |light: Vec3| light.to_array().map(f32::to_bits);
                assert_eq!(a.map(bits), b.map(bits));
                known += usize::from(a.is_some());
            }
        }
        assert!(known > 50 * LANES / 2, "{known}");
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            let points = [(Vec3::ZERO, Vec3::Y); LANES];
            let [mut plain, mut vector] = [(); 2].map(|()| LookUp::new(points, 2.0));
            plain.add_all(&numbers, &places, &light);
            // SAFETY: the instructions were detected.
            unsafe { add_avx2(&mut vector, &numbers, &places, &light) };
            assert_eq!(plain.light(3), vector.light(3));
        }
    }
}
