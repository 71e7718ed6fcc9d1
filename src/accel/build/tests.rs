//! The steps of the build against what they promise, and the whole on hard input.

use super::super::bvh::Bvh;
use super::super::constants::{MAX_DEPTH, WIDTH};
use super::binary_node::{BinaryNode, Content};
use super::binary_tree::BinaryTree;
use super::collapse::Collapse;
use super::primitive_ref::PrimitiveRef;
use super::references;
use super::reinsertion::reinsert;
use crate::geometry::Sphere;
use crate::sampling::Random;
use crate::simd::Kernel;
use glam::Vec3;
use rayon::ThreadPoolBuilder;

fn random_triangles(random: &mut Random, count: usize) -> Vec<[Vec3; 3]> {
    (0..count).map(|_| random.triangle(10.0, 1.0)).collect()
}

fn random_spheres(random: &mut Random, count: usize) -> Vec<Sphere> {
    let mut sphere = || Sphere::new(random.vector(10.0).as_dvec3(), random.unit().into());
    (0..count).map(|_| sphere()).collect()
}

#[test]
fn the_tree_is_the_same_for_any_number_of_threads() {
    let mut random = Random::new(1);
    let triangles = random_triangles(&mut random, 40_000);
    let spheres = random_spheres(&mut random, 3_000);
    let tree = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let bvh = pool
            .expect("threads")
            .install(|| Bvh::new(&triangles, spheres.clone(), Kernel::default()));
        assert_eq!(bvh.validate(), Ok(()));
        // Numbers with the same text have the same bits.
        format!("{:?} {:?}", bvh.nodes, bvh.blocks)
    };
    let one = tree(1);
    for threads in [2, 4] {
        assert!(tree(threads) == one, "{threads} threads");
    }
}

/// A tree over boxes in the order given; `split` says how many of so many go to the left.
fn tree_of(references: &[PrimitiveRef], split: &mut dyn FnMut(usize) -> usize) -> Vec<BinaryNode> {
    fn add(
        nodes: &mut Vec<BinaryNode>,
        node: usize,
        leaves: &[BinaryNode],
        split: &mut dyn FnMut(usize) -> usize,
    ) {
        if let [leaf] = leaves {
            nodes[node] = *leaf;
            return;
        }
        let first = nodes.len();
        nodes.extend([BinaryNode::EMPTY; 2]);
        let (left, right) = leaves.split_at(split(leaves.len()));
        add(nodes, first, left, split);
        add(nodes, first + 1, right, split);
        nodes[node] = BinaryNode::around(&[nodes[first], nodes[first + 1]], first as u32 / 2);
    }
    let leaves: Vec<_> = (0..)
        .zip(references)
        .map(|(i, reference)| BinaryNode::new(reference.min, reference.max, Content::Leaf(i)))
        .collect();
    let mut nodes = vec![BinaryNode::EMPTY; 2];
    add(&mut nodes, 0, &leaves, split);
    nodes
}

/// The sum of the areas of inner nodes. Checks boxes; collects the leaves.
fn area_below(nodes: &[BinaryNode], node: usize, leaves: &mut Vec<u32>, depth: usize) -> f64 {
    assert!(depth <= MAX_DEPTH);
    match nodes[node].content() {
        Content::Leaf(first) => {
            leaves.push(first);
            0.0
        }
        Content::Pair(pair) => {
            let first = 2 * pair as usize;
            let children = [nodes[first], nodes[first + 1]];
            let around = BinaryNode::around(&children, pair);
            assert_eq!(nodes[node].bounds(), around.bounds());
            assert_eq!(nodes[node].half_area(), around.half_area());
            f64::from(around.half_area())
                + area_below(nodes, first, leaves, depth + 1)
                + area_below(nodes, first + 1, leaves, depth + 1)
        }
    }
}

/// Makes some leaves change places, and fits the boxes.
fn exchange_leaves(nodes: &mut [BinaryNode], random: &mut Random, count: usize) {
    let is_leaf = |&node: &usize| matches!(nodes[node].content(), Content::Leaf(_));
    let leaves: Vec<usize> = (2..nodes.len()).filter(is_leaf).collect();
    for _ in 0..count {
        nodes.swap(
            leaves[random.below(leaves.len())],
            leaves[random.below(leaves.len())],
        );
    }
    for node in (0..nodes.len()).rev() {
        if let Content::Pair(pair) = nodes[node].content() {
            let first = 2 * pair as usize;
            nodes[node] = BinaryNode::around(&[nodes[first], nodes[first + 1]], pair);
        }
    }
}

#[test]
fn reinsertion_lowers_the_cost_and_keeps_boxes_tight() {
    let mut random = Random::new(2);
    for count in [1, 6, 7, 20, 100, 3000] {
        let triangles = random_triangles(&mut random, count);
        let mut nodes = BinaryTree::build(references(&triangles, &[]), count as u32).nodes;
        if count > 100 {
            exchange_leaves(&mut nodes, &mut random, 10);
        }
        let (mut before, mut after) = (Vec::new(), Vec::new());
        let area = area_below(&nodes, 0, &mut before, 0);
        reinsert(&mut nodes);
        let reinserted_area = area_below(&nodes, 0, &mut after, 0);
        let most = if count > 100 { 0.9 } else { 1.0 };
        assert!(reinserted_area <= most * area, "{reinserted_area} {area}");
        before.sort_unstable();
        after.sort_unstable();
        assert_eq!(before, after);
    }
}

