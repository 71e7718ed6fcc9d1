//! Builds the tree: a binary hierarchy by the surface area heuristic with binning (Wald 2007,
//! "On fast Construction of SAH-based Bounding Volume Hierarchies"), then children pulled up until
//! each node has eight.

use super::kernel::Kernel;
use super::node::{Child, Node};
use super::triangle_block::TriangleBlock;
use super::{Bvh, MAX_DEPTH, WIDTH};
use crate::geometry::Sphere;
use crate::math::Aabb;
use glam::Vec3;

/// Candidate planes between bins, along each axis.
const BINS: usize = 16;

/// From this depth on nodes are halved by number, which bounds the depth of any tree: there are
/// fewer than 2^31 primitives to be halved.
const MAX_SAH_DEPTH: usize = MAX_DEPTH - 31;

pub(super) fn build(triangles: &[[Vec3; 3]], spheres: Vec<Sphere>, kernel: Kernel) -> Bvh {
    let first_sphere = triangles.len() as u32;
    let bounds = triangles.iter().map(|corners| Aabb::of(*corners));
    let mut primitives: Vec<Primitive> = bounds
        .chain(spheres.iter().map(Sphere::bounds))
        .enumerate()
        .map(|(id, bounds)| Primitive {
            bounds,
            center: bounds.center(),
            id: id as u32,
        })
        .collect();
    let mut bvh = Bvh {
        nodes: Vec::new(),
        blocks: Vec::new(),
        spheres,
        first_sphere,
        bounds: primitives
            .iter()
            .fold(Aabb::EMPTY, |b, p| b.union(p.bounds)),
        kernel,
    };
    if primitives.is_empty() {
        bvh.nodes.push(Node::new(&[]));
        return bvh;
    }
    let root = split(&mut primitives, first_sphere, 0);
    let children = match root.kind {
        Kind::Inner(_) => pull_up(root),
        Kind::Leaf(_) => vec![root],
    };
    flatten(children, triangles, &mut bvh);
    bvh
}

struct Primitive {
    bounds: Aabb,
    center: Vec3,
    id: u32,
}

struct Tree {
    bounds: Aabb,
    kind: Kind,
}

enum Kind {
    Inner(Box<[Tree; 2]>),
    /// One sphere, or one to eight triangles: the numbers.
    Leaf(Vec<u32>),
}

fn split(primitives: &mut [Primitive], first_sphere: u32, depth: usize) -> Tree {
    let bounds = primitives
        .iter()
        .fold(Aabb::EMPTY, |b, p| b.union(p.bounds));
    let is_sphere = |p: &Primitive| p.id >= first_sphere;
    let spheres = primitives.iter().filter(|p| is_sphere(p)).count();
    let is_leaf = primitives.len() == 1 || (spheres == 0 && primitives.len() <= WIDTH);
    if is_leaf {
        let mut ids: Vec<u32> = primitives.iter().map(|p| p.id).collect();
        ids.sort_unstable();
        return Tree {
            bounds,
            kind: Kind::Leaf(ids),
        };
    }
    let middle = if depth < MAX_SAH_DEPTH {
        partition_by_area(primitives)
    } else {
        None
    };
    let middle = middle.unwrap_or(primitives.len() / 2);
    let (left, right) = primitives.split_at_mut(middle);
    let children = [
        split(left, first_sphere, depth + 1),
        split(right, first_sphere, depth + 1),
    ];
    Tree {
        bounds,
        kind: Kind::Inner(Box::new(children)),
    }
}

/// Parts the primitives where the expected cost of a ray is least; returns how many come first, or
/// none if all centres coincide.
fn partition_by_area(primitives: &mut [Primitive]) -> Option<usize> {
    let centers = Aabb::of(primitives.iter().map(|p| p.center));
    let extent = centers.extent();
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in 0..3 {
        if extent[axis] <= 0.0 {
            continue;
        }
        let mut bins = [(Aabb::EMPTY, 0_usize); BINS];
        for p in primitives.iter() {
            let bin = &mut bins[bin_of(p.center[axis], centers.min[axis], extent[axis])];
            *bin = (bin.0.union(p.bounds), bin.1 + 1);
        }
        let mut cost_of_right = [0.0; BINS];
        let mut right = (Aabb::EMPTY, 0);
        for plane in (1..BINS).rev() {
            right = (right.0.union(bins[plane].0), right.1 + bins[plane].1);
            cost_of_right[plane] = cost(right);
        }
        let mut left = (Aabb::EMPTY, 0);
        for plane in 1..BINS {
            left = (left.0.union(bins[plane - 1].0), left.1 + bins[plane - 1].1);
            let total = cost(left) + cost_of_right[plane];
            let parts = left.1 > 0 && left.1 < primitives.len();
            if parts && best.is_none_or(|(least, ..)| total < least) {
                best = Some((total, axis, plane));
            }
        }
    }
    let (_, axis, plane) = best?;
    let is_left = |p: &Primitive| bin_of(p.center[axis], centers.min[axis], extent[axis]) < plane;
    let mut middle = 0;
    for i in 0..primitives.len() {
        if is_left(&primitives[i]) {
            primitives.swap(i, middle);
            middle += 1;
        }
    }
    Some(middle)
}

fn bin_of(center: f32, min: f32, extent: f32) -> usize {
    (((center - min) / extent * BINS as f32) as usize).min(BINS - 1)
}

/// Area times the number of blocks: eight triangles are tested for the price of one.
fn cost((bounds, count): (Aabb, usize)) -> f32 {
    bounds.half_area() * count.div_ceil(WIDTH) as f32
}

/// The children of an inner node, with the largest inner ones replaced by their own children while
/// there is room for eight.
fn pull_up(tree: Tree) -> Vec<Tree> {
    let mut children = vec![tree];
    while children.len() < WIDTH {
        let largest = children
            .iter()
            .enumerate()
            .filter(|(_, child)| matches!(child.kind, Kind::Inner(_)))
            .max_by(|(_, a), (_, b)| a.bounds.half_area().total_cmp(&b.bounds.half_area()))
            .map(|(i, _)| i);
        let Some(i) = largest else { break };
        if let Kind::Inner(pair) = children.swap_remove(i).kind {
            children.extend(*pair);
        }
    }
    children
}

/// Lays out a node over `children` and all below it; returns the node's index.
fn flatten(children: Vec<Tree>, triangles: &[[Vec3; 3]], bvh: &mut Bvh) -> u32 {
    let index = bvh.nodes.len();
    bvh.nodes.push(Node::new(&[]));
    let children: Vec<(Aabb, Child)> = children
        .into_iter()
        .map(|tree| {
            let bounds = tree.bounds;
            let child = match &tree.kind {
                Kind::Inner(_) => Child::Node(flatten(pull_up(tree), triangles, bvh)),
                Kind::Leaf(ids) if ids[0] >= bvh.first_sphere => {
                    Child::Sphere(ids[0] - bvh.first_sphere)
                }
                Kind::Leaf(ids) => {
                    bvh.blocks.push(TriangleBlock::new(ids, triangles));
                    Child::Triangles(bvh.blocks.len() as u32 - 1)
                }
            };
            (bounds, child)
        })
        .collect();
    bvh.nodes[index] = Node::new(&children);
    index as u32
}
