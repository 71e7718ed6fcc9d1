//! What preflight warns of.

use super::FrameRuns;
use glam::DVec3;
use std::fmt;
use thiserror::Error;

/// A warning, and the frames that it is about.
#[derive(Clone, Debug, PartialEq)]
pub struct PathWarning {
    /// The frames.
    pub frames: FrameRuns,
    /// What is wrong with them.
    pub kind: WarningKind,
}

/// What may be wrong with frames of a path. `frame` is the worst of them.
///
/// A step belongs to the frame that it leaves; that from the last frame of a closed path leads to the first.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum WarningKind {
    /// The camera is inside a solid object: a wall, a statue, a ball.
    #[error("the camera is inside a solid object, {} m deep at frame {frame}", Short(*depth))]
    InsideSolid {
        /// The worst frame.
        frame: u32,
        /// The distance to the nearest surface, in metres.
        depth: f64,
    },
    /// No ray of the camera meets a surface.
    #[error(
        "the camera sees nothing of the scene, which is around {}: turn or move it, or check the units and axes",
        Point(*scene)
    )]
    SeesNothing {
        /// The middle of most of the scene, in world coordinates.
        scene: DVec3,
    },
    /// There is nothing to see.
    #[error("the scene has no surfaces, so only the background is seen: add `objects`")]
    EmptyScene,
    /// A path of several keyframes that lasts no more than a frame.
    #[error(
        "the path lasts {} s, less than a frame at {} per second, in spite of {keys} keyframes; check `time` and `fps`",
        Short(*duration), Short(*fps)
    )]
    ShorterThanFrame {
        /// From the first keyframe to the last, in seconds.
        duration: f64,
        /// Frames per second.
        fps: f64,
        /// How many keyframes there are.
        keys: usize,
    },
    /// Keyframes that are closer than frames, between which the camera leaps.
    #[error(
        "keyframes[{key}] and keyframes[{}] are {} s apart, less than a frame ({} s), so the camera leaps; \
         for a cut, set `interpolation: hold` of the first, else move one",
        key + 1, Short(*seconds), Short(*frame_seconds)
    )]
    KeysWithinFrame {
        /// The index of the first of the two that are closest.
        key: usize,
        /// The time between them.
        seconds: f64,
        /// That between frames.
        frame_seconds: f64,
    },
    /// There is a surface between the camera of each frame and that of the next.
    #[error("the camera crosses a surface on the way to the next frame")]
    CrossesSurface,
    /// The camera is too close to a surface.
    #[error("the camera is closer than {} m to a surface: {} m at frame {frame}", Short(*near), Short(*distance))]
    NearSurface {
        /// The worst frame.
        frame: u32,
        /// The distance to the nearest surface, in metres.
        distance: f64,
        /// The distance that surfaces should have, in metres.
        near: f64,
    },
    /// The camera is much faster than elsewhere.
    #[error(
        "the camera's speed spikes to {} m/s at frame {frame}; its median is {} m/s",
        Short(*speed), Short(*median)
    )]
    SpeedSpike {
        /// The worst frame.
        frame: u32,
        /// The speed there, in metres per second.
        speed: f64,
        /// The median speed of the frames in which the camera moves.
        median: f64,
    },
    /// The camera's velocity changes abruptly: a corner, or a start without easing.
    #[error(
        "the camera's velocity jumps by {} m/s at frame {frame}; its median speed is {} m/s",
        Short(*jump), Short(*median)
    )]
    VelocityJump {
        /// The worst frame.
        frame: u32,
        /// The length of the change of the velocity, in metres per second.
        jump: f64,
        /// The median speed of the frames in which the camera moves.
        median: f64,
    },
    /// The camera's angular velocity changes abruptly.
    #[error(
        "the camera's angular velocity jumps by {} degrees/s at frame {frame}",
        Short(jump.to_degrees())
    )]
    AngularVelocityJump {
        /// The worst frame.
        frame: u32,
        /// The length of the change of the angular velocity, in radians per second.
        jump: f64,
    },
    /// A [`WarningKind::VelocityJump`] at the seam of a closed path.
    #[error(
        "the camera's velocity jumps by {} m/s where the path closes; its median speed is {} m/s",
        Short(*jump), Short(*median)
    )]
    VelocityJumpAtSeam {
        /// The length of the change of the velocity, in metres per second.
        jump: f64,
        /// The median speed of the frames in which the camera moves.
        median: f64,
    },
    /// A [`WarningKind::AngularVelocityJump`] at the seam of a closed path.
    #[error(
        "the camera's angular velocity jumps by {} degrees/s where the path closes",
        Short(jump.to_degrees())
    )]
    AngularVelocityJumpAtSeam {
        /// The length of the change of the angular velocity, in radians per second.
        jump: f64,
    },
    /// The camera keeps +Y up and looks almost straight up or down, so that its picture spins.
    #[error(
        "the picture spins by {} degrees to the next frame at frame {frame}: the camera keeps +Y up and \
         looks within {} degrees of straight up or down",
        Short(turn.to_degrees()), Short(from_vertical.to_degrees())
    )]
    SpinsNearVertical {
        /// The worst frame.
        frame: u32,
        /// The turn of the camera's heading to the next frame, in radians.
        turn: f64,
        /// The angle between where it looks and the vertical, in this frame or the next, in radians.
        from_vertical: f64,
    },
    /// The image moves so fast that the eye sees separate frames, not a motion.
    #[error(
        "the image moves by {} of {width} pixels per frame at frame {frame}: it crosses the picture in {} s, \
         and strobes below {} s",
        Short(*pixels), Short(*seconds), Short(*least_seconds)
    )]
    Strobing {
        /// The worst frame.
        frame: u32,
        /// The median motion of the image to the next frame; at most `width`.
        pixels: f64,
        /// The width of the picture, in pixels.
        width: f64,
        /// The time to cross the picture, in seconds.
        seconds: f64,
        /// The least time that does not strobe at the frame rate of the path, in seconds.
        least_seconds: f64,
    },
    /// The last frame of a path that is not closed shows the same as the first.
    #[error("the last frame repeats the first; if the video loops, `closed: true` drops it")]
    RepeatsFirstFrame,
}

