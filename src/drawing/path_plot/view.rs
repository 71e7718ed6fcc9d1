//! Orthographic views along the axes of the world.

use glam::{DVec2, DVec3};

/// An orthographic view along one of the world's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    /// The axis that grows to the right of the page: 0 for x, 2 for z.
    pub(super) across: usize,
    /// The axis that runs along the page's height: 2 for z, which grows downwards, or 1 for y, which grows upwards.
    pub(super) along: usize,
    /// The view direction.
    pub(super) forward: DVec3,
}

impl View {
    /// From above, with -z up the page.
    pub(super) const PLAN: View = View {
        across: 0,
        along: 2,
        forward: DVec3::NEG_Y,
    };

    /// From the side, with x to the right.
    pub(super) const ELEVATION_OF_X: View = View {
        across: 0,
        along: 1,
        forward: DVec3::NEG_Z,
    };

    /// From the side, with z to the right.
    pub(super) const ELEVATION_OF_Z: View = View {
        across: 2,
        along: 1,
        forward: DVec3::X,
    };

    /// The coordinates of a point on the two axes of the page.
    pub(super) fn flat(&self, point: DVec3) -> DVec2 {
        DVec2::new(point[self.across], point[self.along])
    }

    /// The point with two coordinates on the page at a depth along the view direction.
    pub(super) fn at(&self, flat: DVec2, depth: f64) -> DVec3 {
        DVec3::AXES[self.across] * flat.x + DVec3::AXES[self.along] * flat.y + self.forward * depth
    }

    /// Whether the axis along the page's height grows downwards.
    pub(super) fn is_downward(&self) -> bool {
        *self == View::PLAN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_right_and_up_on_the_page_and_towards_the_reader_is_right_handed() {
        for view in [View::PLAN, View::ELEVATION_OF_X, View::ELEVATION_OF_Z] {
            let right = DVec3::AXES[view.across];
            let grows = if view.is_downward() { -1.0 } else { 1.0 };
            assert_eq!(right.cross(grows * DVec3::AXES[view.along]), -view.forward);
            let point = DVec3::new(1.0, 2.0, 3.0);
            assert_eq!(view.at(view.flat(point), point.dot(view.forward)), point);
        }
    }
}
