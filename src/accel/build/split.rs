//! Splits a range of references by the binned surface area heuristic.

use super::super::constants::WIDTH;
use super::binary_node::half_area;
use super::primitive_ref::{Extent, PARALLEL_CHUNK, PrimitiveRef};
use glam::Vec4;
use rayon::prelude::*;

/// The most bins along each axis.
const MAX_BINS: usize = 16;

/// A range of references, partitioned in two.
pub(super) struct Partition {
    /// The number of references of the first part.
    pub(super) count: usize,
    pub(super) extents: [Extent; 2],
}

/// Partitions two or more references by the surface area heuristic, or at the median index where all centres
/// coincide or `by_sah` is false.
pub(super) fn split(references: &mut [PrimitiveRef], extent: Extent, by_sah: bool) -> Partition {
    // Few references need few bins: sweeping over them would cost more than sorting into them.
    let plane = match references.len() {
        _ if !by_sah => None,
        0..16 => best_plane::<4>(references, &extent),
        16..256 => best_plane::<8>(references, &extent),
        _ => best_plane::<MAX_BINS>(references, &extent),
    };
    let count = match plane {
        Some(plane) => partition(references, &plane),
        None => references.len() / 2,
    };
    let (left, right) = references.split_at(count);
    Partition {
        count,
        extents: [Extent::of(left), Extent::of(right)],
    }
}

/// Added to a number whose last bit is worth one, a float leaves its integer in the lower bits: faster than a
/// conversion that checks its range.
const ROUND: f32 = (1 << 23) as f32;

/// Maps twice a centre to bins, along all axes at once.
#[derive(Clone, Copy)]
struct Binning {
    min: Vec4,
    scale: Vec4,
}

impl Binning {
    fn new(extent: &Extent, bins: usize) -> Binning {
        let size = extent.doubled_center_max - extent.doubled_center_min;
        let scale = |axis: usize| {
            let scale = (bins - 1) as f32 / size[axis];
            if scale.is_finite() { scale } else { 0.0 }
        };
        Binning {
            min: extent.doubled_center_min,
            scale: Vec4::new(scale(0), scale(1), scale(2), 0.0),
        }
    }

    /// The bin along each axis, added to [`ROUND`].
    #[inline(always)]
    fn rounded(&self, doubled_center: Vec4) -> Vec4 {
        (doubled_center - self.min) * self.scale + Vec4::splat(ROUND)
    }

    /// The bin along each axis.
    #[inline(always)]
    fn bins(&self, reference: &PrimitiveRef) -> [usize; 3] {
        let at = self.rounded(reference.doubled_center());
        let bin = |x: f32| x.to_bits() as usize % MAX_BINS;
        [bin(at.x), bin(at.y), bin(at.z)]
    }
}

struct Plane {
    binning: Binning,
    axis: usize,
    /// The first bin of the right side.
    bin: usize,
}

#[derive(Clone, Copy)]
struct Bin {
    min: Vec4,
    max: Vec4,
    count: usize,
}

impl Bin {
    const EMPTY: Bin = Bin {
        min: Vec4::INFINITY,
        max: Vec4::NEG_INFINITY,
        count: 0,
    };

    #[inline(always)]
    fn join(&mut self, min: Vec4, max: Vec4, count: usize) {
        self.min = self.min.min(min);
        self.max = self.max.max(max);
        self.count += count;
    }

    /// The cost of the surface area heuristic: area times the number of blocks, as eight triangles are tested
    /// at once.
    fn cost(&self) -> f32 {
        half_area(self.min, self.max) * self.count.div_ceil(WIDTH) as f32
    }
}

/// What falls into each bin along each axis.
type Bins<const BINS: usize> = [[Bin; BINS]; 3];

/// Sorts references into bins.
fn fill_bins<const BINS: usize>(references: &[PrimitiveRef], binning: &Binning) -> Bins<BINS> {
    let mut bins = [[Bin::EMPTY; BINS]; 3];
    if references.len() > PARALLEL_CHUNK {
        let chunks = references.par_chunks(PARALLEL_CHUNK);
        let parts: Vec<Bins<BINS>> = chunks.map(|chunk| fill_bins(chunk, binning)).collect();
        for part in parts {
            for (bin, other) in bins.iter_mut().flatten().zip(part.iter().flatten()) {
                bin.join(other.min, other.max, other.count);
            }
        }
    } else {
        for reference in references {
            for (axis, bin) in binning.bins(reference).into_iter().enumerate() {
                bins[axis][bin % BINS].join(reference.min, reference.max, 1);
            }
        }
    }
    bins
}

/// The plane between bins of the least cost; none if all centres fall into one bin along every axis.
fn best_plane<const BINS: usize>(references: &[PrimitiveRef], extent: &Extent) -> Option<Plane> {
    let binning = Binning::new(extent, BINS);
    let bins: Bins<BINS> = fill_bins(references, &binning);
    let mut best: Option<(f32, Plane)> = None;
    for (axis, bins) in bins.iter().enumerate() {
        if binning.scale[axis] == 0.0 {
            continue;
        }
        let mut costs = [0.0; BINS];
        let mut right = Bin::EMPTY;
        for bin in (1..BINS).rev() {
            right.join(bins[bin].min, bins[bin].max, bins[bin].count);
            costs[bin] = right.cost();
        }
        let mut left = Bin::EMPTY;
        for bin in 1..BINS {
            let last = bins[bin - 1];
            left.join(last.min, last.max, last.count);
            let total = left.cost() + costs[bin];
            let parts = left.count > 0 && left.count < references.len();
            if parts && best.as_ref().is_none_or(|(least, _)| total < *least) {
                best = Some((total, Plane { binning, axis, bin }));
            }
        }
    }
    best.map(|(_, plane)| plane)
}

/// Moves the references left of the plane to the front; returns how many there are.
fn partition(references: &mut [PrimitiveRef], plane: &Plane) -> usize {
    let first_right = Vec4::splat(ROUND + plane.bin as f32);
    let mut left = 0;
    for i in 0..references.len() {
        let reference = references[i];
        let at = plane.binning.rounded(reference.doubled_center());
        let is_right = at.cmpge(first_right).bitmask() as usize >> plane.axis & 1;
        // Without a branch, which would be mispredicted half of the time.
        references[i] = references[left];
        references[left] = reference;
        left += 1 - is_right;
    }
    left
}