/// A frame and a measure of it; the greatest is the worst.
pub(super) type Measured = (usize, f64);

impl PathWarning {
    /// A warning about frames in rising order, whose `kind` is made from the worst of them; none without frames.
    pub(super) fn of(
        found: &[Measured],
        kind: impl FnOnce(u32, f64) -> WarningKind,
    ) -> Option<PathWarning> {
        // Of equal measures the first frame is the worst.
        let worse = |a: Measured, b: Measured| if b.1 > a.1 { b } else { a };
        let (frame, worst) = found.iter().copied().reduce(worse)?;
        Some(PathWarning {
            frames: FrameRuns::of(found.iter().map(|(frame, _)| *frame as u32)),
            kind: kind(frame as u32, worst),
        })
    }
}

impl fmt::Display for PathWarning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.frames, self.kind)
    }
}

/// Displays a number with two significant digits, or with all up to nine before the point.
pub(super) struct Short(pub(super) f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.0.abs() >= 1e9 {
            return write!(f, "{:.1e}", self.0);
        }
        let decimals = match self.0 {
            x if x.is_normal() => (1.0 - x.abs().log10().floor()).clamp(0.0, 30.0) as usize,
            _ => 0,
        };
        write!(f, "{:.decimals$}", self.0)
    }
}

/// Displays a point, in millimetres or, near 0, to two digits.
pub(super) struct Point(pub(super) DVec3);

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [x, y, z] = self.0.to_array().map(|x| match x.abs() < 1e-3 && x != 0.0 {
            true => format!("{x:.1e}"),
            false => format!("{}", (x * 1e3).round() / 1e3),
        });
        write!(f, "({x}, {y}, {z})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (number, text) in [
            (0.0, "0"),
            (0.1, "0.10"),
            (0.00123, "0.0012"),
            (5.04, "5.0"),
            (38.4, "38"),
            (1280.0, "1280"),
            (-1.234e300, "-1.2e300"),
        ] {
            assert_eq!(Short(number).to_string(), text);
        }
    }

    #[test]
    fn the_worst_frame_is_named() {
        let kind = |frame, distance: f64| WarningKind::NearSurface {
            frame,
            distance: -distance,
            near: 0.1,
        };
        let found = [(3, -0.05), (4, -0.02), (5, -0.02), (9, -0.08)];
        let warning = PathWarning::of(&found, kind).expect("four frames");
        assert_eq!(
            warning.to_string(),
            "frames 3-5 and 9: the camera is closer than 0.10 m to a surface: 0.020 m at frame 4"
        );
        assert_eq!(PathWarning::of(&[], kind), None);
    }
}
