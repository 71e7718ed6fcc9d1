//! Keyframes: where the camera is at a time, how it goes on to the next key, and the timing of the whole path.

use glam::{DQuat, DVec3};

/// The camera at one time, and the segment that leads to the next key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyframe {
    /// Seconds.
    pub time: f64,
    /// The eye, in world coordinates.
    pub position: DVec3,
    /// Its orientation.
    pub orientation: Orientation,
    /// Vertical field of view in radians, between 0 and pi.
    pub field_of_view: f64,
    /// The segment to the next key; unused in the last key.
    pub segment: Segment,
}

/// The orientation of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orientation {
    /// Towards a point in world coordinates, with +Y up and then rolled.
    LookAt {
        /// The point.
        target: DVec3,
        /// Rotation about the camera's backward axis in radians, counter-clockwise seen from behind the camera;
        /// the picture turns clockwise.
        roll: f64,
    },
    /// Camera to world, a unit quaternion; the identity looks along -Z with +Y up.
    Rotation(DQuat),
    /// Yaw about the world's +Y, then pitch about the camera's right, then roll about its backward axis, in radians,
    /// each counter-clockwise seen from the tip of the axis: to the left, up, and tilted to the left. Whole turns
    /// count: from 0 to 2 pi the camera turns once around.
    YawPitchRoll(DVec3),
}

/// How a path leads from a key to the next; `D` is the type of the tangents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment<D = DVec3> {
    /// The curve between the keys.
    pub interpolation: Interpolation<D>,
    /// Whether the camera starts from rest.
    pub ease_in: bool,
    /// Whether the camera comes to rest at its end.
    pub ease_out: bool,
}

/// The curve from a key to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interpolation<D = DVec3> {
    /// A step: the camera stays, and jumps to the next key at its time.
    Hold,
    /// A straight line at constant speed.
    Linear,
    /// A centripetal Catmull-Rom spline.
    CatmullRom,
    /// A cubic Hermite curve of the position with given tangents at its start and its end: derivatives by the curve
    /// parameter, which runs from 0 to 1 at a constant rate. All other properties use `CatmullRom`.
    Hermite(D, D),
}

/// The timing of a whole path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraPathTiming {
    /// How the times of the keys between the first and the last are chosen.
    pub speed: Speed,
    /// Whether the last key repeats the first one and the path loops without a seam.
    pub closed: bool,
    /// Seconds in which the camera accelerates from rest at the start; 0 for none.
    pub ease_in: f64,
    /// Seconds in which it decelerates to rest at the end; 0 for none.
    pub ease_out: f64,
}

/// How the time of a key is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Speed {
    /// The key's time.
    ByKeys,
    /// Proportional to the arc length up to it: the camera moves at constant speed from the first key's time to the
    /// last key's. Segments without motion keep the duration that their keys give.
    Constant,
}

impl CameraPathTiming {
    /// Every key at its time, from the first to the last.
    pub const BY_KEYS: CameraPathTiming = CameraPathTiming {
        speed: Speed::ByKeys,
        closed: false,
        ease_in: 0.0,
        ease_out: 0.0,
    };
}

impl Segment {
    /// A segment without easing.
    pub fn of(interpolation: Interpolation) -> Segment {
        Segment {
            interpolation,
            ease_in: false,
            ease_out: false,
        }
    }

    /// The segment of all other properties: tangents are given for the position alone.
    pub(super) fn without_tangents<D>(&self) -> Segment<D> {
        Segment {
            interpolation: match self.interpolation {
                Interpolation::Hold => Interpolation::Hold,
                Interpolation::Linear => Interpolation::Linear,
                Interpolation::CatmullRom | Interpolation::Hermite(..) => Interpolation::CatmullRom,
            },
            ease_in: self.ease_in,
            ease_out: self.ease_out,
        }
    }
}
