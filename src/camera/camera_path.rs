use super::curve::{Segment, SmoothCurve, find_segment};
use super::{Camera, Timeline};
use glam::{DMat3, DQuat, DVec3};
use thiserror::Error;

/// Where the camera is at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyframe {
    /// Seconds.
    pub time: f64,
    /// The eye, in world coordinates.
    pub position: DVec3,
    /// Where it looks.
    pub orientation: Orientation,
    /// Vertical field of view in radians, between 0 and pi.
    pub field_of_view: f64,
}

/// Where a camera looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orientation {
    /// At a point in world coordinates, with +Y up.
    LookAt(DVec3),
    /// Camera to world; without rotation the camera looks along -Z with +Y up.
    Rotation(DQuat),
}

/// How a path goes from key to key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight, at an even pace.
    Linear,
    /// On a smooth curve without stops.
    CatmullRom,
}

/// Why keys do not make a path.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "each variant is described by its message")]
pub enum PathError {
    #[error("there are none; write at least one")]
    NoKeys,
    #[error("key {key}, at {time} s, is not after the key before it; times must rise")]
    TimesDoNotRise { key: usize, time: f64 },
    #[error(
        "at {time} s (frame {frame}) the camera is at its look_at point; move one of them, or give \
         `rotation` instead"
    )]
    LooksAtItself { frame: u32, time: f64 },
    #[error(
        "at {time} s (frame {frame}) the camera looks straight up or down, where look_at leaves \
         its roll open; give `rotation` instead"
    )]
    LooksVertically { frame: u32, time: f64 },
}

/// A camera for every frame. The camera of a frame depends on the frame's number alone.
///
/// Position and look_at point are interpolated each on its own; rotations turn the short way at
/// an even pace. The focal length is interpolated by its logarithm, so that a zoom magnifies
/// evenly.
#[derive(Clone, Debug)]
pub struct CameraPath {
    timeline: Timeline,
    positions: Track<DVec3>,
    aim: Aim,
    log_half_heights: Track<f64>,
}

#[derive(Clone, Debug)]
enum Aim {
    Points(Track<DVec3>),
    Rotations(Vec<f64>, Vec<DQuat>),
}

#[derive(Clone, Debug)]
enum Track<T> {
    Linear(Vec<f64>, Vec<T>),
    Smooth(SmoothCurve<T>),
}

impl Camera {
    /// One at `eye` that looks at `target`, its vertical field of view in radians. Refuses what a key of a
    /// camera path may not be, either.
    pub fn look_at(eye: DVec3, target: DVec3, field_of_view: f64) -> Result<Camera, PathError> {
        let key = Keyframe {
            time: 0.0,
            position: eye,
            orientation: Orientation::LookAt(target),
            field_of_view,
        };
        let path = CameraPath::new(1.0, Interpolation::Linear, &[key])?;
        Ok(path.camera(0))
    }
}

impl CameraPath {
    /// Checks the keys and the camera of every frame. If all keys look at points, the point moves;
    /// otherwise all are turned into rotations.
    pub fn new(
        fps: f64,
        interpolation: Interpolation,
        keys: &[Keyframe],
    ) -> Result<CameraPath, PathError> {
        let (Some(first), Some(last)) = (keys.first(), keys.last()) else {
            return Err(PathError::NoKeys);
        };
        if let Some(i) = keys.windows(2).position(|k| k[1].time <= k[0].time) {
            return Err(PathError::TimesDoNotRise {
                key: i + 1,
                time: keys[i + 1].time,
            });
        }
        let timeline = Timeline {
            fps,
            start: first.time,
            end: last.time,
        };
        let times: Vec<f64> = keys.iter().map(|k| k.time).collect();
        let path = CameraPath {
            timeline,
            positions: Track::new(interpolation, &times, keys.iter().map(|k| k.position)),
            aim: Aim::new(interpolation, &times, keys, &timeline)?,
            log_half_heights: Track::new(
                interpolation,
                &times,
                keys.iter()
                    .map(|k| libm::log(libm::tan(0.5 * k.field_of_view))),
            ),
        };
        for frame in 0..timeline.frame_count() {
            path.try_camera(frame)?;
        }
        Ok(path)
    }

    /// Frames and their times.
    pub fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// The camera of a frame, below the timeline's frame count.
    pub fn camera(&self, frame: u32) -> Camera {
        self.try_camera(frame)
            .expect("every frame was checked when the path was made")
    }

