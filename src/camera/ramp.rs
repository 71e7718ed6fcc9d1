//! The speed ramp of a whole path: `ease_in` and `ease_out`.

/// Maps a fraction of the time to the fraction of the path that is done: the speed rises linearly, stays, and falls
/// linearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramp {
    /// The fraction of the time in which the speed rises.
    rise: f64,
    /// The fraction in which it falls; both together at most 1.
    fall: f64,
}

impl Ramp {
    /// `rise` and `fall` are together at most 1, but for rounding.
    pub(super) fn new(rise: f64, fall: f64) -> Ramp {
        let fall = fall.min(1.0 - rise).max(0.0);
        Ramp { rise, fall }
    }

    /// Whether the speed is the same all the time.
    pub(super) fn is_flat(self) -> bool {
        self.rise == 0.0 && self.fall == 0.0
    }

    /// The speed between rise and fall; 1 is the whole path in the whole time.
    fn top_speed(self) -> f64 {
        1.0 / (1.0 - 0.5 * (self.rise + self.fall))
    }

    /// The fraction of the path that is done at `time`, from 0 at 0 to 1 at 1.
    pub(super) fn ease(self, time: f64) -> f64 {
        let speed = self.top_speed();
        if time < self.rise {
            0.5 * speed * time * time / self.rise
        } else if time > 1.0 - self.fall {
            let left = 1.0 - time;
            1.0 - 0.5 * speed * left * left / self.fall
        } else {
            speed * (time - 0.5 * self.rise)
        }
    }

    /// The inverse of [`Ramp::ease`]: when a fraction of the path is done.
    pub(super) fn inverse(self, progress: f64) -> f64 {
        let speed = self.top_speed();
        let left = 1.0 - progress;
        if progress < 0.5 * speed * self.rise {
            (2.0 * progress * self.rise / speed).sqrt()
        } else if left < 0.5 * speed * self.fall {
            1.0 - (2.0 * left * self.fall / speed).sqrt()
        } else {
            progress / speed + 0.5 * self.rise
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_rise_stay_and_fall_evenly() {
        for (rise, fall) in [
            (0.0, 0.0),
            (0.25, 0.0),
            (0.0, 0.4),
            (0.2, 0.3),
            (0.5, 0.5),
            (1.0, 0.0),
            (1.0 / 3.0, 0.2 / 0.3),
        ] {
            let ramp = Ramp::new(rise, fall);
            assert_eq!((ramp.ease(0.0), ramp.ease(1.0)), (0.0, 1.0));
            let h = 1e-6;
            let speed = |time: f64| (ramp.ease(time + h) - ramp.ease(time - h)) / (2.0 * h);
            for i in 1..1000 {
                let time = f64::from(i) / 1000.0;
                let expected = ramp.top_speed()
                    * if time < rise { time / rise } else { 1.0 }.min(if time > 1.0 - fall {
                        (1.0 - time) / fall
                    } else {
                        1.0
                    });
                assert!(
                    (speed(time) - expected).abs() < 1e-5,
                    "{rise} {fall} {time}"
                );
                assert!((ramp.inverse(ramp.ease(time)) - time).abs() < 1e-12);
            }
        }
    }
}
