//! Importance sampling of many emitters: Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with
//! Adaptive Tree Splitting", after pbrt-v4, section 12.6.3.
//!
//! Binary divisions are collapsed to nodes of four children, which are evaluated together: half as many steps that wait
//! for each other, and half as many estimates that err. Traversal takes only arithmetic and square roots, so the same
//! emitter is chosen on every machine.

mod build;
mod node;
mod node_bounds;
#[cfg(test)]
mod tests;

use super::LightBounds;
use build::{Item, split};
use glam::{Vec3, Vec4};
use node::{LEAF, Node, WIDTH};
use node_bounds::NodeBounds;

/// The largest number below 1.
const ONE_MINUS_EPSILON: f64 = 1.0 - f64::EPSILON / 2.0;

/// A tree of emitters that finds those that matter for a point.
#[derive(Clone, Debug, Default)]
pub struct LightTree {
    /// The root is the first.
    nodes: Vec<Node>,
    /// The children on the way from the root to each emitter: two bits for each node, the lowest first.
    trails: Vec<u64>,
}

impl LightTree {
    /// The tree of some emitters, fewer than 2^31. It does not depend on the machine.
    pub fn new(emitters: &[LightBounds]) -> LightTree {
        let has_power = |light: &LightBounds| light.power > 0.0 && light.power.is_finite();
        let powers = emitters.iter().filter(|light| has_power(light));
        let total: f64 = powers.map(|light| f64::from(light.power)).sum();
        let mut items: Vec<Item> = (0..)
            .zip(emitters)
            .filter(|(_, light)| has_power(light))
            .map(|(index, light)| Item {
                index,
                light: LightBounds {
                    // Shares neither overflow nor vanish in what is computed with them.
                    power: ((f64::from(light.power) / total) as f32).max(f32::MIN_POSITIVE),
                    ..*light
                },
            })
            .collect();
        let mut tree = LightTree {
            nodes: Vec::new(),
            trails: vec![0; emitters.len()],
        };
        if !items.is_empty() {
            tree.add_node(&mut items, 0, 0);
            tree.nodes.shrink_to_fit();
        }
        tree
    }

    /// Adds the node of these emitters, `depth` divisions below the root, and what is below it; its number.
    fn add_node(&mut self, items: &mut [Item], depth: u32, trail: u64) -> u32 {
        let number = self.nodes.len();
        self.nodes.push(Node::default());
        let half = split(items, depth);
        let (low, high) = items.split_at_mut(half);
        let quarters = [split(low, depth + 1), split(high, depth + 1)];
        let (low, high) = (
            low.split_at_mut(quarters[0]),
            high.split_at_mut(quarters[1]),
        );
        let children: [&mut [Item]; WIDTH] = [low.0, low.1, high.0, high.1];
        for (lane, child) in children.into_iter().enumerate() {
            let trail = trail | (lane as u64) << depth;
            let link = match child {
                [] => continue,
                [item] => {
                    self.trails[item.index as usize] = trail;
                    LEAF | item.index
                }
                _ => self.add_node(child, depth + 2, trail),
            };
            let bounds = NodeBounds::of(child.iter().map(|item| &item.light));
            self.nodes[number].set_child(lane, &bounds);
            self.nodes[number].links[lane] = link;
        }
        number as u32
    }

    /// Whether there is no emitter with power.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Chooses an emitter as seen from a point above a surface with a unit normal, by a number in [0, 1): its index and
    /// its probability. None where no emitter can reach the point.
    ///
    /// Every emitter that can light the point from above is chosen with some probability. Now and then one is chosen
    /// that cannot: bounds of many do not tell.
    pub fn sample(&self, point: Vec3, normal: Vec3, u: f32) -> Option<(usize, f32)> {
        let mut u = f64::from(u);
        let mut probability = 1.0;
        let mut link = 0;
        while link & LEAF == 0 {
            let importance = self.importance(link, point, normal)?;
            let sums = sums_before(importance);
            let x = u * sums[WIDTH];
            let is_beyond = |child: usize| usize::from(x >= sums[child + 1]);
            let child = is_beyond(0) + is_beyond(1) + is_beyond(2);
            // What is left of the number is uniform again.
            u = ((x - sums[child]) / importance[child]).min(ONE_MINUS_EPSILON);
            probability *= importance[child] / sums[WIDTH];
            link = self.nodes[link as usize].links[child];
        }
        Some(((link & !LEAF) as usize, probability as f32))
    }

    /// The probability that [`LightTree::sample`] chooses the emitter: the same number that it returns.
    pub fn probability(&self, point: Vec3, normal: Vec3, emitter: usize) -> f32 {
        let mut trail = self.trails[emitter];
        let mut probability = 1.0;
        let mut link = 0;
        while link & LEAF == 0 {
            let Some(importance) = self.importance(link, point, normal) else {
                return 0.0;
            };
            let child = (trail % WIDTH as u64) as usize;
            trail /= WIDTH as u64;
            probability *= importance[child] / sums_before(importance)[WIDTH];
            link = self.nodes[link as usize].links[child];
        }
        // The trails of emitters without power lead to others.
        if link == LEAF | emitter as u32 {
            probability as f32
        } else {
            0.0
        }
    }

    /// The importance of the children of a node; None where it is 0 for those of the root.
    #[inline(always)]
    fn importance(&self, number: u32, point: Vec3, normal: Vec3) -> Option<[f64; WIDTH]> {
        let node = self.nodes.get(number as usize)?;
        let importance = node.importance(point, normal);
        if importance != Vec4::ZERO {
            return Some(importance.as_dvec4().to_array());
        }
        // Bounds further up did not tell that nothing here can light the point: one is as good as another.
        (number != 0).then(|| node.power.as_dvec4().to_array())
    }

    /// Bytes that the tree takes.
    pub fn memory(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + self.trails.capacity() * size_of::<u64>()
    }
}

/// The sum of the numbers before each, and of all.
#[inline(always)]
fn sums_before([a, b, c, d]: [f64; WIDTH]) -> [f64; WIDTH + 1] {
    [0.0, a, a + b, a + b + c, a + b + c + d]
}
