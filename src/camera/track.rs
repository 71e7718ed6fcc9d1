use super::keyframe::{Segment, Shape};
use super::value::{Value, weights};

/// A value that changes from key to key: in each segment a cubic curve, and the pace at which it is walked.
///
/// Smooth segments are centripetal Catmull-Rom curves (Yuksel, Schaefer and Keyser 2011), which have no cusp or
/// loop, at a pace that rises monotonely (Fritsch and Butland 1984). Both together never move backward along the
/// line between two keys: at a key the curve goes between the directions of the lines before and behind, and no
/// faster than three times the way to either key by the share of the segment, as monotone cubics may.
///
/// Where smooth segments meet, the derivative by time is continuous. Beside a segment that is given, a smooth one
/// takes over its direction and its speed as far as it can without moving backward.
#[derive(Clone, Debug)]
pub(super) struct Track<T: Value> {
    keys: Vec<T>,
    pieces: Vec<Piece<T>>,
}

/// A segment, from its key on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece<T: Value> {
    start: T,
    step: T::Step,
    /// Derivatives by the share of the curve at its ends.
    derivatives: [T::Step; 2],
    /// Derivatives of the share of the curve by the share of the segment's time at its ends.
    rates: [f64; 2],
}

/// A segment between its keys, before its curve is known.
struct Span<T: Value> {
    segment: Segment<T::Step>,
    step: T::Step,
    /// The square root of its length: what a smooth curve's parameter rises by.
    knot: f64,
    seconds: f64,
}

impl<T: Value> Track<T> {
    /// `times` rise strictly; there are as many keys, at least one, and a segment between each two. A
    /// closed track goes on at its first key where it ends, at its last.
    pub(super) fn new(
        times: &[f64],
        keys: Vec<T>,
        segments: &[Segment<T::Step>],
        closed: bool,
    ) -> Track<T> {
        let ends = times.windows(2).zip(keys.windows(2));
        let spans: Vec<Span<T>> = ends
            .zip(segments)
            .map(|((time, key), &segment)| {
                let step = key[0].step_to(key[1]);
                Span {
                    segment,
                    step,
                    knot: T::length(step).sqrt(),
                    seconds: time[1] - time[0],
                }
            })
            .collect();
        let last = spans.len().wrapping_sub(1);
        let piece = |(i, span): (usize, &Span<T>)| {
            let before = match i {
                0 => closed.then(|| &spans[last]),
                _ => Some(&spans[i - 1]),
            };
            let after = match i == last {
                true => closed.then(|| &spans[0]),
                false => Some(&spans[i + 1]),
            };
            Piece::new(keys[i], before, span, after)
        };
        let pieces = spans.iter().enumerate().map(piece).collect();
        Track { keys, pieces }
    }

    /// The value at a place among the keys.
    pub(super) fn at(&self, place: Place) -> T {
        match place {
            Place::Key(key) => self.keys[key],
            Place::Between(i, share) => self.pieces[i].at(share),
        }
    }

    /// Its segments.
    pub(super) fn pieces(&self) -> &[Piece<T>] {
        &self.pieces
    }
}

impl<T: Value> Span<T> {
    /// The derivative by the curve's share that it has at one of its ends, whatever is beside it; none if that
    /// depends.
    fn derivative(&self, end: usize) -> Option<T::Step> {
        match self.segment.shape {
            Shape::Hold => Some(self.step * 0.0),
            Shape::Linear => Some(self.step),
            Shape::Cubic(start, arrival) => Some([start, arrival][end]),
            Shape::CatmullRom => None,
        }
    }

    /// The direction of a smooth curve at an end, as a derivative by its knots.
    fn tangent(&self, end: usize, beside: Option<&Span<T>>) -> T::Step {
        let none = self.step * 0.0;
        let along = if self.knot > 0.0 {
            self.step * (1.0 / self.knot)
        } else {
            none
        };
        let Some(beside) = beside.filter(|beside| !beside.is_still()) else {
            return along;
        };
        match beside.derivative(1 - end) {
            // Of the parabola through the key and its neighbours, which is what Catmull and Rom's construction
            // gives for uneven knots.
            None => {
                let (a, b) = (self.knot, beside.knot);
                (beside.step * (a / b) + self.step * (b / a)) * (1.0 / (a + b))
            }
            Some(given) => {
                let length = T::length(given);
                if T::dot(given, self.step) <= 0.0 {
                    return none;
                }
                given * (self.knot / length)
            }
        }
    }