    fn try_camera(&self, frame: u32) -> Result<Camera, PathError> {
        let time = self.timeline.time_of(frame);
        let position = self.positions.at(time);
        let rotation = match &self.aim {
            Aim::Points(points) => look_at(position, points.at(time), frame, time)?,
            Aim::Rotations(times, rotations) => {
                DMat3::from_quat(rotation_at(times, rotations, time))
            }
        };
        Ok(Camera {
            position,
            rotation,
            half_height: libm::exp(self.log_half_heights.at(time)),
        })
    }
}

impl Aim {
    fn new(
        interpolation: Interpolation,
        times: &[f64],
        keys: &[Keyframe],
        timeline: &Timeline,
    ) -> Result<Aim, PathError> {
        let points: Option<Vec<DVec3>> = keys
            .iter()
            .map(|key| match key.orientation {
                Orientation::LookAt(point) => Some(point),
                Orientation::Rotation(_) => None,
            })
            .collect();
        if let Some(points) = points {
            return Ok(Aim::Points(Track::new(interpolation, times, points)));
        }
        let mut rotations: Vec<DQuat> = Vec::new();
        for key in keys {
            let rotation = match key.orientation {
                Orientation::Rotation(rotation) => rotation,
                Orientation::LookAt(point) => {
                    let frame = ((key.time - timeline.start) * timeline.fps).round() as u32;
                    DQuat::from_mat3(&look_at(key.position, point, frame, key.time)?)
                }
            };
            // Of the two quaternions of a rotation the one nearer to the last: the short way.
            let flip = rotations
                .last()
                .is_some_and(|last| last.dot(rotation) < 0.0);
            rotations.push(if flip { -rotation } else { rotation });
        }
        Ok(Aim::Rotations(times.to_vec(), rotations))
    }
}

/// The rotation of a camera that looks from `position` to `target` with +Y up.
fn look_at(position: DVec3, target: DVec3, frame: u32, time: f64) -> Result<DMat3, PathError> {
    let Some(backward) = (position - target).try_normalize() else {
        return Err(PathError::LooksAtItself { frame, time });
    };
    // Nearer to the vertical than this, right would be made of rounding errors.
    const SMALLEST_SINE: f64 = 1e-7;
    let right = DVec3::Y.cross(backward);
    if right.length() < SMALLEST_SINE {
        return Err(PathError::LooksVertically { frame, time });
    }
    let right = right.normalize();
    Ok(DMat3::from_cols(right, backward.cross(right), backward))
}

fn rotation_at(times: &[f64], rotations: &[DQuat], time: f64) -> DQuat {
    match find_segment(times, time) {
        Segment::Key(key) => rotations[key],
        Segment::Between(i, s) => slerp(rotations[i], rotations[i + 1], s),
    }
}

/// Turns evenly from `a` to `b`, which are in the same half of the sphere (Shoemake 1985, "Animating
/// Rotation with Quaternion Curves"). With functions that are the same on every machine.
fn slerp(a: DQuat, b: DQuat, s: f64) -> DQuat {
    let angle = libm::acos(a.dot(b).min(1.0));
    // So near each other a straight line is as even, and sin(angle) is not divided by.
    if angle < 1e-6 {
        return a.lerp(b, s);
    }
    let weight = |part: f64| libm::sin(part * angle) / libm::sin(angle);
    (a * weight(1.0 - s) + b * weight(s)).normalize()
}

impl<T: super::curve::Value> Track<T> {
    fn new(
        interpolation: Interpolation,
        times: &[f64],
        values: impl IntoIterator<Item = T>,
    ) -> Track<T> {
        let (times, values) = (times.to_vec(), values.into_iter().collect());
        match interpolation {
            Interpolation::Linear => Track::Linear(times, values),
            Interpolation::CatmullRom => Track::Smooth(SmoothCurve::new(times, values)),
        }
    }

