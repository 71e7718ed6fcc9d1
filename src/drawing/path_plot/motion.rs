//! Speed, turn rate and zoom along a camera path.

use crate::camera::{Camera, CameraPath, FrameCameras, Timeline};
use glam::DVec3;
use std::ops::Range;

/// The motion of a camera along its path, frame by frame.
#[derive(Debug)]
pub(super) struct Motion {
    /// The camera of each frame, at least one; a closed path without a cut at its seam ends with the first again.
    pub(super) cameras: Vec<Camera>,
    /// Frames and their times.
    pub(super) timeline: Timeline,
    /// The width of a frame over its height.
    pub(super) aspect: f64,
    /// The times of the keys, in seconds.
    pub(super) keys: Vec<f64>,
    /// The camera's position at each key.
    pub(super) key_positions: Vec<DVec3>,
    /// The frames between cuts, in their order.
    pub(super) shots: Vec<Range<u32>>,
}

impl Motion {
    pub(super) fn of(path: &CameraPath, aspect: f64) -> Motion {
        let mut frames = FrameCameras::of(path);
        let last = frames.cameras.len() - 1;
        if frames.is_closed && last > 0 && !frames.is_cut(last) {
            frames.cameras.push(frames.cameras[0]);
        }
        let shots = frames.shots().into_iter();
        let shots = shots.map(|shot| shot.start as u32..shot.end as u32);
        Motion {
            shots: shots.collect(),
            cameras: frames.cameras,
            timeline: *path.timeline(),
            aspect,
            keys: path.keys().to_vec(),
            key_positions: path.key_positions(),
        }
    }

    pub(super) fn camera(&self, frame: u32) -> &Camera {
        &self.cameras[frame as usize]
    }

    /// How many cameras there are.
    pub(super) fn frame_count(&self) -> u32 {
        self.cameras.len() as u32
    }

    /// The frame nearest to a time.
    pub(super) fn frame_at(&self, time: f64) -> u32 {
        let last = self.frame_count() - 1;
        let duration = self.timeline.time_of(last) - self.timeline.start;
        let fraction = (time - self.timeline.start) / duration;
        // NaN for a still, which becomes 0.
        (fraction * f64::from(last))
            .round()
            .clamp(0.0, f64::from(last)) as u32
    }

    /// The length of the path in metres, without cuts.
    pub(super) fn length(&self) -> f64 {
        self.shots
            .iter()
            .flat_map(|shot| self.steps(shot))
            .map(|(a, b)| a.position.distance(b.position))
            .sum()
    }

    /// Speeds between the frames of a shot: times in seconds and metres per second of the video.
    pub(super) fn speeds(&self, shot: &Range<u32>) -> Vec<(f64, f64)> {
        let speeds = self
            .steps(shot)
            .map(|(a, b)| a.position.distance(b.position));
        self.rates(shot, speeds)
    }

    /// As [`Motion::speeds`], the turn rate in degrees per second.
    pub(super) fn turn_rates(&self, shot: &Range<u32>) -> Vec<(f64, f64)> {
        let turns = self
            .steps(shot)
            .map(|(a, b)| a.turn_to(b).length().to_degrees());
        self.rates(shot, turns)
    }

    /// The vertical field of view of the frames of a shot: times in seconds and degrees.
    pub(super) fn fields_of_view(&self, shot: &Range<u32>) -> Vec<(f64, f64)> {
        let of = |frame| {
            let degrees = self.camera(frame).field_of_view().to_degrees();
            (self.timeline.time_of(frame), degrees)
        };
        shot.clone().map(of).collect()
    }

    fn steps(&self, shot: &Range<u32>) -> impl Iterator<Item = (&Camera, &Camera)> {
        let cameras = &self.cameras[shot.start as usize..shot.end as usize];
        cameras.windows(2).map(|pair| (&pair[0], &pair[1]))
    }