    /// How fast a smooth curve's knots are passed at an end, per second.
    fn rate(&self, end: usize, tangent: T::Step, beside: Option<&Span<T>>) -> f64 {
        let own = self.knot / self.seconds;
        let Some(beside) = beside.filter(|beside| !matches!(beside.segment.shape, Shape::Hold))
        else {
            return own;
        };
        if beside.is_eased(1 - end) {
            return 0.0;
        }
        match beside.derivative(1 - end) {
            None => {
                let other = beside.knot / beside.seconds;
                // Of a segment without length or time there may be none.
                if !(own > 0.0 && other > 0.0) {
                    return 0.0;
                }
                // The harmonic mean, weighted so that the longer of both segments counts less.
                let (own_weight, other_weight) = (
                    self.seconds + 2.0 * beside.seconds,
                    2.0 * self.seconds + beside.seconds,
                );
                (own_weight + other_weight) / (own_weight / own + other_weight / other)
            }
            Some(given) => {
                let rate = T::length(given) / (beside.seconds * T::length(tangent));
                // A cubic may rise three times as fast at its end as all in all, and still is monotone.
                if rate.is_nan() {
                    0.0
                } else {
                    rate.min(3.0 * own)
                }
            }
        }
    }

    /// Whether it starts from rest, or comes to rest.
    fn is_eased(&self, end: usize) -> bool {
        [self.segment.ease_in, self.segment.ease_out][end]
    }

    fn is_still(&self) -> bool {
        match self.segment.shape {
            Shape::Hold => true,
            // It may lead back to where it starts.
            Shape::Cubic(..) => false,
            Shape::Linear | Shape::CatmullRom => self.knot == 0.0,
        }
    }
}

impl<T: Value> Piece<T> {
    fn new(
        start: T,
        before: Option<&Span<T>>,
        span: &Span<T>,
        after: Option<&Span<T>>,
    ) -> Piece<T> {
        let beside = [before, after];
        let end = |end: usize| {
            let eased = span.is_eased(end);
            let (derivative, rate) = match span.derivative(end) {
                Some(derivative) => (derivative, 1.0),
                None if span.knot == 0.0 => (span.step, 1.0),
                None => {
                    let tangent = span.tangent(end, beside[end]);
                    let rate = span.rate(end, tangent, beside[end]);
                    (tangent * span.knot, rate * span.seconds / span.knot)
                }
            };
            (derivative, if eased { 0.0 } else { rate })
        };
        let [(start_derivative, start_rate), (end_derivative, end_rate)] = [end(0), end(1)];
        let is_held = matches!(span.segment.shape, Shape::Hold);
        Piece {
            start,
            step: if is_held { span.step * 0.0 } else { span.step },
            derivatives: [start_derivative, end_derivative],
            rates: [start_rate, end_rate],
        }
    }

    /// The value at a share of the segment's time.
    fn at(&self, share: f64) -> T {
        let [whole, start, end] = weights(share);
        self.at_share_of_curve(whole + self.rates[0] * start + self.rates[1] * end)
    }

    /// The value at a share of the curve.
    pub(super) fn at_share_of_curve(&self, share: f64) -> T {
        self.start
            .cubic(self.step, self.derivatives[0], self.derivatives[1], share)
    }

    /// How fast the value changes by the share of the curve: the length of the derivative of a cubic in a flat space.
    pub(super) fn speed(&self, share: f64) -> f64 {
        let (s, t) = (share, 1.0 - share);
        let derivative = self.step * (6.0 * s * t)
            + (self.derivatives[0] * (t * (1.0 - 3.0 * s))
                + self.derivatives[1] * (s * (3.0 * s - 2.0)));
        T::length(derivative)
    }
}

/// Where a time lies among keys.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// On a key, or beyond the end that the key is.
    Key(usize),
    /// After a key, at a share in (0, 1) of the time to the next.
    Between(usize, f64),
}

impl Place {
    /// `times` rise; there is at least one.
    pub(super) fn of(times: &[f64], time: f64) -> Place {
        let after = times.partition_point(|&t| t <= time);
        if after == 0 {
            return Place::Key(0);
        }
        let i = after - 1;
        if after == times.len() || times[i] == time {
            return Place::Key(i);
        }
        Place::Between(i, (time - times[i]) / (times[after] - times[i]))
    }
}
