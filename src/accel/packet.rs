//! Sixteen rays through the tree together.
//!
//! Rays side by side pass through mostly the same boxes: those that the bundle as a whole misses are
//! left out eight at a time, the others are tested with one ray in each lane, and so are triangles.
//! Each ray finds what it would find alone.

use super::kernel::Machine;
use super::node::{Child, GROWTH, Node, ROOT, SMALLEST};
use super::simd::Floats;
use super::stack::STACK_SIZE;
use super::triangle_block::{PADDING, TriangleBlock, is_in_the_way, take_nearer};
use super::watertight::{LEAST_SLOPE, ShearedRays, permuted_axes, triangle_growth};
use super::{Bvh, NOTHING, WIDTH};
use crate::geometry::{Hit, Sphere, TrianglePlane};
use crate::math::Ray;
use glam::DVec3;

/// How many rays go through the tree together.
pub const PACKET: usize = 16;

/// With fewer rays in a block, one ray after the other meets all its triangles.
const FEW: u32 = 3;

/// What is still to be visited: a child, with a distance before which no ray enters it, and a bit for
/// each ray that does.
#[derive(Debug)]
pub(super) struct PacketStack {
    entries: Box<[(u64, u32); STACK_SIZE]>,
    len: usize,
}

impl Default for PacketStack {
    fn default() -> PacketStack {
        PacketStack {
            entries: Box::new([(0, 0); STACK_SIZE]),
            len: 0,
        }
    }
}

