use super::error::PathError;
use super::keyframe::{Keyframe, Orientation, Pace, Segment, Shape, Speed};
use super::look_at::Look;
use super::ramp::Ramp;
use super::rotation::{roll, yaw_pitch_roll};
use super::track::{Place, Track};
use super::value::Value;
use super::walk::Walk;
use super::{Camera, Timeline};
use glam::{DMat3, DQuat, DVec3};

/// A camera for every frame. The camera of a frame depends on the frame's number alone.
///
/// It passes through every key, by default at its time, and its velocity, angular velocity and zoom do not jump
/// there where both segments are smooth. Position, look_at point, angles and rotation are each interpolated on
/// their own; rotations turn the short way. The focal length is interpolated by its logarithm, so that a zoom
/// magnifies evenly.
#[derive(Clone, Debug)]
pub struct CameraPath {
    timeline: Timeline,
    ramp: Ramp,
    walk: Walk,
    aim: Aim,
    log_half_heights: Track<f64>,
    /// When each key is passed.
    keys: Vec<f64>,
    /// When the camera jumps, before the ramp; rising.
    cuts: Vec<f64>,
}

/// What a path says of where its camera looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steering {
    /// A point that it looks at, and a roll against +Y.
    Points,
    /// Yaw, pitch and roll.
    Angles,
    /// Rotations, or what only they can lead from one to the next.
    Rotations,
}

/// What decides where the camera looks.
#[derive(Clone, Debug)]
enum Aim {
    Points {
        targets: Track<DVec3>,
        rolls: Track<f64>,
    },
    Angles(Track<DVec3>),
    Rotations(Track<DQuat>),
}