    fn at(&self, time: f64) -> T {
        match self {
            Track::Linear(times, values) => match find_segment(times, time) {
                Segment::Key(key) => values[key],
                Segment::Between(i, s) => values[i] * (1.0 - s) + values[i + 1] * s,
            },
            Track::Smooth(curve) => curve.at(time),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    fn key(time: f64, position: DVec3, orientation: Orientation) -> Keyframe {
        Keyframe {
            time,
            position,
            orientation,
            field_of_view: FRAC_PI_2,
        }
    }

    fn path(interpolation: Interpolation, keys: &[Keyframe]) -> Result<CameraPath, PathError> {
        CameraPath::new(10.0, interpolation, keys)
    }

    #[test]
    fn looks_at_its_target_with_y_up() {
        let target = DVec3::new(3.0, 1.0, -2.0);
        let keys = [key(0.0, DVec3::ONE, Orientation::LookAt(target))];
        let path = path(Interpolation::CatmullRom, &keys).expect("a still");
        assert_eq!(path.timeline().frame_count(), 1);
        let camera = path.camera(0);
        let forward = (target - DVec3::ONE).normalize();
        assert!((camera.rotation * DVec3::NEG_Z - forward).length() < 1e-12);
        let right = camera.rotation * DVec3::X;
        assert!(right.y.abs() < 1e-12 && (camera.rotation * DVec3::Y).y > 0.0);
        assert!((camera.rotation.determinant() - 1.0).abs() < 1e-12);
        assert!((camera.half_height - 1.0).abs() < 1e-12);
    }

    #[test]
    fn first_and_last_frame_are_the_keys_and_linear_is_straight() {
        let aim = Orientation::Rotation(DQuat::IDENTITY);
        let keys = [key(1.0, DVec3::ZERO, aim), key(3.0, DVec3::X * 4.0, aim)];
        let path = path(Interpolation::Linear, &keys).expect("two keys");
        assert_eq!(path.timeline().frame_count(), 21);
        assert_eq!(path.camera(0).position, DVec3::ZERO);
        assert_eq!(path.camera(20).position, DVec3::X * 4.0);
        assert!((path.camera(5).position - DVec3::X).length() < 1e-12);
    }

    #[test]
    fn rotations_take_the_short_way() {
        let aim = |degrees: f64| {
            let q = DQuat::from_rotation_y(degrees.to_radians());
            Orientation::Rotation(if degrees > 180.0 { -q } else { q })
        };
        let keys = [
            key(0.0, DVec3::ZERO, aim(10.0)),
            key(1.0, DVec3::ZERO, aim(350.0)),
        ];
        let path = path(Interpolation::CatmullRom, &keys).expect("two keys");
        let quarter = DQuat::from_rotation_y(5.0_f64.to_radians()) * DVec3::NEG_Z;
        // A quarter of the way from 10 to -10 degrees, at an even pace.
        let early = CameraPath::new(8.0, Interpolation::Linear, &keys)
            .expect("two keys")
            .camera(2);
        assert!((early.rotation * DVec3::NEG_Z - quarter).length() < 1e-12);
        let camera = path.camera(5);
        assert!((camera.rotation * DVec3::NEG_Z - DVec3::NEG_Z).length() < 1e-12);
    }

    #[test]
    fn zoom_magnifies_evenly() {
        let aim = Orientation::Rotation(DQuat::IDENTITY);
        let zoomed = |time: f64, degrees: f64| Keyframe {
            field_of_view: degrees.to_radians(),
            ..key(time, DVec3::ZERO, aim)
        };
        for interpolation in [Interpolation::Linear, Interpolation::CatmullRom] {
            let path = path(interpolation, &[zoomed(0.0, 60.0), zoomed(10.0, 6.0)]).expect("keys");
            let sizes: Vec<f64> = (0..=100).map(|f| path.camera(f).half_height).collect();
            let first = sizes[1] / sizes[0];
            assert!(
                sizes
                    .windows(2)
                    .all(|s| (s[1] / s[0] - first).abs() < 1e-12)
            );
        }
    }

    #[test]
    fn mixed_keys_become_rotations() {
        let keys = [
            key(0.0, DVec3::ZERO, Orientation::LookAt(DVec3::X)),
            key(1.0, DVec3::ZERO, Orientation::Rotation(DQuat::IDENTITY)),
        ];
        let path = path(Interpolation::Linear, &keys).expect("two keys");
        let forward = path.camera(5).rotation * DVec3::NEG_Z;
        let expected = DVec3::new(FRAC_PI_4.sin(), 0.0, -FRAC_PI_4.cos());
        assert!((forward - expected).length() < 1e-9, "{forward}");
    }

    #[test]
    fn refuses_what_has_no_camera() {
        let at = |time, position, target| key(time, position, Orientation::LookAt(target));
        let refusal = |keys: &[Keyframe]| path(Interpolation::Linear, keys).err();
        assert_eq!(refusal(&[]), Some(PathError::NoKeys));
        let still = at(1.0, DVec3::ZERO, DVec3::X);
        assert_eq!(
            refusal(&[still, still]),
            Some(PathError::TimesDoNotRise { key: 1, time: 1.0 })
        );
        // Passes through its target half way.
        assert_eq!(
            refusal(&[
                at(0.0, DVec3::X, DVec3::ZERO),
                at(1.0, DVec3::NEG_X, DVec3::ZERO)
            ]),
            Some(PathError::LooksAtItself {
                frame: 5,
                time: 0.5
            })
        );
        assert_eq!(
            refusal(&[at(0.0, DVec3::Y, DVec3::ZERO)]),
            Some(PathError::LooksVertically {
                frame: 0,
                time: 0.0
            })
        );
    }
}
