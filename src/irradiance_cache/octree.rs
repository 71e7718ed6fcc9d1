//! An octree over the bounding boxes of records, built one by one.

use crate::math::Aabb;
use glam::Vec3;

/// A leaf with more boxes than this is split.
const LEAF_CAPACITY: usize = 16;

/// Leaves smaller than this fraction of the mean size of their boxes are not split: most boxes would overlap all
/// children.
const MIN_RELATIVE_SIZE: f32 = 1.0;

/// Depth limit.
const MAX_DEPTH: u32 = 24;

/// Finds the boxes that may contain a point. Leaves list the boxes that they overlap.
#[derive(Debug)]
pub(super) struct Octree {
    root: Cube,
    /// The root is the first.
    nodes: Vec<Node>,
    boxes: Vec<Aabb>,
}

#[derive(Debug)]
enum Node {
    /// The first of eight children.
    Inner(u32),
    Leaf(Vec<u32>),
}

/// The points in [center - half, center + half).
#[derive(Clone, Copy, Debug)]
struct Cube {
    center: Vec3,
    half: f32,
}

impl Cube {
    /// One of its octants; bits 0, 1 and 2 select the upper half along x, y and z.
    #[inline]
    fn octant(self, index: usize) -> Cube {
        let sign = |axis: usize| if index >> axis & 1 == 1 { 1.0 } else { -1.0 };
        let half = 0.5 * self.half;
        Cube {
            center: self.center + half * Vec3::new(sign(0), sign(1), sign(2)),
            half,
        }
    }

    fn overlaps(self, other: &Aabb) -> bool {
        let above = other.max.cmpge(self.center - self.half);
        (above & other.min.cmple(self.center + self.half)).all()
    }
}

/// A leaf of the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf {
    cube: Cube,
    /// Its index.
    pub(super) node: u32,
}

impl Leaf {
    /// Whether a point lies in its interior.
    #[inline]
    pub(super) fn contains(&self, point: Vec3) -> bool {
        let Cube { center, half } = self.cube;
        (point.cmpgt(center - half) & point.cmplt(center + half)).all()
    }
}

impl Octree {
    /// An empty tree over `bounds`.
    fn new(bounds: Aabb) -> Octree {
        Octree {
            root: Cube {
                center: bounds.center(),
                // Enlarged, so that points on the faces lie inside.
                half: 0.501 * bounds.extent().max_element(),
            },
            nodes: vec![Node::Leaf(Vec::new())],
            boxes: Vec::new(),
        }
    }

    /// A tree of boxes, numbered from 0; leaves list them in this order.
    pub(super) fn of(bounds: Aabb, boxes: impl Iterator<Item = Aabb>) -> Octree {
        let mut tree = Octree::new(bounds);
        boxes.for_each(|new| tree.insert(new));
        tree
    }

    /// Adds a box.
    fn insert(&mut self, new: Aabb) {
        let index = self.boxes.len() as u32;
        self.boxes.push(new);
        self.insert_below(0, self.root, 0, index);
    }

    fn insert_below(&mut self, node: usize, cube: Cube, depth: u32, index: u32) {
        match &mut self.nodes[node] {
            Node::Inner(first) => {
                let first = *first as usize;
                for child in 0..8 {
                    let octant = cube.octant(child);
                    if octant.overlaps(&self.boxes[index as usize]) {
                        self.insert_below(first + child, octant, depth + 1, index);
                    }
                }
            }
            Node::Leaf(list) => {
                list.push(index);
                let size = |&n: &u32| self.boxes[n as usize].extent().max_element();
                let mean = list.iter().map(size).sum::<f32>() / list.len() as f32;
                let is_large = 2.0 * cube.half > MIN_RELATIVE_SIZE * mean;
                if list.len() > LEAF_CAPACITY && depth < MAX_DEPTH && is_large {
                    let list = std::mem::take(list);
                    let first = self.nodes.len();
                    self.nodes[node] = Node::Inner(first as u32);
                    self.nodes.extend((0..8).map(|_| Node::Leaf(Vec::new())));
                    for index in list {
                        self.insert_below(node, cube, depth, index);
                    }
                }
            }
        }
    }

    /// The leaf that contains a point; points outside the root get the nearest one along each axis.
    #[inline]
    pub(super) fn leaf(&self, point: Vec3) -> Leaf {
        let mut cube = self.root;
        let mut node = 0;
        while let Node::Inner(first) = &self.nodes[node] {
            let above = point.cmpge(cube.center).bitmask() as usize;
            node = *first as usize + above;
            cube = cube.octant(above);
        }
        Leaf {
            cube,
            node: node as u32,
        }
    }

    /// The boxes that overlap the leaf of this index.
    #[inline]
    pub(super) fn boxes(&self, node: u32) -> &[u32] {
        match &self.nodes[node as usize] {
            Node::Inner(_) => &[],
            Node::Leaf(boxes) => boxes,
        }
    }

    /// Memory in bytes.
    pub(super) fn memory(&self) -> usize {
        let list = |node: &Node| match node {
            Node::Inner(_) => 0,
            Node::Leaf(list) => size_of_val(&**list),
        };
        let lists: usize = self.nodes.iter().map(list).sum();
        size_of_val(&*self.nodes) + size_of_val(&*self.boxes) + lists
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;

    #[test]
    fn every_box_that_contains_a_point_is_listed() {
        let bounds = Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::ONE,
        };
        let mut random = Random::new(4);
        let mut new = || {
            let (a, size) = (random.vector(1.0), 0.3 * random.unit());
            Aabb::of([a, a + random.vector(size)])
        };
        let boxes: Vec<Aabb> = (0..2000).map(|_| new()).collect();
        let tree = Octree::of(bounds, boxes.iter().copied());
        let mut listed = 0;
        for _ in 0..2000 {
            let point = random.vector(1.0);
            let around = tree.boxes(tree.leaf(point).node);
            listed += around.len();
            for (index, b) in (0..).zip(&boxes) {
                let is_inside = (point.cmpge(b.min) & point.cmple(b.max)).all();
                assert!(!is_inside || around.contains(&index));
            }
            let leaf = tree.leaf(point);
            let near = point + random.vector(0.01);
            assert!(!leaf.contains(near) || tree.leaf(near).node == leaf.node);
        }
        assert!(listed < 2000 * 100, "{listed}");
    }
}