    fn rates(&self, shot: &Range<u32>, steps: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
        let middle =
            |frame| 0.5 * (self.timeline.time_of(frame) + self.timeline.time_of(frame + 1));
        let rate = |(frame, step): (u32, f64)| (middle(frame), step * self.timeline.fps);
        shot.clone().zip(steps).map(rate).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{CameraPathTiming, Interpolation, Keyframe, Orientation, Segment};
    use glam::DQuat;

    fn key(time: f64, x: f64, degrees: f64, interpolation: Interpolation) -> Keyframe {
        Keyframe {
            time,
            position: DVec3::new(x, 0.0, 0.0),
            orientation: Orientation::Rotation(DQuat::from_rotation_y(degrees.to_radians())),
            field_of_view: 1.0,
            segment: Segment::of(interpolation),
        }
    }

    fn path(seconds: f64, turn: f64) -> CameraPath {
        let keys = [
            key(1.0, 0.0, 0.0, Interpolation::Linear),
            key(1.0 + seconds, 6.0, turn, Interpolation::Linear),
        ];
        CameraPath::new(10.0, &keys, &CameraPathTiming::BY_KEYS).expect("two keys")
    }

    #[test]
    fn rates_are_per_second_and_stand_between_frames() {
        let motion = Motion::of(&path(2.0, 90.0), 1.5);
        assert!((motion.length() - 6.0).abs() < 1e-12);
        let whole = motion.shots[0].clone();
        assert_eq!((motion.shots.len(), &whole), (1, &(0..21)));
        let (speeds, turns) = (motion.speeds(&whole), motion.turn_rates(&whole));
        assert_eq!((speeds.len(), turns.len()), (20, 20));
        for ((step, speed), turn) in (0..20).zip(&speeds).zip(&turns) {
            let time = 1.05 + 0.1 * f64::from(step);
            assert!((speed.0 - time).abs() < 1e-12 && (turn.0 - time).abs() < 1e-12);
            assert!((speed.1 - 3.0).abs() < 1e-9 && (turn.1 - 45.0).abs() < 1e-9);
        }
        for (_, degrees) in motion.fields_of_view(&whole) {
            assert!((degrees - 1.0_f64.to_degrees()).abs() < 1e-9);
        }
    }

    #[test]
    fn shots_end_where_the_camera_jumps() {
        let keys = [
            key(0.0, 0.0, 0.0, Interpolation::Linear),
            key(1.0, 1.0, 0.0, Interpolation::Hold),
            key(2.0, 50.0, 0.0, Interpolation::Linear),
            key(3.0, 51.0, 0.0, Interpolation::Linear),
        ];
        let path =
            CameraPath::new(10.0, &keys, &CameraPathTiming::BY_KEYS).expect("a path with a cut");
        let motion = Motion::of(&path, 1.5);
        assert_eq!(motion.shots, [0..20, 20..31]);
        assert!((motion.length() - 2.0).abs() < 1e-9);
    }

    #[test]
    fn closed_paths_are_closed() {
        let key = |time: f64, x: f64| key(time, x, 0.0, Interpolation::Linear);
        let keys = [key(0.0, 0.0), key(0.97, 1.0), key(2.0, 0.0)];
        let timing = CameraPathTiming {
            closed: true,
            ..CameraPathTiming::BY_KEYS
        };
        let path = CameraPath::new(10.0, &keys, &timing).expect("a closed path");
        let motion = Motion::of(&path, 1.5);
        assert_eq!((motion.shots.len(), motion.shots[0].clone()), (1, 0..21));
        assert_eq!(motion.cameras[20], motion.cameras[0]);
        assert_eq!(motion.frame_at(motion.keys[2]), 20);
        // Keys are where they are, not where the next frame is.
        assert_eq!(motion.key_positions[1], DVec3::X);
        assert_eq!(motion.speeds(&(0..21)).len(), 20);
    }

    #[test]
    fn frames_are_found_by_their_times() {
        let motion = Motion::of(&path(2.0, 0.0), 1.5);
        for (time, frame) in [(0.0, 0), (1.0, 0), (1.52, 5), (3.0, 20), (9.0, 20)] {
            assert_eq!(motion.frame_at(time), frame);
        }
        let key = key(3.0, 0.0, 0.0, Interpolation::Linear);
        let still = CameraPath::new(24.0, &[key], &CameraPathTiming::BY_KEYS).expect("a still");
        let still = Motion::of(&still, 1.0);
        assert_eq!(still.frame_at(3.0), 0);
        assert!(still.speeds(&(0..1)).is_empty());
        assert_eq!(still.fields_of_view(&(0..1)).len(), 1);
    }
}
