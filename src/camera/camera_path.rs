//! The camera path: keys in, a camera for every frame out.

use super::error::CameraPathError;
use super::key_checks;
use super::keyframe::{CameraPathTiming, Interpolation, Keyframe, Segment, Speed};
use super::look_at::LookAt;
use super::orientation_track::{OrientationMode, OrientationTrack};
use super::position_timing::PositionTiming;
use super::ramp::Ramp;
use super::track::{Track, TrackInput, TrackTime};
use super::{Camera, Timeline};
use glam::DVec3;

/// A camera for every frame, computed from the frame's number alone.
///
/// The camera passes through every key, by default at its time. Where two smooth segments meet, its velocity, angular
/// velocity and zoom rate are continuous. Position, look_at point, angles and rotation are interpolated independently;
/// rotations take the shorter way. The focal length is interpolated logarithmically, so that a zoom magnifies at a
/// constant rate.
#[derive(Clone, Debug)]
pub struct CameraPath {
    timeline: Timeline,
    ramp: Ramp,
    positions: PositionTiming,
    orientations: OrientationTrack,
    log_half_heights: Track<f64>,
    /// When each key is passed.
    keys: Vec<f64>,
    /// Eased times of the cuts; rising.
    cuts: Vec<f64>,
}

impl CameraPath {
    /// Checks the keys and the camera of every frame. If all keys have a look_at point, the point is interpolated; if
    /// all have angles, the angles are; otherwise all orientations become rotations.
    pub fn new(
        fps: f64,
        keys: &[Keyframe],
        timing: &CameraPathTiming,
    ) -> Result<CameraPath, CameraPathError> {
        key_checks::check(keys, timing)?;
        let times: Vec<f64> = keys.iter().map(|key| key.time).collect();
        let timeline = Timeline {
            fps,
            start: times[0],
            end: times[times.len() - 1],
            closed: timing.closed,
        };
        let segments: Vec<Segment> = keys.iter().map(|key| key.segment).collect();
        let segments = &segments[..keys.len() - 1];
        let position = |key: &Keyframe| key.position;
        let positions = Track::new(
            &times,
            keys.iter().map(position).collect(),
            segments,
            timing.closed,
        );
        let positions = match timing.speed {
            Speed::ByKeys => PositionTiming::by_keys(&times, positions),
            Speed::Constant => PositionTiming::at_constant_speed(&times, positions),
        };
        let tracks = TrackInput {
            times: positions.times(),
            segments,
            closed: timing.closed,
        };
        let duration = timeline.end - timeline.start;
        let fraction = |seconds: f64| {
            if duration > 0.0 {
                seconds / duration
            } else {
                0.0
            }
        };
        let ramp = Ramp::new(fraction(timing.ease_in), fraction(timing.ease_out));
        let passed = |&time: &f64| match ramp.is_flat() || time == timeline.end {
            true => time,
            false => timeline.start + duration * ramp.inverse(fraction(time - timeline.start)),
        };
        let passed = positions.times().iter().map(passed).collect();
        let cuts = segments.iter().zip(&positions.times()[1..]);
        let cuts = cuts.filter(|(segment, _)| segment.interpolation == Interpolation::Hold);
        let cuts = cuts.map(|(_, time)| *time).collect();
        let half_height = |key: &Keyframe| libm::log(libm::tan(0.5 * key.field_of_view));
        let path = CameraPath {
            timeline,
            ramp,
            orientations: OrientationTrack::new(keys, &tracks, &timeline)?,
            log_half_heights: tracks.through(keys.iter().map(half_height)),
            cuts,
            keys: passed,
            positions,
        };
        path.check_frames()?;
        Ok(path)
    }

    /// Frames and their times.
    pub fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// When the camera passes each key, in seconds; rising, the first and the last at the ends of the timeline.
    pub fn keys(&self) -> &[f64] {
        &self.keys
    }

    /// Where the camera is at each key, in world coordinates.
    pub fn key_positions(&self) -> Vec<DVec3> {
        let keys = 0..self.keys.len();
        keys.map(|key| self.positions.position(TrackTime::AtKey(key)))
            .collect()
    }