impl CameraPath {
    /// Checks the keys and the camera of every frame. If all keys look at points, the point moves; if all have
    /// angles, these change; otherwise all are turned into rotations.
    pub fn new(fps: f64, keys: &[Keyframe], pace: &Pace) -> Result<CameraPath, PathError> {
        check(keys, pace)?;
        let times: Vec<f64> = keys.iter().map(|key| key.time).collect();
        let timeline = Timeline {
            fps,
            start: times[0],
            end: times[times.len() - 1],
            closed: pace.closed,
        };
        let segments: Vec<Segment> = keys.iter().map(|key| key.segment).collect();
        let segments = &segments[..keys.len() - 1];
        let position = |key: &Keyframe| key.position;
        let positions = Track::new(
            &times,
            keys.iter().map(position).collect(),
            segments,
            pace.closed,
        );
        let walk = match pace.speed {
            Speed::ByKeys => Walk::by_keys(&times, positions),
            Speed::Constant => Walk::at_constant_speed(&times, positions),
        };
        let tracks = Tracks {
            times: walk.times(),
            segments,
            closed: pace.closed,
        };
        let duration = timeline.end - timeline.start;
        let share = |seconds: f64| {
            if duration > 0.0 {
                seconds / duration
            } else {
                0.0
            }
        };
        let ramp = Ramp::new(share(pace.ease_in), share(pace.ease_out));
        let passed = |&time: &f64| match ramp.is_flat() || time == timeline.end {
            true => time,
            false => timeline.start + duration * ramp.time(share(time - timeline.start)),
        };
        let passed = walk.times().iter().map(passed).collect();
        let cuts = segments.iter().zip(&walk.times()[1..]);
        let cuts = cuts.filter(|(segment, _)| segment.shape == Shape::Hold);
        let cuts = cuts.map(|(_, time)| *time).collect();
        let half_height = |key: &Keyframe| libm::log(libm::tan(0.5 * key.field_of_view));
        let path = CameraPath {
            timeline,
            ramp,
            aim: Aim::new(keys, &tracks, &timeline)?,
            log_half_heights: tracks.through(keys.iter().map(half_height)),
            cuts,
            keys: passed,
            walk,
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
        keys.map(|key| self.walk.position(Place::Key(key)))
            .collect()
    }

    /// The cameras at the keys, each with the time at which it is passed.
    pub fn key_cameras(&self) -> Vec<(f64, Camera)> {
        let keys = self.keys.iter().enumerate();
        let camera = |key, time| Some((time, self.seen_from(Place::Key(key), 0, time).ok()?.0));
        keys.filter_map(|(key, &time)| camera(key, time)).collect()
    }

    /// What the path says of where the camera looks.
    pub fn steering(&self) -> Steering {
        match self.aim {
            Aim::Points { .. } => Steering::Points,
            Aim::Angles(_) => Steering::Angles,
            Aim::Rotations(_) => Steering::Rotations,
        }
    }

    /// Whether the path goes on at its first frame after its last.
    pub fn is_closed(&self) -> bool {
        self.timeline.closed
    }

    /// Whether the camera jumps between a frame and the next, after the last frame of a closed path to the first.
    pub fn is_cut(&self, frame: u32) -> bool {
        let next = if frame + 1 < self.timeline.frame_count() {
            self.timeline.time_of(frame + 1)
        } else {
            self.timeline.end
        };
        let here = self.on_walk(self.timeline.time_of(frame));
        let after = self.cuts.partition_point(|&cut| cut <= here);
        let cut = self.cuts.get(after);
        cut.is_some_and(|&cut| cut <= self.on_walk(next))
    }

    /// The camera of a frame, below the timeline's frame count.
    pub fn camera(&self, frame: u32) -> Camera {
        self.camera_at(self.timeline.time_of(frame), frame)
            .expect("every frame was checked when the path was made")
    }

    /// The camera at a time between the first and the last key. An error is about a frame.
    pub(super) fn camera_at(&self, time: f64, frame: u32) -> Result<Camera, PathError> {
        Ok(self.seen_at(time, frame)?.0)
    }

    /// The camera at a time and, if it looks at a point, how.
    fn seen_at(&self, time: f64, frame: u32) -> Result<(Camera, Option<Look>), PathError> {
        let place = Place::of(self.walk.times(), self.on_walk(time));
        self.seen_from(place, frame, time)
    }

    fn seen_from(
        &self,
        place: Place,
        frame: u32,
        time: f64,
    ) -> Result<(Camera, Option<Look>), PathError> {
        let position = self.walk.position(place);
        let (rotation, look) = match &self.aim {
            Aim::Points { targets, rolls } => {
                let look = Look::new(position, targets.at(place), frame, time)?;
                (look.rotation * roll(rolls.at(place)), Some(look))
            }
            Aim::Angles(angles) => (yaw_pitch_roll(angles.at(place)), None),
            Aim::Rotations(rotations) => (DMat3::from_quat(rotations.at(place)), None),
        };
        let camera = Camera {
            position,
            rotation,
            half_height: libm::exp(self.log_half_heights.at(place)),
        };
        Ok((camera, look))
    }

    /// The time at which a path without a ramp is as far. So near to a key that only rounding is between, the key's.
    fn on_walk(&self, time: f64) -> f64 {
        let Timeline {
            start, end, fps, ..
        } = self.timeline;
        let way = match self.ramp.is_flat() || time == end {
            true => time,
            false => start + (end - start) * self.ramp.way((time - start) / (end - start)),
        };
        // As shares of a frame and of the number.
        const OF_FRAME: f64 = 1e-9;
        let rounding = OF_FRAME / fps + 4.0 * f64::EPSILON * way.abs();
        let times = self.walk.times();
        let distance = |key: &f64| (key - way).abs();
        let near = times.partition_point(|&key| key < way - rounding);
        let near = times[near..]
            .iter()
            .take_while(|key| distance(key) <= rounding);
        let nearest = near.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.copied().unwrap_or(way)
    }

    /// That every frame has a camera, and that no look_at point is passed between two, after the last of a closed path
    /// neither.
    fn check_frames(&self) -> Result<(), PathError> {
        let count = self.timeline.frame_count();
        let mut before: Option<Look> = None;
        for frame in 0..count + u32::from(self.is_closed()) {
            let time = self.timeline.time_of(frame % count);
            let (camera, look) = self.seen_at(time, frame % count)?;
            let size = camera.half_height;
            let is_finite = camera.position.is_finite() && camera.rotation.is_finite();
            if !(is_finite && size > 0.0 && size.is_finite()) {
                return Err(PathError::NoCamera { frame, time });
            }
            if let (Some(before), Some(look)) = (&before, &look)
                && !self.is_cut(frame - 1)
            {
                look.check_from(before, frame % count, time)?;
            }
            before = look;
        }
        Ok(())
    }
}

/// What all tracks but the positions' have in common.
struct Tracks<'a> {
    times: &'a [f64],
    segments: &'a [Segment],
    closed: bool,
}

impl Tracks<'_> {
    fn through<T: Value>(&self, keys: impl Iterator<Item = T>) -> Track<T> {
        let segments: Vec<Segment<T::Step>> =
            self.segments.iter().map(Segment::beside_position).collect();
        Track::new(self.times, keys.collect(), &segments, self.closed)
    }
}

