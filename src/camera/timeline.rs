//! Frames and their times.

/// The frames of a path and their times.
///
/// The first frame shows the first key, the last frame the last key; those between are equally spaced. A duration that
/// is not a whole number of frames is stretched to the nearest one, by at most half a frame. A closed path ends one
/// frame before its last key, which is its first frame again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timeline {
    /// Frames per second of the video.
    pub fps: f64,
    /// Time of the first key, in seconds.
    pub start: f64,
    /// Time of the last key, in seconds; not before `start`.
    pub end: f64,
    /// Whether the last key is the first again.
    pub closed: bool,
}

impl Timeline {
    /// The timeline from `start` whose duration is that to `end`, rounded to whole frames.
    pub fn of_whole_frames(fps: f64, start: f64, end: f64) -> Timeline {
        let steps = ((end - start) * fps).round();
        Timeline {
            fps,
            start,
            end: start + steps / fps,
            closed: false,
        }
    }

    /// How many frames there are; at least 1.
    pub fn frame_count(&self) -> u32 {
        match self.closed {
            true => self.steps().max(1),
            false => self.steps() + 1,
        }
    }

    /// Frames from the first key to the last.
    fn steps(&self) -> u32 {
        ((self.end - self.start) * self.fps).round() as u32
    }

    /// Evenly spread frames: the middles of `parts` equal parts of the path, at least 1; all frames if there are fewer.
    pub fn spread(&self, parts: u32) -> Vec<u32> {
        let count = self.frame_count();
        let parts = parts.min(count);
        let middle = |part: u32| u64::from(2 * part + 1) * u64::from(count) / u64::from(2 * parts);
        (0..parts).map(|part| middle(part) as u32).collect()
    }

    /// The time of frame `frame`, in seconds, from the frame's number alone.
    ///
    /// `frame` is below [`Timeline::frame_count`].
    pub fn time_of(&self, frame: u32) -> f64 {
        let steps = self.steps();
        if frame == 0 || frame == steps {
            return if frame == 0 { self.start } else { self.end };
        }
        let duration = self.end - self.start;
        /// Relative rounding of durations that are whole numbers of frames.
        const ROUNDING: f64 = 1e-9;
        if (duration * self.fps - f64::from(steps)).abs() <= ROUNDING * f64::from(steps) {
            // Without stretching, times do not depend on the end: frames stay bit-equal if keys are appended.
            return self.start + f64::from(frame) / self.fps;
        }
        self.start + duration * (f64::from(frame) / f64::from(steps))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_and_last_frame_land_on_the_keys() {
        for (fps, start, end, frames) in [
            (25.0, 0.0, 4.0, 101),
            (23.976, 1.0, 3.1, 51),
            (30.0, 2.0, 2.0, 1),
            (24.0, 0.1, 0.7, 15),
        ] {
            let timeline = Timeline {
                fps,
                start,
                end,
                closed: false,
            };
            assert_eq!(timeline.frame_count(), frames);
            assert_eq!(timeline.time_of(0), start);
            assert_eq!(timeline.time_of(frames - 1), end);
        }
    }

    #[test]
    fn frames_keep_their_times_where_the_end_is_put_off() {
        let [short, long] = [4.0, 5.5].map(|end| Timeline {
            fps: 24.0,
            start: 0.0,
            end,
            closed: false,
        });
        for frame in 0..96 {
            assert_eq!(short.time_of(frame), long.time_of(frame), "{frame}");
        }
    }

    #[test]
    fn a_closed_path_shows_its_first_key_once() {
        for (fps, end, frames) in [
            (25.0, 4.0, 100),
            (23.976, 3.1, 74),
            (24.0, 0.01, 1),
            (24.0, 0.0, 1),
        ] {
            let timeline = Timeline {
                fps,
                start: 0.0,
                end,
                closed: true,
            };
            assert_eq!(timeline.frame_count(), frames);
            let step = end / f64::from(frames);
            for frame in 0..frames {
                assert!((timeline.time_of(frame) - step * f64::from(frame)).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn frames_are_spread_over_the_path() {
        let spread = |count: u32, parts| {
            let timeline = Timeline {
                fps: 1.0,
                start: 0.0,
                end: f64::from(count - 1),
                closed: false,
            };
            timeline.spread(parts)
        };
        assert_eq!(spread(1, 12), [0]);
        assert_eq!(spread(3, 12), [0, 1, 2]);
        assert_eq!(spread(240, 12)[..3], [10, 30, 50]);
        assert_eq!(spread(240, 12)[11], 230);
    }

    #[test]
    fn frames_between_are_equally_spaced() {
        let timeline = Timeline {
            fps: 10.0,
            start: 1.0,
            end: 2.0,
            closed: false,
        };
        for frame in 0..=10 {
            assert!((timeline.time_of(frame) - (1.0 + f64::from(frame) / 10.0)).abs() < 1e-12);
        }
    }
}
