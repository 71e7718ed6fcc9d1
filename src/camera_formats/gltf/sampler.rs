//! Samplers of glTF animations (glTF 2.0 specification, section 3.11 and appendix C).

use super::buffers::GltfBuffers;
use crate::input::InputError;
use glam::{DQuat, DVec4};
use gltf::animation::Interpolation;

/// The animation of one property of a node or a camera.
#[derive(Debug)]
pub(super) struct GltfSampler {
    /// In seconds; rising, at least one.
    times: Vec<f64>,
    /// One for each time, or for cubic splines three: in-tangent, value and out-tangent.
    values: Vec<DVec4>,
    interpolation: Interpolation,
    is_rotation: bool,
}

/// Tolerance for equal values.
const SAME: f64 = 1e-6;

/// Tolerance for a time that is on a key, in seconds: times are in single precision.
fn rounding(time: f64) -> f64 {
    1e-6 + f64::from(f32::EPSILON) * time.abs()
}

impl GltfSampler {
    /// Reads a sampler whose values have `components` numbers.
    pub(super) fn read(
        sampler: &gltf::animation::Sampler,
        name: &str,
        components: usize,
        buffers: &mut GltfBuffers,
    ) -> Result<GltfSampler, InputError> {
        let times = buffers.numbers(&sampler.input(), 1, &format!("{name}.input"))?;
        let times: Vec<f64> = times.iter().map(|time| time.x).collect();
        if times.windows(2).any(|t| t[1] <= t[0]) {
            return buffers.refuse(&format!("{name}.input"), "times do not rise");
        }
        let values = buffers.numbers(&sampler.output(), components, &format!("{name}.output"))?;
        let interpolation = sampler.interpolation();
        let expected = match interpolation {
            Interpolation::CubicSpline => 3 * times.len(),
            _ => times.len(),
        };
        if values.len() != expected {
            let message = format!("has {} values in place of {expected}", values.len());
            return buffers.refuse(&format!("{name}.output"), message);
        }
        let mut sampler = GltfSampler {
            times,
            values,
            interpolation,
            is_rotation: components == 4,
        };
        if sampler.is_rotation {
            sampler.take_shorter_ways();
        }
        Ok(sampler)
    }

    /// The times of its first and its last key.
    pub(super) fn span(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }

    /// Whether there is a cut between two times, in seconds: a stepped change after the value has stood still for as
    /// long as a shot. Shorter steps are a stutter.
    pub(super) fn jumps(&self, time: f64, next: f64) -> bool {
        const SHORTEST_SHOT: f64 = 0.2;
        let [Some(here), Some(after)] = [time, next].map(|time| self.key_before(time)) else {
            return false;
        };
        let (from, to) = (self.value(here), self.value(after));
        let is_same = from.abs_diff_eq(to, SAME) || self.is_rotation && from.abs_diff_eq(-to, SAME);
        self.interpolation == Interpolation::Step
            && !is_same
            && self.times[here + 1] - self.times[here] > SHORTEST_SHOT
    }

    /// The last key that is not after a time.
    fn key_before(&self, time: f64) -> Option<usize> {
        let after = self.times.partition_point(|&t| t <= time + rounding(time));
        after.checked_sub(1)
    }

    /// The value at a time in seconds; before the first key and after the last one it is constant.
    pub(super) fn at(&self, time: f64) -> DVec4 {
        let Some(key) = self.key_before(time) else {
            return self.value(0);
        };
        let after = key + 1;
        let is_on_key = (time - self.times[key]).abs() <= rounding(time);
        if is_on_key || after == self.times.len() || self.interpolation == Interpolation::Step {
            return self.value(key);
        }
        let seconds = self.times[after] - self.times[key];
        let fraction = (time - self.times[key]) / seconds;
        let (a, b) = (self.value(key), self.value(after));
        match self.interpolation {
            Interpolation::Step => a,
            Interpolation::Linear if self.is_rotation => slerp(a, b, fraction),
            Interpolation::Linear => a.lerp(b, fraction),
            Interpolation::CubicSpline => {
                let (out_tangent, in_tangent) = (self.values[3 * key + 2], self.values[3 * after]);
                let value = hermite(a, out_tangent * seconds, b, in_tangent * seconds, fraction);
                if self.is_rotation {
                    value.normalize_or(a)
                } else {
                    value
                }
            }
        }
    }

    fn value(&self, key: usize) -> DVec4 {
        match self.interpolation {
            Interpolation::CubicSpline => self.values[3 * key + 1],
            _ => self.values[key],
        }
    }

    /// Flips the signs of quaternions and their tangents so that each cubic takes the shorter way. Blender writes
    /// either sign, and between keys of different signs the curve would pass near zero.
    fn take_shorter_ways(&mut self) {
        if self.interpolation != Interpolation::CubicSpline {
            return;
        }
        for key in 1..self.times.len() {
            let third = (self.times[key] - self.times[key - 1]) / 3.0;
            let before = 3 * (key - 1);
            // The inner control points of the Bézier curve.
            let first = self.values[before + 1] + third * self.values[before + 2];
            let second = self.values[3 * key + 1] - third * self.values[3 * key];
            if first.dot(second) < 0.0 {
                for value in &mut self.values[3 * key..3 * key + 3] {
                    *value = -*value;
                }
            }
        }
    }
}

fn slerp(a: DVec4, b: DVec4, s: f64) -> DVec4 {
    let [a, b] = [a, b].map(|v| DQuat::from_vec4(v.normalize_or(DVec4::W)));
    a.slerp(b, s).into()
}

/// The cubic with values a, b and derivatives da, db at s = 0 and 1.
fn hermite(a: DVec4, da: DVec4, b: DVec4, db: DVec4, s: f64) -> DVec4 {
    let t = 1.0 - s;
    a * (t * t * (1.0 + 2.0 * s))
        + da * (s * t * t)
        + b * (s * s * (3.0 - 2.0 * s))
        + db * (-s * s * t)
}
