//! Interpolation of a value from key to key: centripetal Catmull-Rom curves (Yuksel, Schaefer and Keyser 2011) with
//! monotone timing (Fritsch and Butland 1984), beside linear, cubic Hermite and held segments.

use super::hermite::{Interpolable, hermite_basis};
use super::keyframe::{Interpolation, Segment};

/// A value that changes from key to key: each segment is a cubic curve and a cubic timing along it.
///
/// Smooth segments are centripetal Catmull-Rom curves, which have no cusp or loop, with a monotone timing. Both
/// together never move backward along the chord between two keys: at a key the tangent lies between the directions
/// of the two chords, and its length is at most three times the chord, which keeps the cubic monotone.
///
/// Where smooth segments meet, the derivative by time is continuous. Beside a segment whose tangents are given, a
/// smooth one takes over the direction and the speed as far as it can without moving backward.
#[derive(Clone, Debug)]
pub(super) struct Track<T: Interpolable> {
    keys: Vec<T>,
    segments: Vec<CurveSegment<T>>,
}

/// The curve from a key to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurveSegment<T: Interpolable> {
    start: T,
    step: T::Tangent,
    /// Derivatives by the curve parameter, from 0 to 1, at its ends.
    derivatives: [T::Tangent; 2],
    /// Derivatives of the curve parameter by the fraction of the segment's time at its ends.
    rates: [f64; 2],
}

/// What the curve of a segment is made from.
struct SegmentInput<T: Interpolable> {
    segment: Segment<T::Tangent>,
    step: T::Tangent,
    /// The centripetal knot interval: the square root of the length of the chord.
    knot: f64,
    seconds: f64,
}

/// Times and segments that all tracks of a path share.
pub(super) struct TrackInput<'a> {
    pub(super) times: &'a [f64],
    pub(super) segments: &'a [Segment],
    pub(super) closed: bool,
}

impl TrackInput<'_> {
    /// A track of any value but the position through the values of the keys.
    pub(super) fn through<T: Interpolable>(&self, keys: impl Iterator<Item = T>) -> Track<T> {
        let segments: Vec<Segment<T::Tangent>> = self
            .segments
            .iter()
            .map(Segment::without_tangents)
            .collect();
        Track::new(self.times, keys.collect(), &segments, self.closed)
    }
}

impl<T: Interpolable> Track<T> {
    /// `times` rise strictly; there are as many keys, at least one, and a segment between each two. A
    /// closed track continues at its first key after its last.
    pub(super) fn new(
        times: &[f64],
        keys: Vec<T>,
        segments: &[Segment<T::Tangent>],
        closed: bool,
    ) -> Track<T> {
        let ends = times.windows(2).zip(keys.windows(2));
        let inputs: Vec<SegmentInput<T>> = ends
            .zip(segments)
            .map(|((time, key), &segment)| {
                let step = key[0].step_to(key[1]);
                SegmentInput {
                    segment,
                    step,
                    knot: T::length(step).sqrt(),
                    seconds: time[1] - time[0],
                }
            })
            .collect();
        let last = inputs.len().wrapping_sub(1);
        let segment = |(i, input): (usize, &SegmentInput<T>)| {
            let before = match i {
                0 => closed.then(|| &inputs[last]),
                _ => Some(&inputs[i - 1]),
            };
            let after = match i == last {
                true => closed.then(|| &inputs[0]),
                false => Some(&inputs[i + 1]),
            };
            CurveSegment::new(keys[i], before, input, after)
        };
        let segments = inputs.iter().enumerate().map(segment).collect();
        Track { keys, segments }
    }

    /// The value at a time.
    pub(super) fn at(&self, time: TrackTime) -> T {
        match time {
            TrackTime::AtKey(key) => self.keys[key],
            TrackTime::InSegment(i, fraction) => self.segments[i].at(fraction),
        }
    }

    /// Its segments, one between each two keys.
    pub(super) fn segments(&self) -> &[CurveSegment<T>] {
        &self.segments
    }
}

impl<T: Interpolable> SegmentInput<T> {
    /// The derivative by the curve parameter at one of its ends; none if it depends on the neighbour.
    fn derivative(&self, end: usize) -> Option<T::Tangent> {
        match self.segment.interpolation {
            Interpolation::Hold => Some(self.step * 0.0),
            Interpolation::Linear => Some(self.step),
            Interpolation::Hermite(start, arrival) => Some([start, arrival][end]),
            Interpolation::CatmullRom => None,
        }
    }

    /// The tangent of a smooth curve at an end, as a derivative by its knots.
    fn tangent(&self, end: usize, neighbour: Option<&SegmentInput<T>>) -> T::Tangent {
        let zero = self.step * 0.0;
        let along = if self.knot > 0.0 {
            self.step * (1.0 / self.knot)
        } else {
            zero
        };
        let Some(neighbour) = neighbour.filter(|neighbour| !neighbour.is_still()) else {
            return along;
        };
        match neighbour.derivative(1 - end) {
            // The derivative of the parabola through the key and its neighbours, which is Catmull and Rom's
            // construction for uneven knots.
            None => {
                let (a, b) = (self.knot, neighbour.knot);
                (neighbour.step * (a / b) + self.step * (b / a)) * (1.0 / (a + b))
            }
            Some(given) => {
                let length = T::length(given);
                if T::dot(given, self.step) <= 0.0 {
                    return zero;
                }
                given * (self.knot / length)
            }
        }
    }

