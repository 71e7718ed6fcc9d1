use super::arc_length::ArcLength;
use super::track::{Place, Track};
use glam::DVec3;

/// When the camera passes its keys, and where it is between them.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    positions: Track<DVec3>,
    /// In seconds; rising.
    times: Vec<f64>,
    /// Of each segment that is walked at constant speed.
    lengths: Vec<Option<ArcLength>>,
}

impl Walk {
    /// Every key at its time.
    pub(super) fn by_keys(times: &[f64], positions: Track<DVec3>) -> Walk {
        Walk {
            lengths: vec![None; positions.pieces().len()],
            times: times.to_vec(),
            positions,
        }
    }

    /// At one speed wherever the camera moves, from the first to the last of the keys' times. Segments in which it
    /// stands last as long as their keys say.
    pub(super) fn at_constant_speed(times: &[f64], positions: Track<DVec3>) -> Walk {
        let measured = positions.pieces().iter().map(ArcLength::of);
        let measured: Vec<ArcLength> = measured.collect();
        let way: f64 = measured.iter().map(ArcLength::total).sum();
        let moves = |length: &ArcLength| length.total() > ArcLength::ACCURACY * way;
        let lengths = measured
            .into_iter()
            .map(|length| Some(length).filter(moves));
        let mut walk = Walk {
            lengths: lengths.collect(),
            times: times.to_vec(),
            positions,
        };
        let seconds = |i: usize| times[i + 1] - times[i];
        let segments = walk.lengths.iter().enumerate();
        let standing = segments.filter(|(_, length)| length.is_none());
        let moving =
            times[times.len() - 1] - times[0] - standing.map(|(i, _)| seconds(i)).sum::<f64>();
        for i in 0..walk.lengths.len() {
            let seconds = match &walk.lengths[i] {
                Some(length) => moving * (length.total() / way),
                None => seconds(i),
            };
            walk.times[i + 1] = walk.times[i] + seconds;
        }
        // Not what the sum is rounded to.
        if let (Some(end), Some(last)) = (walk.times.last_mut(), times.last()) {
            *end = *last;
        }
        walk
    }

    /// When each key is passed, in seconds.
    pub(super) fn times(&self) -> &[f64] {
        &self.times
    }

    /// Where the camera is.
    pub(super) fn position(&self, place: Place) -> DVec3 {
        match place {
            Place::Between(i, share) if let Some(length) = &self.lengths[i] => {
                let piece = &self.positions.pieces()[i];
                piece.at_share_of_curve(length.share_at(piece, share * length.total()))
            }
            _ => self.positions.at(place),
        }
    }
}
