/// How a path gets up to its speed and comes to rest: the share of the way that is done at a share of the time.
/// The speed rises evenly, stays, and falls evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramp {
    /// The share of the time in which it rises.
    rise: f64,
    /// The share in which it falls; both together at most 1.
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

    /// The speed between rise and fall; 1 is the whole way in the whole time.
    fn top_speed(self) -> f64 {
        1.0 / (1.0 - 0.5 * (self.rise + self.fall))
    }

    /// The share of the way done at `time`, from 0 at 0 to 1 at 1.
    pub(super) fn way(self, time: f64) -> f64 {
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

    /// When a share of the way is done: what [`Ramp::way`] undoes.
    pub(super) fn time(self, way: f64) -> f64 {
        let speed = self.top_speed();
        let left = 1.0 - way;
        if way < 0.5 * speed * self.rise {
            (2.0 * way * self.rise / speed).sqrt()
        } else if left < 0.5 * speed * self.fall {
            1.0 - (2.0 * left * self.fall / speed).sqrt()
        } else {
            way / speed + 0.5 * self.rise
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
            assert_eq!((ramp.way(0.0), ramp.way(1.0)), (0.0, 1.0));
            let h = 1e-6;
            let speed = |time: f64| (ramp.way(time + h) - ramp.way(time - h)) / (2.0 * h);
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
                assert!((ramp.time(ramp.way(time)) - time).abs() < 1e-12);
            }
        }
    }
}