    /// The derivative of a smooth curve's knots by time at an end, per second.
    fn rate(&self, end: usize, tangent: T::Tangent, neighbour: Option<&SegmentInput<T>>) -> f64 {
        let own = self.knot / self.seconds;
        let Some(neighbour) = neighbour
            .filter(|neighbour| !matches!(neighbour.segment.interpolation, Interpolation::Hold))
        else {
            return own;
        };
        if neighbour.is_eased(1 - end) {
            return 0.0;
        }
        match neighbour.derivative(1 - end) {
            None => {
                let other = neighbour.knot / neighbour.seconds;
                // A segment without length or time has no rate.
                if !(own > 0.0 && other > 0.0) {
                    return 0.0;
                }
                // The harmonic mean, weighted so that the longer of both segments counts less.
                let (own_weight, other_weight) = (
                    self.seconds + 2.0 * neighbour.seconds,
                    2.0 * self.seconds + neighbour.seconds,
                );
                (own_weight + other_weight) / (own_weight / own + other_weight / other)
            }
            Some(given) => {
                let rate = T::length(given) / (neighbour.seconds * T::length(tangent));
                // A cubic is monotone if its end slopes are at most three times its mean slope.
                if rate.is_nan() {
                    0.0
                } else {
                    rate.min(3.0 * own)
                }
            }
        }
    }

    /// Whether it starts from rest (end 0) or comes to rest (end 1).
    fn is_eased(&self, end: usize) -> bool {
        [self.segment.ease_in, self.segment.ease_out][end]
    }

    fn is_still(&self) -> bool {
        match self.segment.interpolation {
            Interpolation::Hold => true,
            // A loop may end where it starts.
            Interpolation::Hermite(..) => false,
            Interpolation::Linear | Interpolation::CatmullRom => self.knot == 0.0,
        }
    }
}

impl<T: Interpolable> CurveSegment<T> {
    fn new(
        start: T,
        before: Option<&SegmentInput<T>>,
        input: &SegmentInput<T>,
        after: Option<&SegmentInput<T>>,
    ) -> CurveSegment<T> {
        let neighbours = [before, after];
        let end = |end: usize| {
            let eased = input.is_eased(end);
            let (derivative, rate) = match input.derivative(end) {
                Some(derivative) => (derivative, 1.0),
                None if input.knot == 0.0 => (input.step, 1.0),
                None => {
                    let tangent = input.tangent(end, neighbours[end]);
                    let rate = input.rate(end, tangent, neighbours[end]);
                    (tangent * input.knot, rate * input.seconds / input.knot)
                }
            };
            (derivative, if eased { 0.0 } else { rate })
        };
        let [(start_derivative, start_rate), (end_derivative, end_rate)] = [end(0), end(1)];
        let is_held = matches!(input.segment.interpolation, Interpolation::Hold);
        CurveSegment {
            start,
            step: if is_held {
                input.step * 0.0
            } else {
                input.step
            },
            derivatives: [start_derivative, end_derivative],
            rates: [start_rate, end_rate],
        }
    }

    /// The value at a fraction of the segment's time.
    fn at(&self, fraction: f64) -> T {
        let [whole, start, end] = hermite_basis(fraction);
        self.at_curve_parameter(whole + self.rates[0] * start + self.rates[1] * end)
    }

    /// The value at a curve parameter from 0 to 1.
    pub(super) fn at_curve_parameter(&self, s: f64) -> T {
        self.start
            .cubic(self.step, self.derivatives[0], self.derivatives[1], s)
    }

    /// The length of the derivative by the curve parameter, of a cubic in a vector space.
    pub(super) fn speed(&self, s: f64) -> f64 {
        let t = 1.0 - s;
        let derivative = self.step * (6.0 * s * t)
            + (self.derivatives[0] * (t * (1.0 - 3.0 * s))
                + self.derivatives[1] * (s * (3.0 * s - 2.0)));
        T::length(derivative)
    }
}

/// A time among keys: a key's index and a fraction of the time to the next key.
#[derive(Clone, Copy, Debug)]
pub(super) enum TrackTime {
    /// On a key, or beyond the end that the key is.
    AtKey(usize),
    /// After a key, at a fraction in (0, 1) of the time to the next.
    InSegment(usize, f64),
}

impl TrackTime {
    /// `times` rise; there is at least one.
    pub(super) fn of(times: &[f64], time: f64) -> TrackTime {
        let after = times.partition_point(|&t| t <= time);
        if after == 0 {
            return TrackTime::AtKey(0);
        }
        let i = after - 1;
        if after == times.len() || times[i] == time {
            return TrackTime::AtKey(i);
        }
        TrackTime::InSegment(i, (time - times[i]) / (times[after] - times[i]))
    }
}
