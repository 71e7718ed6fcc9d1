//! When the camera passes its keys, and where it is between them: at the keys' own times, or at constant speed.

use super::arc_length::ArcLength;
use super::track::{Track, TrackTime};
use glam::DVec3;

/// The positions of a path and the times at which they are passed.
#[derive(Clone, Debug)]
pub(super) struct PositionTiming {
    positions: Track<DVec3>,
    /// The times of the keys in seconds; rising.
    times: Vec<f64>,
    /// The arc length of each segment that is passed at constant speed.
    lengths: Vec<Option<ArcLength>>,
}

impl PositionTiming {
    /// Every key at its time.
    pub(super) fn by_keys(times: &[f64], positions: Track<DVec3>) -> PositionTiming {
        PositionTiming {
            lengths: vec![None; positions.segments().len()],
            times: times.to_vec(),
            positions,
        }
    }

    /// Constant speed wherever the camera moves, from the first to the last of the keys' times. Segments without
    /// motion keep the duration that their keys give.
    pub(super) fn at_constant_speed(times: &[f64], positions: Track<DVec3>) -> PositionTiming {
        let measured = positions.segments().iter().map(ArcLength::of);
        let measured: Vec<ArcLength> = measured.collect();
        let total: f64 = measured.iter().map(ArcLength::total).sum();
        let moves = |length: &ArcLength| length.total() > ArcLength::ACCURACY * total;
        let lengths = measured
            .into_iter()
            .map(|length| Some(length).filter(moves));
        let mut timing = PositionTiming {
            lengths: lengths.collect(),
            times: times.to_vec(),
            positions,
        };
        let seconds = |i: usize| times[i + 1] - times[i];
        let segments = timing.lengths.iter().enumerate();
        let standing = segments.filter(|(_, length)| length.is_none());
        let moving =
            times[times.len() - 1] - times[0] - standing.map(|(i, _)| seconds(i)).sum::<f64>();
        for i in 0..timing.lengths.len() {
            let seconds = match &timing.lengths[i] {
                Some(length) => moving * (length.total() / total),
                None => seconds(i),
            };
            timing.times[i + 1] = timing.times[i] + seconds;
        }
        // Free of the rounding of the sum.
        if let (Some(end), Some(last)) = (timing.times.last_mut(), times.last()) {
            *end = *last;
        }
        timing
    }

    /// When each key is passed, in seconds.
    pub(super) fn times(&self) -> &[f64] {
        &self.times
    }

    /// The position at a time.
    pub(super) fn position(&self, time: TrackTime) -> DVec3 {
        if let TrackTime::InSegment(i, fraction) = time
            && let Some(length) = &self.lengths[i]
        {
            let segment = &self.positions.segments()[i];
            return segment
                .at_curve_parameter(length.parameter_at(segment, fraction * length.total()));
        }
        self.positions.at(time)
    }
}
