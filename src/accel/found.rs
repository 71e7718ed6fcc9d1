use super::lanes::{Lanes, Packet, RayLanes};
use super::rounding::triangle_growth;
use super::simd::{Floats, Machine};
use super::triangle_block::{PADDING, TriangleBlock, is_in_the_way, take_nearer};
use super::watertight::ShearedRays;
use super::{NOTHING, PACKET, WIDTH};
use crate::geometry::{Hit, Sphere, TrianglePlane};
use crate::math::Ray;

/// So many rays that pass through a triangle meet its plane together, fewer one by one.
const MANY: u32 = 5;

/// What the rays have met, and how far each still looks: less than nothing if it is done.
pub(super) struct Found {
    pub(super) best: [Hit; PACKET],
    pub(super) limits: [f32; PACKET],
}

impl Found {
    #[inline(always)]
    pub(super) fn new<const ANY: bool>(packet: &Packet) -> Found {
        let mut found = Found {
            best: [NOTHING; PACKET],
            limits: [f32::MAX; PACKET],
        };
        for (lane, limit) in found.limits.iter_mut().enumerate() {
            if packet.used >> lane & 1 == 0 {
                *limit = -1.0;
            } else if ANY {
                *limit = packet.t_max[lane] * PADDING;
            }
        }
        found
    }

    /// How far any ray still looks.
    #[inline(always)]
    pub(super) fn farthest<M: Machine>(&self) -> f32 {
        M::Many::load(&self.limits).greatest()
    }

    #[inline(always)]
    fn meet<const ANY: bool>(&mut self, ray: &Ray, number: usize, t: f64, primitive: u32) {
        if !ANY {
            take_nearer(ray, t, primitive, &mut self.best[number]);
            self.limits[number] = self.best[number].t as f32 * PADDING;
        } else if is_in_the_way(ray, t, primitive) {
            self.best[number] = Hit { t, primitive };
            self.limits[number] = -1.0;
        }
    }

    /// Those rays of a packet whose bits are set meet a sphere.
    #[inline(always)]
    pub(super) fn meet_sphere<M: Machine, const ANY: bool>(
        &mut self,
        sphere: &Sphere,
        primitive: u32,
        lanes: &RayLanes<'_, M::Many>,
        some: u32,
    ) {
        let some = some & lanes.pass_through(sphere);
        for number in Lanes(some) {
            let ray = lanes.packet.ray(number);
            if let Some(t) = sphere.intersect(&ray) {
                self.meet::<ANY>(&ray, number, t, primitive);
            }
        }
    }

    /// Those rays of a packet whose bits are set meet those triangles of a block whose bits are set;
    /// returns whether a limit may have changed.
    #[inline(always)]
    pub(super) fn meet_together<M: Machine, const ANY: bool>(
        &mut self,
        block: &TriangleBlock,
        mut triangles: u32,
        lanes: &RayLanes<'_, M::Many>,
        some: u32,
    ) -> bool {
        let mut changed = false;
        let reach = lanes.reach.store();
        while triangles != 0 {
            let lane = triangles.trailing_zeros() as usize % WIDTH;
            triangles &= triangles - 1;
            let primitive = block.ids()[lane];
            let corners = block.one::<M::Many, PACKET>(lane, lanes.axes);
            let passed = some & lanes.sheared.pass(&corners, M::Many::load(&self.limits));
            if passed == 0 {
                continue;
            }
            changed = true;
            let plane = TrianglePlane::through(block.triangle(lane));
            let together = if passed.count_ones() >= MANY {
                Some(lanes.meet(&plane))
            } else {
                None
            };
            for number in Lanes(passed) {
                let (mut t, outside) = match &together {
                    Some((distances, outside)) => (distances[number], outside[number]),
                    None => lanes.meet_one(&plane, number),
                };
                let reach = f64::from(reach[number]);
                // False for NaN.
                let is_inside = outside <= triangle_growth(reach);
                if !is_inside {
                    let (origin, direction) = lanes.line(number);
                    let growth = triangle_growth(reach + plane.magnitude());
                    t = plane.distance_in_box(origin, direction, growth, t);
                }
                self.meet::<ANY>(&lanes.packet.ray(number), number, t, primitive);
            }
        }
        changed
    }

    /// As [`Found::meet_together`], with all triangles, one ray after the other.
    #[inline(always)]
    pub(super) fn meet_one_by_one<M: Machine, const ANY: bool>(
        &mut self,
        block: &TriangleBlock,
        lanes: &RayLanes<'_, M::Many>,
        some: u32,
    ) -> bool {
        let mut changed = false;
        let (axes, magnitude) = (lanes.axes, lanes.magnitude);
        for number in Lanes(some) {
            let ray = &lanes.packet.ray(number);
            if self.limits[number] < 0.0 {
                continue;
            }
            let sheared = ShearedRays::<M::One>::splat(ray, axes, magnitude);
            if ANY {
                if block.occludes(ray, axes, &sheared) {
                    self.best[number].primitive = 0;
                    self.limits[number] = -1.0;
                    changed = true;
                }
            } else {
                let before = self.best[number];
                block.closest(ray, axes, &sheared, &mut self.best[number]);
                self.limits[number] = self.best[number].t as f32 * PADDING;
                changed |= before != self.best[number];
            }
        }
        changed
    }
}