impl PacketStack {
    /// Pushes a child below all those after `first` that are nearer.
    #[inline(always)]
    fn insert(&mut self, first: usize, near: f32, child: u32, rays: u32) {
        // Distances are not negative, so their bits order like numbers.
        let key = u64::from(near.to_bits()) << 32 | u64::from(child);
        let mut place = self.len;
        while place > first && self.entries[(place - 1) % STACK_SIZE].0 < key {
            self.entries[place % STACK_SIZE] = self.entries[(place - 1) % STACK_SIZE];
            place -= 1;
        }
        self.entries[place % STACK_SIZE] = (key, rays);
        self.len += 1;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(f32, u32, u32)> {
        self.len = self.len.checked_sub(1)?;
        let (key, rays) = self.entries[self.len % STACK_SIZE];
        Some((f32::from_bits((key >> 32) as u32), key as u32, rays))
    }
}

/// The answers for up to sixteen rays: [`NOTHING`] for none; if `ANY`, anything else if something
/// lies in the ray's interval. Returns false, and leaves `hits` alone, if the rays do not all run
/// into the same octant along the same main axis.
#[inline(always)]
pub(super) fn walk_packet<M: Machine, const ANY: bool>(
    bvh: &Bvh,
    rays: &[Ray],
    hits: &mut [Hit],
    stack: &mut PacketStack,
) -> bool {
    let Some(packet) = Packet::<M::Many>::new(rays, bvh.magnitude) else {
        return false;
    };
    let mut found = Found {
        best: [NOTHING; PACKET],
        limits: [-1.0; PACKET],
    };
    for (limit, ray) in found.limits.iter_mut().zip(rays) {
        *limit = if ANY { ray.t_max * PADDING } else { f32::MAX };
    }
    let all = (1 << rays.len()) - 1;
    let mut farthest = found.farthest::<M>();
    if bvh.nodes.is_empty() {
        for (sphere, primitive) in bvh.spheres.iter().zip(bvh.first_sphere..) {
            found.meet_sphere::<ANY>(sphere, primitive, rays, all);
        }
        for block in &bvh.blocks {
            found.meet_together::<M, ANY>(block, rays, &packet, all, farthest);
        }
        hits.copy_from_slice(&found.best[..rays.len()]);
        return true;
    }
    stack.len = 0;
    let (mut next, mut some) = (ROOT, all);
    loop {
        match Child::unpack(next) {
            Child::Node(index) => {
                let node = &bvh.nodes[index as usize];
                let (near, far) = packet.enter_bundle(&node.planes::<M::One>(), farthest);
                let mut entered = near.le(far);
                let near = near.store();
                let limits = M::Many::load(&found.limits);
                let first = stack.len;
                while entered != 0 {
                    let lane = entered.trailing_zeros() as usize;
                    entered &= entered - 1;
                    let those = some & packet.enter(node, lane, limits);
                    if those != 0 {
                        stack.insert(first, near[lane], node.children[lane], those);
                    }
                }
            }
            Child::Triangles(index) => {
                let block = &bvh.blocks[index as usize];
                let changed = if some.count_ones() < FEW {
                    found.meet_one_by_one::<M, ANY>(block, rays, &packet, some)
                } else {
                    found.meet_together::<M, ANY>(block, rays, &packet, some, farthest)
                };
                if changed {
                    farthest = found.farthest::<M>();
                }
            }
            Child::Sphere(index) => {
                let sphere = &bvh.spheres[index as usize];
                found.meet_sphere::<ANY>(sphere, bvh.first_sphere + index, rays, some);
                farthest = found.farthest::<M>();
            }
        }
        loop {
            let Some((near, child, those)) = stack.pop().filter(|_| farthest >= 0.0) else {
                hits.copy_from_slice(&found.best[..rays.len()]);
                return true;
            };
            if near <= farthest {
                (next, some) = (child, those);
                break;
            }
        }
    }
}

/// What the rays have met, and how far each still looks: less than nothing if it is done.
struct Found {
    best: [Hit; PACKET],
    limits: [f32; PACKET],
}

impl Found {
    #[inline(always)]
    fn farthest<M: Machine>(&self) -> f32 {
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

    #[inline(always)]
    fn meet_sphere<const ANY: bool>(
        &mut self,
        sphere: &Sphere,
        primitive: u32,
        rays: &[Ray],
        mut some: u32,
    ) {
        while some != 0 {
            let number = some.trailing_zeros() as usize % PACKET;
            some &= some - 1;
            if let Some(t) = sphere.intersect(&rays[number]) {
                self.meet::<ANY>(&rays[number], number, t, primitive);
            }
        }
    }

    #[inline(always)]
    fn meet_together<M: Machine, const ANY: bool>(
        &mut self,
        block: &TriangleBlock,
        rays: &[Ray],
        packet: &Packet<M::Many>,
        some: u32,
        farthest: f32,
    ) -> bool {
        let mut changed = false;
        let (near, far) = packet.enter_bundle(&block.planes::<M::One>(), farthest);
        let mut entered = near.le(far);
        while entered != 0 {
            let lane = entered.trailing_zeros() as usize % WIDTH;
            entered &= entered - 1;
            let primitive = block.ids()[lane];
            let corners = block.one::<M::Many, PACKET>(lane, packet.axes);
            let mut passed = some & packet.sheared.pass(&corners, M::Many::load(&self.limits));
            if passed == 0 {
                continue;
            }
            changed = true;
            let plane = TrianglePlane::through(block.triangle(lane));
            let lines = &packet.lines;
            let (distances, outside) = lines.meet(&plane);
            while passed != 0 {
                let number = passed.trailing_zeros() as usize % PACKET;
                passed &= passed - 1;
                let mut t = distances[number];
                let growth = triangle_growth(lines.reach[number]);
                // False for NaN.
                let is_inside = outside[number] <= growth;
                if !is_inside {
                    let (origin, direction) = lines.line(number);
                    t = plane.distance_in_box(origin, direction, growth, t);
                }
                self.meet::<ANY>(&rays[number], number, t, primitive);
            }
        }
        changed
    }

    #[inline(always)]
    fn meet_one_by_one<M: Machine, const ANY: bool>(
        &mut self,
        block: &TriangleBlock,
        rays: &[Ray],
        packet: &Packet<M::Many>,
        mut some: u32,
    ) -> bool {
        let mut changed = false;
        let (axes, magnitude) = (packet.axes, packet.magnitude);
        while some != 0 {
            let number = some.trailing_zeros() as usize % PACKET;
            some &= some - 1;
            let ray = &rays[number];
            if self.limits[number] < 0.0 {
                continue;
            }
            let sheared = ShearedRays::<M::One>::splat(ray, axes, magnitude);
            if ANY {
                if block.occludes(ray, axes, &sheared, magnitude) {
                    self.best[number].primitive = 0;
                    self.limits[number] = -1.0;
                    changed = true;
                }
            } else {
                let before = self.best[number];
                block.closest(ray, axes, &sheared, magnitude, &mut self.best[number]);
                self.limits[number] = self.best[number].t as f32 * PADDING;
                changed |= before != self.best[number];
            }
        }
        changed
    }
}

/// Origins and directions, axis by axis; lanes that are not needed repeat the last ray.
struct Lines {
    origin: [[f32; PACKET]; 3],
    direction: [[f32; PACKET]; 3],
    /// The largest coordinates of each ray and the scene.
    reach: [f32; PACKET],
}

impl Lines {
    #[inline(always)]
    fn of(rays: &[Ray]) -> Lines {
        let mut lines = Lines {
            origin: [[0.0; PACKET]; 3],
            direction: [[0.0; PACKET]; 3],
            reach: [0.0; PACKET],
        };
        let mut ray = &rays[0];
        for lane in 0..PACKET {
            ray = rays.get(lane).unwrap_or(ray);
            for axis in 0..3 {
                lines.origin[axis][lane] = ray.origin[axis];
                lines.direction[axis][lane] = ray.direction[axis];
            }
        }
        lines
    }

