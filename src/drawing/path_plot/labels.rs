//! Placement of labels without overlap.

use super::layout::px;
use super::panel::SheetPoint;

/// The rectangles that are taken, and a search for free ones.
#[derive(Debug)]
pub(super) struct Labels {
    /// The corners of the rectangle that contains all labels.
    corners: [SheetPoint; 2],
    taken: Vec<Taken>,
}

/// A rectangle around `middle` with half extents `half`, in units of the sheet.
#[derive(Clone, Copy, Debug)]
struct Taken {
    middle: SheetPoint,
    half: SheetPoint,
}

impl Taken {
    fn meets(&self, other: &Taken) -> bool {
        (self.middle.0 - other.middle.0).abs() < self.half.0 + other.half.0
            && (self.middle.1 - other.middle.1).abs() < self.half.1 + other.half.1
    }
}

/// The half extents of a text of `height` pixels.
pub(super) fn half_size(text: &str, height: u32) -> SheetPoint {
    let letters = text.chars().count() as u32;
    ((px(height) * letters / 4) as i32, (px(height) / 2) as i32)
}

impl Labels {
    /// Labels between an upper left and a lower right corner.
    pub(super) fn within(corners: [SheetPoint; 2]) -> Labels {
        Labels {
            corners,
            taken: Vec::new(),
        }
    }

    /// Reserves a rectangle.
    pub(super) fn take(&mut self, middle: SheetPoint, half: SheetPoint) {
        self.taken.push(Taken { middle, half });
    }

    /// Takes a free rectangle beside a point, `away` from it, and returns its middle; none if there is no room.
    pub(super) fn beside(
        &mut self,
        what: SheetPoint,
        away: i32,
        half: SheetPoint,
    ) -> Option<SheetPoint> {
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

    /// Whether a rectangle overlaps none that is taken.
    pub(super) fn is_free(&self, middle: SheetPoint, half: SheetPoint) -> bool {
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
        let places: Vec<SheetPoint> =
            std::iter::from_fn(|| labels.beside((0, 0), 15, (20, 10))).collect();
        assert_eq!(places, [(35, 0), (-35, 0), (0, -25)]);
    }
}
