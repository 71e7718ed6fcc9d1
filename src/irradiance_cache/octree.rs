use crate::math::Aabb;
use glam::Vec3;

/// A leaf with more boxes than this is split, if that helps.
const CAPACITY: usize = 16;

/// Leaves that are smaller than this share of their boxes are not split: most boxes would lie in all parts.
const SHARE: f32 = 0.5;

/// No leaf lies deeper.
const MAX_DEPTH: u32 = 24;

/// Which of many boxes may hold a point: an octree that grows as boxes are added, whose leaves list the
/// boxes that they touch.
#[derive(Debug)]
pub struct Octree {
    root: Cube,
    /// The root first.
    nodes: Vec<Node>,
    boxes: Vec<Aabb>,
}

#[derive(Debug)]
enum Node {
    /// The first of eight children.
    Inner(u32),
    Leaf(Vec<u32>),
}

/// The points from `center - half` on that are below `center + half`.
#[derive(Clone, Copy, Debug)]
struct Cube {
    center: Vec3,
    half: f32,
}

impl Cube {
    /// One of its eighths, where bits 0, 1 and 2 say whether it is the upper one along x, y and z.
    #[inline]
    fn eighth(self, number: usize) -> Cube {
        let sign = |axis: usize| if number >> axis & 1 == 1 { 1.0 } else { -1.0 };
        let half = 0.5 * self.half;
        Cube {
            center: self.center + half * Vec3::new(sign(0), sign(1), sign(2)),
            half,
        }
    }

    fn touches(self, other: &Aabb) -> bool {
        let reaches = other.max.cmpge(self.center - self.half);
        (reaches & other.min.cmple(self.center + self.half)).all()
    }
}

/// A leaf of the tree.
#[derive(Clone, Copy, Debug)]
pub struct Leaf {
    cube: Cube,
    /// Its number.
    pub node: u32,
}

impl Leaf {
    /// Whether a point surely lies in it.
    #[inline]
    pub fn holds(&self, point: Vec3) -> bool {
        let Cube { center, half } = self.cube;
        (point.cmpgt(center - half) & point.cmplt(center + half)).all()
    }
}

impl Octree {
    /// An empty tree for points within `bounds`.
    pub fn new(bounds: Aabb) -> Octree {
        Octree {
            root: Cube {
                center: bounds.center(),
                // Points on the sides lie inside.
                half: 0.501 * bounds.extent().max_element(),
            },
            nodes: vec![Node::Leaf(Vec::new())],
            boxes: Vec::new(),
        }
    }

    /// Adds a box; they are numbered from 0 on.
    pub fn insert(&mut self, new: Aabb) {
        let number = self.boxes.len() as u32;
        self.boxes.push(new);
        self.insert_below(0, self.root, 0, number);
    }

    fn insert_below(&mut self, node: usize, cube: Cube, depth: u32, number: u32) {
        match &mut self.nodes[node] {
            Node::Inner(first) => {
                let first = *first as usize;
                for child in 0..8 {
                    let part = cube.eighth(child);
                    if part.touches(&self.boxes[number as usize]) {
                        self.insert_below(first + child, part, depth + 1, number);
                    }
                }
            }
            Node::Leaf(list) => {
                list.push(number);
                let size = |&n: &u32| self.boxes[n as usize].extent().max_element();
                let mean = list.iter().map(size).sum::<f32>() / list.len() as f32;
                let helps = 2.0 * cube.half > SHARE * mean;
                if list.len() > CAPACITY && depth < MAX_DEPTH && helps {
                    let list = std::mem::take(list);
                    let first = self.nodes.len();
                    self.nodes[node] = Node::Inner(first as u32);
                    self.nodes.extend((0..8).map(|_| Node::Leaf(Vec::new())));
                    for number in list {
                        self.insert_below(node, cube, depth, number);
                    }
                }
            }
        }
    }

    /// The leaf around a point.
    #[inline]
    pub fn leaf(&self, point: Vec3) -> Leaf {
        let mut cube = self.root;
        let mut node = 0;
        while let Node::Inner(first) = &self.nodes[node] {
            let above = point.cmpge(cube.center).bitmask() as usize;
            node = *first as usize + above;
            cube = cube.eighth(above);
        }
        Leaf {
            cube,
            node: node as u32,
        }
    }

    /// The boxes that touch the leaf of this number.
    #[inline]
    pub fn boxes(&self, node: u32) -> &[u32] {
        match &self.nodes[node as usize] {
            Node::Inner(_) => &[],
            Node::Leaf(boxes) => boxes,
        }
    }

    /// The boxes that touch the leaf around a point.
    #[inline]
    pub fn around(&self, point: Vec3) -> &[u32] {
        self.boxes(self.leaf(point).node)
    }

    /// Bytes.
    pub fn memory(&self) -> usize {
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
    fn every_box_that_holds_a_point_is_listed() {
        let bounds = Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::ONE,
        };
        let mut random = Random::new(4);
        let mut tree = Octree::new(bounds);
        let mut boxes = Vec::new();
        for _ in 0..2000 {
            let (a, size) = (random.vector(1.0), 0.3 * random.unit());
            let new = Aabb::of([a, a + random.vector(size)]);
            tree.insert(new);
            boxes.push(new);
        }
        let mut listed = 0;
        for _ in 0..2000 {
            let point = random.vector(1.0);
            let around = tree.around(point);
            listed += around.len();
            for (number, b) in (0..).zip(&boxes) {
                let is_inside = (point.cmpge(b.min) & point.cmple(b.max)).all();
                assert!(!is_inside || around.contains(&number));
            }
            let leaf = tree.leaf(point);
            let near = point + random.vector(0.01);
            assert!(!leaf.holds(near) || tree.leaf(near).node == leaf.node);
        }
        assert!(listed < 2000 * 100, "{listed}");
    }
}