    /// The cameras at the keys, each with the time at which it is passed.
    pub fn key_cameras(&self) -> Vec<(f64, Camera)> {
        let keys = self.keys.iter().enumerate();
        let camera =
            |key, time| Some((time, self.evaluate(TrackTime::AtKey(key), 0, time).ok()?.0));
        keys.filter_map(|(key, &time)| camera(key, time)).collect()
    }

    /// How the path gives the camera's orientation.
    pub fn orientation_mode(&self) -> OrientationMode {
        self.orientations.mode()
    }

    /// Whether the first frame follows the last one.
    pub fn is_closed(&self) -> bool {
        self.timeline.closed
    }

    /// Whether there is a cut between a frame and the next one, which for the last frame of a closed path is the first.
    pub fn is_cut(&self, frame: u32) -> bool {
        let next = if frame + 1 < self.timeline.frame_count() {
            self.timeline.time_of(frame + 1)
        } else {
            self.timeline.end
        };
        let here = self.eased_time(self.timeline.time_of(frame));
        let after = self.cuts.partition_point(|&cut| cut <= here);
        let cut = self.cuts.get(after);
        cut.is_some_and(|&cut| cut <= self.eased_time(next))
    }

    /// The camera of a frame, below the timeline's frame count.
    pub fn camera(&self, frame: u32) -> Camera {
        self.camera_at(self.timeline.time_of(frame), frame)
            .expect("every frame was checked when the path was made")
    }

    /// The camera at a time between the first and the last key. An error is about a frame.
    pub(super) fn camera_at(&self, time: f64, frame: u32) -> Result<Camera, CameraPathError> {
        Ok(self.evaluate_at(time, frame)?.0)
    }

    /// The camera at a time and, if the path has look_at points, how it looks at its point.
    fn evaluate_at(
        &self,
        time: f64,
        frame: u32,
    ) -> Result<(Camera, Option<LookAt>), CameraPathError> {
        let track_time = TrackTime::of(self.positions.times(), self.eased_time(time));
        self.evaluate(track_time, frame, time)
    }

    /// As [`CameraPath::evaluate_at`], at a time among the keys; an error names `frame` and `time`.
    fn evaluate(
        &self,
        track_time: TrackTime,
        frame: u32,
        time: f64,
    ) -> Result<(Camera, Option<LookAt>), CameraPathError> {
        let position = self.positions.position(track_time);
        let (rotation, look_at) = self
            .orientations
            .rotation(track_time, position, frame, time)?;
        let camera = Camera {
            position,
            rotation,
            half_height: libm::exp(self.log_half_heights.at(track_time)),
        };
        Ok((camera, look_at))
    }

    /// The eased time at a time of the video: what the ramp makes of it, snapped to a key's time where only rounding
    /// separates them.
    fn eased_time(&self, time: f64) -> f64 {
        let Timeline {
            start, end, fps, ..
        } = self.timeline;
        let eased = match self.ramp.is_flat() || time == end {
            true => time,
            false => start + (end - start) * self.ramp.ease((time - start) / (end - start)),
        };
        /// In frames.
        const ROUNDING: f64 = 1e-9;
        let rounding = ROUNDING / fps + 4.0 * f64::EPSILON * eased.abs();
        let times = self.positions.times();
        let distance = |key: &f64| (key - eased).abs();
        let near = times.partition_point(|&key| key < eased - rounding);
        let near = times[near..]
            .iter()
            .take_while(|key| distance(key) <= rounding);
        let nearest = near.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.copied().unwrap_or(eased)
    }

    /// Checks that every frame has a camera, and that the camera does not pass its look_at point between two frames.
    fn check_frames(&self) -> Result<(), CameraPathError> {
        let count = self.timeline.frame_count();
        let mut before: Option<LookAt> = None;
        for frame in 0..count + u32::from(self.is_closed()) {
            let time = self.timeline.time_of(frame % count);
            let (camera, look_at) = self.evaluate_at(time, frame % count)?;
            let size = camera.half_height;
            let is_finite = camera.position.is_finite() && camera.rotation.is_finite();
            if !(is_finite && size > 0.0 && size.is_finite()) {
                return Err(CameraPathError::NoCamera { frame, time });
            }
            if let (Some(before), Some(look_at)) = (&before, &look_at)
                && !self.is_cut(frame - 1)
            {
                look_at.check_from(before, frame % count, time)?;
            }
            before = look_at;
        }
        Ok(())
    }
}