    /// Where each meets the triangle's plane, and how far that is outside its box.
    #[inline(always)]
    fn meet(&self, triangle: &TrianglePlane) -> ([f64; PACKET], [f64; PACKET]) {
        let (mut distances, mut outside) = ([0.0; PACKET], [0.0; PACKET]);
        for i in 0..PACKET {
            let (origin, direction) = self.line(i);
            distances[i] = triangle.distance(origin, direction);
            outside[i] = triangle.outside(origin + distances[i] * direction);
        }
        (distances, outside)
    }

    #[inline(always)]
    fn line(&self, i: usize) -> (DVec3, DVec3) {
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.origin, &self.direction);
        (
            DVec3::new(ox[i].into(), oy[i].into(), oz[i].into()),
            DVec3::new(dx[i].into(), dy[i].into(), dz[i].into()),
        )
    }
}

/// Rays of one octant with one main axis, one in each lane.
struct Packet<V> {
    lines: Lines,
    /// Bounds all coordinates of the scene.
    magnitude: f32,
    axes: [usize; 3],
    sheared: ShearedRays<V>,
    /// For boxes, axis by axis: t = plane * inverse - offset.
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

impl<V: Floats<PACKET>> Packet<V> {
    #[inline(always)]
    fn new(rays: &[Ray], magnitude: f32) -> Option<Packet<V>> {
        let mut lines = Lines::of(rays);
        let [ox, oy, oz] = &lines.origin;
        let [dx, dy, dz] = &lines.direction;
        let origin = [V::load(ox), V::load(oy), V::load(oz)];
        let [dx, dy, dz] = [V::load(dx), V::load(dy), V::load(dz)];
        let zero = V::splat(0.0);
        let down = [dx.lt(zero), dy.lt(zero), dz.lt(zero)];
        let (size_x, size_y, size_z) = (size(dx), size(dy), size(dz));
        let mainly_x = size_y.le(size_x) & size_z.le(size_x);
        let mainly_y = !mainly_x & size_z.le(size_y);
        const ALL: u32 = (1 << PACKET) - 1;
        for bits in [down[0], down[1], down[2], mainly_x, mainly_y & ALL] {
            if bits != 0 && bits != ALL {
                return None;
            }
        }

        let axes @ [kx, ky, kz] = permuted_axes(rays[0].direction);
        let direction = [dx, dy, dz];
        let longest = size_x.max(size_y).max(size_z);
        let smallest = longest.mul(V::splat(SMALLEST));
        let reach = size(origin[0]).max(size(origin[1])).max(size(origin[2]));
        let reach = reach.add(V::splat(magnitude));
        lines.reach = reach.store();
        let growth = reach.mul(V::splat(GROWTH));
        let grown = growth.greatest();

        let stretch = V::splat(1.0).div(direction[kz]);
        let sheared = ShearedRays {
            origin: [origin[kx], origin[ky], origin[kz]],
            slopes: [
                direction[kx].div(direction[kz]).zero_below(LEAST_SLOPE),
                direction[ky].div(direction[kz]).zero_below(LEAST_SLOPE),
            ],
            stretch,
            slack: growth.mul(size(stretch)),
        };
        let mut packet = Packet {
            lines,
            magnitude,
            axes,
            sheared,
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
            let slowest = [size_x, size_y, size_z][axis].max(smallest);
            let inverse = V::splat(if down { -1.0 } else { 1.0 }).div(slowest);
            let (center, around) = (origin[axis].mul(inverse), growth.mul(size(inverse)));
            packet.inverse[axis] = inverse;
            packet.near_offset[axis] = center.add(around);
            packet.far_offset[axis] = center.sub(around);
            // The planes of least coordinates come first, those of greatest three after.
            packet.near[axis] = axis + 3 * usize::from(down);
            packet.far[axis] = axis + 3 * usize::from(!down);
            let lowest = origin[axis].least() - grown;
            let highest = origin[axis].greatest() + grown;
            let [first, last] = if down {
                [highest, lowest]
            } else {
                [lowest, highest]
            };
            packet.first_origin[axis] = first;
            packet.last_origin[axis] = last;
            packet.least_inverse[axis] = inverse.least();
            packet.greatest_inverse[axis] = inverse.greatest();
        }
        Some(packet)
    }

    /// As [`Node::enter`], for the bundle as a whole: before the first ray enters a box, and after the
    /// last one leaves it.
    #[inline(always)]
    fn enter_bundle<W: Floats<WIDTH>>(&self, planes: &[W; 6], farthest: f32) -> (W, W) {
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
    fn enter(&self, node: &Node, child: usize, limits: V) -> u32 {
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

#[inline(always)]
fn size<V: Floats<PACKET>>(lanes: V) -> V {
    lanes.max(V::splat(0.0).sub(lanes))
}
