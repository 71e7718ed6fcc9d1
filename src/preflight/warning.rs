use super::FrameRuns;
use std::fmt;
use thiserror::Error;

/// Something odd, and the frames that it is about.
#[derive(Clone, Debug, PartialEq)]
pub struct PathWarning {
    /// The frames.
    pub frames: FrameRuns,
    /// What is odd about them.
    pub kind: WarningKind,
}

/// What may be odd about frames of a path. `frame` is the one where it is worst.
///
/// A step is counted with the frame that it leads away from, after the last frame of a closed path to the first.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum WarningKind {
    /// The camera is in a wall, a statue, a ball.
    #[error("the camera is inside a body, {} m deep at frame {frame}", Short(*depth))]
    InsideSolid {
        /// The worst frame.
        frame: u32,
        /// The distance to the nearest surface, in metres.
        depth: f64,
    },
    /// There is a surface between the camera of each frame and that of the next.
    #[error("the camera passes through a surface on the way to the next frame")]
    CrossesSurface,
    /// The camera is too close to a surface.
    #[error("a surface is nearer than {} m: {} m at frame {frame}", Short(*near), Short(*distance))]
    NearSurface {
        /// The worst frame.
        frame: u32,
        /// The distance to the nearest surface, in metres.
        distance: f64,
        /// The distance that surfaces should have, in metres.
        near: f64,
    },
    /// The camera moves much farther from one frame to the next than elsewhere.
    #[error(
        "the camera is much faster than elsewhere: {} m/s at frame {frame}, mostly {} m/s",
        Short(*speed), Short(*usual)
    )]
    SpeedSpike {
        /// The worst frame.
        frame: u32,
        /// The speed there, in metres per second.
        speed: f64,
        /// The median speed of the frames in which the camera moves.
        usual: f64,
    },
    /// The camera changes its velocity all at once: a corner, or a start without easing.
    #[error(
        "the camera's velocity jumps, by {} m/s at frame {frame}, where {} m/s is its usual speed",
        Short(*jump), Short(*usual)
    )]
    VelocityJump {
        /// The worst frame.
        frame: u32,
        /// The length of the change of the velocity, in metres per second.
        jump: f64,
        /// The median speed of the frames in which the camera moves.
        usual: f64,
    },
    /// The camera changes how it turns all at once.
    #[error(
        "the camera's turning jumps, by {} degrees/s at frame {frame}",
        Short(jump.to_degrees())
    )]
    AngularVelocityJump {
        /// The worst frame.
        frame: u32,
        /// The length of the change of the angular velocity, in radians per second.
        jump: f64,
    },
    /// A [`WarningKind::VelocityJump`] where a closed path goes on at its first frame.
    #[error(
        "where the path closes the camera's velocity jumps, by {} m/s, where {} m/s is its usual speed",
        Short(*jump), Short(*usual)
    )]
    VelocityJumpAtSeam {
        /// The length of the change of the velocity, in metres per second.
        jump: f64,
        /// The median speed of the frames in which the camera moves.
        usual: f64,
    },
    /// A [`WarningKind::AngularVelocityJump`] where a closed path goes on at its first frame.
    #[error(
        "where the path closes the camera's turning jumps, by {} degrees/s",
        Short(jump.to_degrees())
    )]
    AngularVelocityJumpAtSeam {
        /// The length of the change of the angular velocity, in radians per second.
        jump: f64,
    },
    /// The camera, which keeps +Y up, looks almost straight up or down, and its picture spins.
    #[error(
        "the picture spins, by {} degrees to the next frame at frame {frame}: the camera keeps +Y up and \
         looks {} degrees from straight up or down",
        Short(turn.to_degrees()), Short(from_vertical.to_degrees())
    )]
    SpinsNearVertical {
        /// The worst frame.
        frame: u32,
        /// How far the camera's heading turns to the next frame, in radians.
        turn: f64,
        /// The angle between where it looks and the vertical, in this frame or the next, in radians.
        from_vertical: f64,
    },
    /// What is seen is somewhere else in the next frame: no longer a motion to the eye.
    #[error(
        "what is seen moves by {} pixels a frame, of {width}, at frame {frame}: it crosses the picture in {} s, \
         and strobes below {} s",
        Short(*pixels), Short(*seconds), Short(*least_seconds)
    )]
    Strobing {
        /// The worst frame.
        frame: u32,
        /// How far half of what is seen moves, or farther, to the next frame; at most `width`.
        pixels: f64,
        /// The width of the picture, in pixels.
        width: f64,
        /// How long it would take to cross the picture.
        seconds: f64,
        /// How long it should take, at the frame rate of the path.
        least_seconds: f64,
    },
    /// The last frame of a path that is not closed is the first one once more.
    #[error(
        "the last frame repeats the first; if the video runs in a loop, `closed: true` drops it"
    )]
    RepeatsFirstFrame,
}

/// A frame and a number, the greater the worse it is.
pub(super) type Measured = (usize, f64);

impl PathWarning {
    /// What some frames, rising, have in common; none of no frames. The kind is made of the worst.
    pub(super) fn of(
        found: &[Measured],
        kind: impl FnOnce(u32, f64) -> WarningKind,
    ) -> Option<PathWarning> {
        // Of equals the first.
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

/// Writes a number with two digits, or more where they stand before the point, up to nine.
struct Short(f64);

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
        let finding = PathWarning::of(&found, kind).expect("four frames");
        assert_eq!(
            finding.to_string(),
            "frames 3-5 and 9: a surface is nearer than 0.10 m: 0.020 m at frame 4"
        );
        assert_eq!(PathWarning::of(&[], kind), None);
    }
}
