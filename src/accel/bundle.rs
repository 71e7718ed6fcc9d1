use super::lanes::{ALL, RayLanes, size};
use super::node::{Node, SMALLEST};
use super::rounding::GROWTH;
use super::simd::Floats;
use super::{PACKET, WIDTH};

/// What boxes need to know of rays that run into one octant: each ray, and the bundle as a whole.
pub(super) struct Bundle<V> {
    /// Axis by axis: t = plane * inverse - offset.
    inverse: [V; 3],
    near_offset: [V; 3],
    far_offset: [V; 3],
    /// The plane through which rays enter a box, for each axis, and through which they leave.
    near: [usize; 3],
    far: [usize; 3],
    /// The origin farthest along the direction, and the one farthest behind, grown apart.
    last_origin: [f32; 3],
    first_origin: [f32; 3],
    /// The least and the greatest reciprocal.
    least_inverse: [f32; 3],
    greatest_inverse: [f32; 3],
}

impl<V: Floats<PACKET>> Bundle<V> {
    /// None if the rays do not run into the same octant.
    #[inline(always)]
    pub(super) fn new(lanes: &RayLanes<V>) -> Option<Bundle<V>> {
        let (origin, direction) = (lanes.origin, lanes.direction);
        let zero = V::splat(0.0);
        let down = [
            direction[0].lt(zero),
            direction[1].lt(zero),
            direction[2].lt(zero),
        ];
        for bits in down {
            if bits != 0 && bits != ALL {
                return None;
            }
        }
        let sizes = [size(direction[0]), size(direction[1]), size(direction[2])];
        let smallest = sizes[0].max(sizes[1]).max(sizes[2]).mul(V::splat(SMALLEST));
        let growth = lanes.reach.mul(V::splat(GROWTH));
        let grown = growth.greatest();
        let mut bundle = Bundle {
            inverse: [zero; 3],
            near_offset: [zero; 3],
            far_offset: [zero; 3],
            near: [0; 3],
            far: [0; 3],
            last_origin: [0.0; 3],
            first_origin: [0.0; 3],
            least_inverse: [0.0; 3],
            greatest_inverse: [0.0; 3],
        };
        for axis in 0..3 {
            let down = down[axis] != 0;
            let slowest = sizes[axis].max(smallest);
            let inverse = V::splat(if down { -1.0 } else { 1.0 }).div(slowest);
            let (center, around) = (origin[axis].mul(inverse), growth.mul(size(inverse)));
            bundle.inverse[axis] = inverse;
            bundle.near_offset[axis] = center.add(around);
            bundle.far_offset[axis] = center.sub(around);
            // The planes of least coordinates come first, those of greatest three after.
            bundle.near[axis] = axis + 3 * usize::from(down);
            bundle.far[axis] = axis + 3 * usize::from(!down);
            let lowest = origin[axis].least() - grown;
            let highest = origin[axis].greatest() + grown;
            let [first, last] = if down {
                [highest, lowest]
            } else {
                [lowest, highest]
            };
            bundle.first_origin[axis] = first;
            bundle.last_origin[axis] = last;
            bundle.least_inverse[axis] = inverse.least();
            bundle.greatest_inverse[axis] = inverse.greatest();
        }
        Some(bundle)
    }

    /// As [`Node::enter`], for the bundle as a whole: before the first ray enters a box, and after the
    /// last one leaves it.
    #[inline(always)]
    pub(super) fn enter_bundle<W: Floats<WIDTH>>(&self, planes: &[W; 6], farthest: f32) -> (W, W) {
        let mut near = W::splat(0.0);
        let mut far = W::splat(farthest);
        for axis in 0..3 {
            let least = W::splat(self.least_inverse[axis]);
            let greatest = W::splat(self.greatest_inverse[axis]);
            let entry = planes[self.near[axis]].sub(W::splat(self.last_origin[axis]));
            let exit = planes[self.far[axis]].sub(W::splat(self.first_origin[axis]));
            near = entry.mul(least).min(entry.mul(greatest)).max(near);
            far = exit.mul(least).max(exit.mul(greatest)).min(far);
        }
        (near, far)
    }

    /// A bit for each ray that may enter one of the node's boxes within its limit.
    #[inline(always)]
    pub(super) fn enter(&self, node: &Node, child: usize, limits: V) -> u32 {
        let mut near = V::splat(0.0);
        let mut far = limits;
        for axis in 0..3 {
            let inverse = self.inverse[axis];
            let entry = V::splat(node.planes[self.near[axis]][child]);
            let exit = V::splat(node.planes[self.far[axis]][child]);
            near = entry.mul_sub(inverse, self.near_offset[axis]).max(near);
            far = exit.mul_sub(inverse, self.far_offset[axis]).min(far);
        }
        near.le(far)
    }
}
