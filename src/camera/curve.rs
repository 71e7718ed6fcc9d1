//! Cubic curves through keys.

use std::ops::{Add, Mul, Sub};

/// What can be interpolated: a vector space over the reals.
pub(super) trait Value:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
    /// The distance from zero.
    fn length(self) -> f64;
}

impl Value for f64 {
    fn length(self) -> f64 {
        self.abs()
    }
}

impl Value for glam::DVec3 {
    fn length(self) -> f64 {
        glam::DVec3::length(self)
    }
}

/// A smooth curve through points at given times: the centripetal Catmull-Rom curve (Yuksel,
/// Schaefer and Keyser 2011), which has no cusp or loop within a segment, walked by a time map
/// that never runs backward. Velocity is continuous at the keys.
#[derive(Clone, Debug)]
pub(super) struct SmoothCurve<T> {
    times: Vec<f64>,
    points: Vec<T>,
    /// The curve parameter at each key: sums of the square roots of the chords.
    knots: Vec<f64>,
    /// Derivative of the curve by its parameter at each key.
    tangents: Vec<T>,
    /// Derivative of the parameter by time at each key.
    speeds: Vec<f64>,
}

impl<T: Value> SmoothCurve<T> {
    /// `times` ascend strictly; there are as many points, at least one.
    pub(super) fn new(times: Vec<f64>, points: Vec<T>) -> SmoothCurve<T> {
        let chords: Vec<f64> = points
            .windows(2)
            .map(|p| (p[1] - p[0]).length().sqrt())
            .collect();
        let mut knots = vec![0.0];
        for chord in &chords {
            knots.push(knots[knots.len() - 1] + chord);
        }
        let slopes: Vec<T> = points
            .windows(2)
            .zip(&chords)
            .map(|(p, &chord)| match chord {
                0.0 => (p[1] - p[0]) * 0.0,
                _ => (p[1] - p[0]) * (1.0 / chord),
            })
            .collect();
        SmoothCurve {
            tangents: tangents(&points, &chords, &slopes),
            speeds: monotone_slopes(&times, &knots),
            times,
            points,
            knots,
        }
    }

    /// The point at a time; times before the first key and after the last give those.
    pub(super) fn at(&self, time: f64) -> T {
        let (segment, s) = match find_segment(&self.times, time) {
            Segment::Key(key) => return self.points[key],
            Segment::Between(segment, s) => (segment, s),
        };
        let (i, j) = (segment, segment + 1);
        let span = self.times[j] - self.times[i];
        let knot = hermite(
            s,
            self.knots[i],
            self.speeds[i] * span,
            self.knots[j],
            self.speeds[j] * span,
        );
        let chord = self.knots[j] - self.knots[i];
        if chord == 0.0 {
            return self.points[i];
        }
        hermite(
            (knot - self.knots[i]) / chord,
            self.points[i],
            self.tangents[i] * chord,
            self.points[j],
            self.tangents[j] * chord,
        )
    }
}

/// Derivatives at the keys: of the parabola through a key and its neighbours, which is what
/// Catmull-Rom's construction gives for uneven knots; at the ends of the chord.
fn tangents<T: Value>(points: &[T], chords: &[f64], slopes: &[T]) -> Vec<T> {
    let zero = points[0] * 0.0;
    (0..points.len())
        .map(|i| {
            let before = i.checked_sub(1).map(|k| (chords[k], slopes[k]));
            let after = slopes.get(i).map(|&slope| (chords[i], slope));
            match (before, after) {
                (Some((h0, d0)), Some((h1, d1))) if h0 > 0.0 && h1 > 0.0 => {
                    (d0 * h1 + d1 * h0) * (1.0 / (h0 + h1))
                }
                (Some((_, d)), None) | (None, Some((_, d))) => d,
                // A camera that rests on one side of a key stops there.
                _ => zero,
            }
        })
        .collect()
}

