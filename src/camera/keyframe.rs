use glam::{DQuat, DVec3};

/// Where the camera is at one time, and how it goes on from there.
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
    /// The way to the next key. The last key's is not used.
    pub segment: Segment,
}

/// Where a camera looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orientation {
    /// At a point in world coordinates, with +Y up and then rolled.
    LookAt {
        /// The point.
        target: DVec3,
        /// A turn about the camera's backward axis in radians, counter-clockwise as the camera's
        /// picture is seen from behind the camera: the picture turns clockwise.
        roll: f64,
    },
    /// Camera to world, a unit quaternion; without rotation the camera looks along -Z with +Y up.
    Rotation(DQuat),
    /// Turns in radians about the world's +Y, then the camera's right, then its backward axis, each
    /// counter-clockwise seen from the axis' tip: to the left, up, and tipped to the left.
    /// Angles beyond a whole turn count: from 0 to 2 pi is once around.
    YawPitchRoll(DVec3),
}

/// The way from a key to the next, whose derivatives are given by `D`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment<D = DVec3> {
    /// What it looks like.
    pub interpolation: Interpolation<D>,
    /// Whether the camera starts from rest.
    pub ease_in: bool,
    /// Whether the camera comes to rest at its end.
    pub ease_out: bool,
}

/// What the way from a key to the next looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interpolation<D = DVec3> {
    /// There is none: the camera stays, and is at the next key at its time.
    Hold,
    /// Straight, at an even timing.
    Linear,
    /// A smooth curve without stops.
    CatmullRom,
    /// The position goes along a cubic with given derivatives by the share of the way, at its start
    /// and its end, at a pace that is even in that share; all else goes as with `CatmullRom`.
    Hermite(D, D),
}

/// How all of a path is walked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathTiming {
    /// What decides when the camera passes the keys between the first and the last.
    pub speed: Speed,
    /// Whether the path ends where it starts, at its last key, and goes on there without a seam.
    pub closed: bool,
    /// In so many seconds the camera gets from rest to its speed, evenly; 0 for at once.
    pub ease_in: f64,
    /// In so many seconds it comes to rest at the end.
    pub ease_out: f64,
}

/// What decides when the camera passes a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Speed {
    /// The key's time.
    ByKeys,
    /// Its place on the way: the camera moves at one speed wherever it moves, from the first key's
    /// time to the last key's. Where it stands it stands for as long as the keys say.
    Constant,
}

impl PathTiming {
    /// Every key at its time, from the first to the last.
    pub const BY_KEYS: PathTiming = PathTiming {
        speed: Speed::ByKeys,
        closed: false,
        ease_in: 0.0,
        ease_out: 0.0,
    };
}

impl Segment {
    /// A segment of this shape that does not stop at its keys.
    pub fn of(interpolation: Interpolation) -> Segment {
        Segment {
            interpolation,
            ease_in: false,
            ease_out: false,
        }
    }

    /// How all but the position goes: derivatives are given of that alone.
    pub(super) fn beside_position<D>(&self) -> Segment<D> {
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
