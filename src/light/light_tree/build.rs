//! Dividing emitters by the surface area orientation heuristic (Conty Estevez and Kulla 2018, section 4.4): those stay
//! together that are close, of like direction and weak.

use crate::light::LightBounds;
use crate::math::Aabb;
use glam::{DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Emitters are divided between two of so many slices of the box of their centres.
const BUCKETS: usize = 12;

/// No emitter is more divisions than this below the root: a trail has a bit for each.
const MAX_DEPTH: u32 = u64::BITS;

/// An emitter on its way to its place in the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    /// Its number.
    pub index: u32,
    /// Its power is positive and a share of that of all.
    pub light: LightBounds,
}

impl Item {
    fn center(&self) -> Vec3 {
        self.light.bounds.center()
    }
}

/// Divides the emitters that are `depth` divisions below the root: reorders them, and gives the number of those in the
/// first part. Neither part is empty unless there are fewer than two.
pub(super) fn split(items: &mut [Item], depth: u32) -> usize {
    if items.len() < 2 {
        return items.len();
    }
    // Halves fit into the divisions that are left; a part of another split may be nearly the whole.
    let divisions_needed = items.len().next_power_of_two().trailing_zeros();
    let centers = Aabb::of(items.iter().map(Item::center));
    let cheapest = if divisions_needed < MAX_DEPTH - depth {
        cheapest_split(items, centers)
    } else {
        None
    };
    let Some((dim, last_bucket)) = cheapest else {
        let dim = centers.extent().max_position();
        // A total order, so that the tree does not depend on how the library sorts.
        items.sort_unstable_by(|a, b| {
            let by_place = a.center()[dim].total_cmp(&b.center()[dim]);
            by_place.then(a.index.cmp(&b.index))
        });
        return items.len() / 2;
    };
    let mut first = 0;
    for i in 0..items.len() {
        if bucket_of(&items[i], centers, dim) <= last_bucket {
            items.swap(i, first);
            first += 1;
        }
    }
    first
}

fn bucket_of(item: &Item, centers: Aabb, dim: usize) -> usize {
    let place = (item.center()[dim] - centers.min[dim]) / centers.extent()[dim];
    ((place * BUCKETS as f32) as usize).min(BUCKETS - 1)
}

/// The dimension and the last bucket of the first part for which the costs of both parts have the least sum. None where
/// the centres agree or nothing has a cost: points on a line have no area.
fn cheapest_split(items: &[Item], centers: Aabb) -> Option<(usize, usize)> {
    let extent = Aabb::extent(
        items
            .iter()
            .fold(Aabb::EMPTY, |all, item| all.union(item.light.bounds)),
    );
    let mut best = None;
    let mut best_cost = f64::INFINITY;
    for dim in 0..3 {
        if centers.extent()[dim] <= 0.0 {
            continue;
        }
        let mut buckets = [Summary::EMPTY; BUCKETS];
        for item in items {
            let bucket = &mut buckets[bucket_of(item, centers, dim)];
            *bucket = bucket.union(Summary::of(&item.light));
        }
        // The costs of what is behind each bucket; an empty part is no split.
        let mut costs_behind = [f64::INFINITY; BUCKETS];
        let mut behind = Summary::EMPTY;
        for bucket in (1..BUCKETS).rev() {
            costs_behind[bucket - 1] = if buckets[bucket].power == 0.0 {
                costs_behind[bucket]
            } else {
                behind = behind.union(buckets[bucket]);
                behind.cost()
            };
        }
        // Splits across the longest edge are favoured, for boxes that are not thin.
        let thinness = f64::from(extent.max_element()) / f64::from(extent[dim]);
        let mut before = Summary::EMPTY;
        for bucket in 0..BUCKETS - 1 {
            if buckets[bucket].power == 0.0 {
                continue;
            }
            before = before.union(buckets[bucket]);
            let cost = thinness * (before.cost() + costs_behind[bucket]);
            if cost > 0.0 && cost < best_cost {
                (best, best_cost) = (Some((dim, bucket)), cost);
            }
        }
    }
    best
}

/// What the cost of a set of emitters depends on.
#[derive(Clone, Copy)]
struct Summary {
    bounds: Aabb,
    power: f64,
    /// The sum of the means of the normals' cones times the power.
    normals: DVec3,
    cos_theta_e: f32,
}

impl Summary {
    const EMPTY: Summary = Summary {
        bounds: Aabb::EMPTY,
        power: 0.0,
        normals: DVec3::ZERO,
        cos_theta_e: 1.0,
    };

    fn of(light: &LightBounds) -> Summary {
        // The mean of the directions of a cone is (1 + cos) / 2 long.
        let mean_length = 0.5 + 0.5 * f64::from(light.cos_theta_o);
        let power = f64::from(light.power);
        Summary {
            bounds: light.bounds,
            power,
            normals: power * mean_length * light.axis.as_dvec3(),
            cos_theta_e: light.cos_theta_e,
        }
    }

    fn union(self, other: Summary) -> Summary {
        Summary {
            bounds: self.bounds.union(other.bounds),
            power: self.power + other.power,
            normals: self.normals + other.normals,
            cos_theta_e: self.cos_theta_e.min(other.cos_theta_e),
        }
    }

    /// Power times area times a measure of the directions that are lit, which is that of the paper.
    ///
    /// Not for the cone of all normals, but for the one whose mean is as long as theirs: that takes one addition for
    /// each emitter, and outliers count by their power.
    fn cost(&self) -> f64 {
        let mean_length = self.normals.length() / self.power;
        let cos_o = (2.0 * mean_length - 1.0).clamp(-1.0, 1.0);
        let sin_o = (1.0 - cos_o * cos_o).sqrt();
        let theta_o = libm::acos(cos_o);
        let theta_e = libm::acos(f64::from(self.cos_theta_e).clamp(-1.0, 1.0));
        let theta_w = (theta_o + theta_e).min(PI);
        let directions = TAU * (1.0 - cos_o)
            + FRAC_PI_2
                * (2.0 * (theta_w - theta_o) * sin_o - libm::cos(theta_o - 2.0 * theta_w) + cos_o);
        let extent = self.bounds.extent().as_dvec3();
        let area = extent.dot(DVec3::new(extent.y, extent.z, extent.x));
        self.power * directions * area
    }
}
