use super::layout::px;
use super::panel::Place;

/// Finds places for texts where nothing else is.
#[derive(Debug)]
pub(super) struct Labels {
    /// The corners of the rectangle that all stay in.
    corners: [Place; 2],
    taken: Vec<Taken>,
}

/// All that is no farther from `middle` than `half` of its size, in units of the sheet.
#[derive(Clone, Copy, Debug)]
struct Taken {
    middle: Place,
    half: Place,
}

impl Taken {
    fn meets(&self, other: &Taken) -> bool {
        (self.middle.0 - other.middle.0).abs() < self.half.0 + other.half.0
            && (self.middle.1 - other.middle.1).abs() < self.half.1 + other.half.1
    }
}

/// Half of the size of a text that is so many pixels high.
pub(super) fn half_size(text: &str, height: u32) -> Place {
    let letters = text.chars().count() as u32;
    ((px(height) * letters / 4) as i32, (px(height) / 2) as i32)
}

impl Labels {
    /// For texts between an upper left and a lower right corner.
    pub(super) fn within(corners: [Place; 2]) -> Labels {
        Labels {
            corners,
            taken: Vec::new(),
        }
    }

    /// Keeps a place free of what is placed later.
    pub(super) fn take(&mut self, middle: Place, half: Place) {
        self.taken.push(Taken { middle, half });
    }

    /// The middle of a free place beside something, of which `away` is half the size; none if there is none.
    pub(super) fn beside(&mut self, what: Place, away: i32, half: Place) -> Option<Place> {
        let (right, down) = (away + half.0, away + half.1);
        let around = [
            (right, 0),
            (-right, 0),
            (0, -down),
            (0, down),
            (right, -down),
            (right, down),
            (-right, -down),
            (-right, down),
        ];
        let mut places = around.iter().map(|(x, y)| Taken {
            middle: (what.0 + x, what.1 + y),
            half,
        });
        let free =
            places.find(|place| self.holds(place) && self.is_free(place.middle, place.half))?;
        self.taken.push(free);
        Some(free.middle)
    }

    /// Whether a place meets none that is kept.
    pub(super) fn is_free(&self, middle: Place, half: Place) -> bool {
        let place = Taken { middle, half };
        !self.taken.iter().any(|taken| taken.meets(&place))
    }

    fn holds(&self, place: &Taken) -> bool {
        let ((x, y), (width, height)) = (place.middle, place.half);
        let [from, to] = self.corners;
        from.0 <= x - width && x + width <= to.0 && from.1 <= y - height && y + height <= to.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_used_once() {
        let mut labels = Labels::within([(-100, -100), (60, 20)]);
        labels.take((0, 0), (5, 5));
        let places: Vec<Place> =
            std::iter::from_fn(|| labels.beside((0, 0), 15, (20, 10))).collect();
        assert_eq!(places, [(35, 0), (-35, 0), (0, -25)]);
    }
}