impl Aim {
    fn new(keys: &[Keyframe], tracks: &Tracks, timeline: &Timeline) -> Result<Aim, PathError> {
        let points = keys.iter().map(|key| match key.orientation {
            Orientation::LookAt { target, roll } => Some((target, roll)),
            _ => None,
        });
        if let Some(points) = points.collect::<Option<Vec<_>>>() {
            return Ok(Aim::Points {
                targets: tracks.through(points.iter().map(|point| point.0)),
                rolls: tracks.through(points.iter().map(|point| point.1)),
            });
        }
        let angles = keys.iter().map(|key| match key.orientation {
            Orientation::YawPitchRoll(angles) => Some(angles),
            _ => None,
        });
        if let Some(angles) = angles.collect::<Option<Vec<_>>>() {
            return Ok(Aim::Angles(tracks.through(angles.into_iter())));
        }
        let rotations = keys.iter().map(|key| rotation(key, timeline));
        let rotations: Vec<DQuat> = rotations.collect::<Result<_, _>>()?;
        // Nearer to half a turn than this, the axis would be made of rounding errors.
        const SMALLEST_COSINE: f64 = 1e-9;
        for (i, pair) in rotations.windows(2).enumerate() {
            let is_half_turn = pair[0].dot(pair[1]).abs() < SMALLEST_COSINE;
            if is_half_turn && tracks.segments[i].shape != Shape::Hold {
                return Err(PathError::HalfTurn { key: i + 1 });
            }
        }
        Ok(Aim::Rotations(tracks.through(rotations.into_iter())))
    }
}

/// The rotation of the camera at a key.
fn rotation(key: &Keyframe, timeline: &Timeline) -> Result<DQuat, PathError> {
    let matrix = match key.orientation {
        Orientation::Rotation(rotation) => return Ok(rotation),
        Orientation::YawPitchRoll(angles) => yaw_pitch_roll(angles),
        Orientation::LookAt {
            target,
            roll: angle,
        } => {
            let frame = ((key.time - timeline.start) * timeline.fps).round() as u32;
            Look::new(key.position, target, frame, key.time)?.rotation * roll(angle)
        }
    };
    Ok(DQuat::from_mat3(&matrix))
}

/// What can be said of keys before the path is known.
fn check(keys: &[Keyframe], pace: &Pace) -> Result<(), PathError> {
    let (Some(first), Some(last)) = (keys.first(), keys.last()) else {
        return Err(PathError::NoKeys);
    };
    if let Some(i) = keys.windows(2).position(|k| k[1].time <= k[0].time) {
        return Err(PathError::TimesDoNotRise {
            key: i + 1,
            time: keys[i + 1].time,
        });
    }
    let (seconds, duration) = (pace.ease_in + pace.ease_out, last.time - first.time);
    // Sums of decimals are rounded.
    if seconds > duration * (1.0 + 1e-12) {
        return Err(PathError::EaseTooLong { seconds, duration });
    }
    if pace.closed && (pace.ease_in > 0.0) != (pace.ease_out > 0.0) {
        return Err(PathError::EasesOneSide);
    }
    let eases = |key: &Keyframe| key.segment.ease_in || key.segment.ease_out;
    if let (Speed::Constant, Some(key)) = (pace.speed, keys.iter().position(eases)) {
        return Err(PathError::EaseAtConstantSpeed { key });
    }
    match difference(first, last) {
        Some(what) if pace.closed => Err(PathError::NotClosed { what }),
        _ => Ok(()),
    }
}

/// What keys of a camera that is the same differ in.
fn difference(a: &Keyframe, b: &Keyframe) -> Option<&'static str> {
    if a.position != b.position {
        return Some("position");
    }
    if a.field_of_view != b.field_of_view {
        return Some("fov");
    }
    // Angles may have gone around.
    let turned = |matrix: DMat3, other: DMat3| !matrix.abs_diff_eq(other, 1e-9);
    match (a.orientation, b.orientation) {
        (
            Orientation::LookAt { target: p, roll: r },
            Orientation::LookAt { target: q, roll: s },
        ) => {
            if p != q {
                return Some("look_at");
            }
            turned(roll(r), roll(s)).then_some("roll")
        }
        (Orientation::YawPitchRoll(p), Orientation::YawPitchRoll(q)) => {
            turned(yaw_pitch_roll(p), yaw_pitch_roll(q)).then_some("yaw_pitch_roll")
        }
        (Orientation::Rotation(p), Orientation::Rotation(q)) => {
            turned(DMat3::from_quat(p), DMat3::from_quat(q)).then_some("rotation")
        }
        _ => Some("how the orientation is given"),
    }
}