#[test]
fn reinsertion_keeps_the_depth_bound() {
    let triangle =
        |x: f32, size: f32| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p * size + x * Vec3::X);
    // A chain of triangles, as deep as can be, each in the one before; and one that belongs into the last, beside
    // many that are elsewhere.
    let chain = (0..MAX_DEPTH).map(|i| triangle(100.0, 1.01_f32.powi(-(i as i32))));
    let misplaced = triangle(100.0, 1.01_f32.powi(-(MAX_DEPTH as i32)));
    let others = (0..4096).map(|i| triangle(0.0, 1e-3 * i as f32 / 4096.0));
    let triangles: Vec<_> = chain.chain([misplaced]).chain(others).collect();
    let mut calls = 0;
    let mut split = |count: usize| {
        calls += 1;
        match calls {
            1 => MAX_DEPTH,
            _ if calls <= MAX_DEPTH + 1 => 1,
            _ => count / 2,
        }
    };
    let mut nodes = tree_of(&references(&triangles, &[]), &mut split);
    let before = area_below(&nodes, 0, &mut Vec::new(), 0);
    reinsert(&mut nodes);
    assert!(area_below(&nodes, 0, &mut Vec::new(), 0) < before);
}

/// Every set of subtrees that together hold what is below a node.
fn cuts(tree: &BinaryTree, node: BinaryNode) -> Vec<Vec<BinaryNode>> {
    let mut all = vec![vec![node]];
    if let Content::Pair(pair) = node.content() {
        let [left, right] = tree.pair(pair).map(|child| cuts(tree, child));
        for left in &left {
            all.extend(right.iter().map(|right| [&left[..], right].concat()));
        }
    }
    all
}

fn triangle_count(tree: &BinaryTree, node: BinaryNode) -> usize {
    match node.content() {
        Content::Leaf(first) => tree.leaf(first).len(),
        Content::Pair(pair) => tree
            .pair(pair)
            .map(|c| triangle_count(tree, c))
            .iter()
            .sum(),
    }
}

/// The least cost of a subtree as one root.
fn least_cost(tree: &BinaryTree, node: BinaryNode) -> f64 {
    let area = f64::from(node.half_area());
    if triangle_count(tree, node) <= WIDTH {
        return area;
    }
    let cost = |cut: &Vec<BinaryNode>| cut.iter().map(|n| least_cost(tree, *n)).sum::<f64>();
    let cuts = cuts(tree, node);
    let below = cuts.iter().filter(|cut| (2..=WIDTH).contains(&cut.len()));
    area + below.map(cost).fold(f64::INFINITY, f64::min)
}

/// The cost of a subtree as the collapse chose it, as at most so many roots.
fn chosen_cost(tree: &BinaryTree, collapse: &Collapse, node: BinaryNode, roots: usize) -> f64 {
    let area = f64::from(node.half_area());
    let cost = |[left, right]: [usize; 2], pair: u32| {
        let [a, b] = *tree.pair(pair);
        chosen_cost(tree, collapse, a, left) + chosen_cost(tree, collapse, b, right)
    };
    match node.content() {
        Content::Leaf(_) => area,
        Content::Pair(pair) => match collapse.division(pair, roots) {
            Some(division) => cost(division, pair),
            None if collapse.is_block(pair) => area,
            None => area + cost(collapse.division(pair, WIDTH).expect("children"), pair),
        },
    }
}

#[test]
fn the_collapse_costs_as_little_as_the_best_of_all() {
    let mut random = Random::new(3);
    for case in 0..60 {
        let count = 2 + case % 12;
        let triangles = random_triangles(&mut random, count);
        let mut references = references(&triangles, &[]);
        for reference in &mut references {
            reference.set_leaf_len(1);
        }
        let tree = BinaryTree {
            nodes: tree_of(&references, &mut |count| 1 + random.below(count - 1)),
            references,
            first_sphere: count as u32,
        };
        let least = least_cost(&tree, tree.nodes[0]);
        let chosen = chosen_cost(&tree, &Collapse::of(&tree), tree.nodes[0], 1);
        assert!((chosen - least).abs() <= 1e-5 * least, "{chosen} {least}");
    }
}

#[test]
fn hard_input_makes_sound_trees() {
    let triangle = |at: Vec3, size: f32| [at, at + size * Vec3::X, at + size * Vec3::Y];
    let scenes: [Vec<[Vec3; 3]>; 6] = [
        // Each as large as all before; the same, with many at the end.
        (0..250)
            .map(|i| triangle(Vec3::ZERO, 2_f32.powi(i - 125)))
            .collect(),
        (0..5_000)
            .map(|i| triangle(Vec3::ZERO, 2_f32.powi((i - 125).min(125))))
            .collect(),
        // All alike; without area; of areas that overflow, also with sides of 0.
        vec![triangle(Vec3::ONE, 1.0); 100_000],
        (0..1000).map(|i| [Vec3::X * i as f32; 3]).collect(),
        (0..1000)
            .map(|i| triangle(Vec3::splat(i as f32 * 1e27), 1e30))
            .collect(),
        (0..1000)
            .map(|i| triangle(Vec3::splat((500 - i) as f32 * 6e35), 1e36))
            .collect(),
    ];
    for (scene, triangles) in scenes.into_iter().enumerate() {
        for spheres in [vec![], random_spheres(&mut Random::new(4), 50)] {
            let bvh = Bvh::new(&triangles, spheres, Kernel::default());
            assert_eq!(bvh.validate(), Ok(()), "{scene}");
        }
    }
}