/// Slopes for a cubic through (x, y) that rises wherever y does and is flat where y is: Fritsch and
/// Butland 1984's weighted harmonic mean, one-sided at the ends.
fn monotone_slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let d: Vec<f64> = y
        .windows(2)
        .zip(&h)
        .map(|(w, h)| (w[1] - w[0]) / h)
        .collect();
    (0..x.len())
        .map(|i| match (i.checked_sub(1), i < d.len()) {
            (Some(k), true) if d[k] == 0.0 || d[i] == 0.0 => 0.0 * d[k],
            (Some(k), true) => {
                let (w0, w1) = (2.0 * h[i] + h[k], h[i] + 2.0 * h[k]);
                (w0 + w1) / (w0 / d[k] + w1 / d[i])
            }
            (Some(k), false) => d[k],
            (None, true) => d[i],
            (None, false) => 0.0,
        })
        .collect()
}

/// The cubic with values a, b and derivatives da, db at s = 0 and 1.
fn hermite<T: Value>(s: f64, a: T, da: T, b: T, db: T) -> T {
    let t = 1.0 - s;
    a * (t * t * (1.0 + 2.0 * s))
        + da * (s * t * t)
        + b * (s * s * (3.0 - 2.0 * s))
        + db * (-s * s * t)
}

/// Where a time lies among keys.
pub(super) enum Segment {
    /// On a key, or beyond the end that the key is.
    Key(usize),
    /// After a key, at a fraction in (0, 1) of the way to the next.
    Between(usize, f64),
}

/// `times` ascend strictly; there is at least one.
pub(super) fn find_segment(times: &[f64], time: f64) -> Segment {
    let after = times.partition_point(|&t| t <= time);
    if after == 0 {
        return Segment::Key(0);
    }
    let i = after - 1;
    if after == times.len() || times[i] == time {
        return Segment::Key(i);
    }
    Segment::Between(i, (time - times[i]) / (times[after] - times[i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn uneven() -> SmoothCurve<DVec3> {
        let points = [
            (0.0, 0.0),
            (0.4, 0.1),
            (5.0, 0.5),
            (5.2, 2.0),
            (4.0, 2.5),
            (0.0, 3.0),
        ];
        SmoothCurve::new(
            vec![0.0, 1.0, 1.5, 4.0, 4.1, 7.0],
            points.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
        )
    }

    #[test]
    fn passes_through_every_key_and_holds_beyond_the_ends() {
        let curve = uneven();
        for (time, point) in curve.times.iter().zip(&curve.points) {
            assert_eq!(curve.at(*time), *point);
        }
        assert_eq!(curve.at(-1.0), curve.points[0]);
        assert_eq!(curve.at(99.0), curve.points[5]);
    }

    #[test]
    fn velocity_is_continuous_at_keys() {
        let curve = uneven();
        let h = 1e-6;
        for &time in &curve.times[1..5] {
            let before = (curve.at(time) - curve.at(time - h)) * (1.0 / h);
            let after = (curve.at(time + h) - curve.at(time)) * (1.0 / h);
            assert!((before - after).length() < 1e-3 * before.length(), "{time}");
        }
    }

    #[test]
    fn no_frame_runs_backward() {
        let curve = uneven();
        let parameter = |time: f64| {
            // Progress along the chord of the segment that the time is in.
            match find_segment(&curve.times, time) {
                Segment::Key(k) => k as f64,
                Segment::Between(i, _) => {
                    let chord = curve.points[i + 1] - curve.points[i];
                    let done = (curve.at(time) - curve.points[i]).dot(chord);
                    i as f64 + done / chord.length_squared()
                }
            }
        };
        let steps = (0..=700).map(|i| parameter(f64::from(i) * 0.01));
        let steps: Vec<f64> = steps.collect();
        assert!(steps.windows(2).all(|w| w[1] > w[0]));
    }

    #[test]
    fn a_straight_line_with_even_keys_is_uniform() {
        let points = (0..5).map(|i| f64::from(i) * 3.0).collect();
        let curve = SmoothCurve::new((0..5).map(f64::from).collect(), points);
        for i in 0..=40 {
            let time = f64::from(i) * 0.1;
            assert!((curve.at(time) - 3.0 * time).abs() < 1e-12);
        }
    }

    #[test]
    fn a_repeated_key_is_a_rest() {
        let curve = SmoothCurve::new(vec![0.0, 1.0, 2.0, 3.0], vec![0.0, 1.0, 1.0, 5.0]);
        for i in 0..=10 {
            assert_eq!(curve.at(1.0 + f64::from(i) * 0.1), 1.0);
        }
        assert!(curve.at(2.5) > 1.0 && curve.at(0.9) < 1.0);
    }
}
