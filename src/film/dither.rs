//! The thresholds of dithering: a tile of blue noise, which has no low frequencies that the eye would see, made by the
//! void-and-cluster method (Ulichney 1993, "The void-and-cluster method for dither array generation").
//!
//! Its rows and columns go on from their ends at their beginnings. Channels take it from different places, so that
//! their noise partly cancels out in the brightness. So do frames, along the R2 sequence (Roberts 2018, "The
//! unreasonable effectiveness of quasirandom sequences"): the noise neither stands still nor drifts, and averages out
//! over time.

use crate::sampling::Random;
use std::array;
use std::sync::LazyLock;

/// Rows and columns of the tile.
pub(super) const SIZE: usize = 64;

const CELLS: usize = SIZE * SIZE;

/// The thresholds, each once, row by row: the middles of as many equal parts of 0 to 1 as there are cells.
static TILE: LazyLock<[f32; CELLS]> =
    LazyLock::new(|| ranks().map(|rank| (f32::from(rank) + 0.5) / CELLS as f32));

/// The thresholds of red, green and blue in row `y` of a frame, for columns 0 to 63; they repeat from there on.
pub(super) fn thresholds(frame: u32, y: usize) -> [[f32; 3]; SIZE] {
    let shift =
        |multiple: u32| (frame.wrapping_mul(multiple) >> (u32::BITS - SIZE.ilog2())) as usize;
    // 2^32 / p and 2^32 / p^2, where p^3 = p + 1.
    let [right, down] = [3_242_174_889, 2_447_445_414].map(shift);
    array::from_fn(|x| {
        [(0, 0), (21, 43), (43, 21)].map(|(channel_right, channel_down)| {
            let row = (y + down + channel_down) % SIZE;
            TILE[row * SIZE + (x + right + channel_right) % SIZE]
        })
    })
}

/// The rank of each cell: those below any rank are spread as evenly as those before and after allow.
fn ranks() -> [u16; CELLS] {
    /// Ulichney begins with a tenth. They are random, as regular ones would stay regular.
    const FIRST: usize = CELLS / 10;
    let mut pattern = Pattern::new();
    let mut random = Random::new(1);
    for _ in 0..FIRST {
        let mut free =
            std::iter::repeat_with(|| random.below(CELLS)).filter(|&cell| !pattern.has(cell));
        let cell = free.next().expect("endless");
        pattern.add(cell);
    }
    loop {
        let cluster = pattern.tightest_cluster();
        pattern.remove(cluster);
        let void = pattern.largest_void();
        pattern.add(void);
        if void == cluster {
            break;
        }
    }
    let mut ranks = [0; CELLS];
    let mut thinned = pattern.clone();
    for rank in (0..FIRST).rev() {
        let cell = thinned.tightest_cluster();
        thinned.remove(cell);
        ranks[cell] = rank as u16;
    }
    // Beyond the half, too: the tightest cluster of free cells is the largest void among the taken ones.
    for rank in FIRST..CELLS {
        let cell = pattern.largest_void();
        pattern.add(cell);
        ranks[cell] = rank as u16;
    }
    ranks
}

/// Some cells of the tile, and how close to them each cell is: the sum of a Gaussian around each. The sums are of
/// integers, so that what is removed leaves nothing.
#[derive(Clone)]
struct Pattern {
    /// The Gaussian around cell 0, each row twice in a row.
    gaussian: [[i32; 2 * SIZE]; SIZE],
    closeness: [[i32; SIZE]; SIZE],
    /// The least and the greatest of each row.
    extremes: [[i32; 2]; SIZE],
}

impl Pattern {
    /// What a cell adds to itself: more than all others can.
    const TAKEN: i32 = 1 << 30;

    fn new() -> Pattern {
        /// Ulichney's.
        const SIGMA: f64 = 1.5;
        let gaussian = |x: usize, y: usize| {
            let [x, y] = [x % SIZE, y].map(|i| i.min(SIZE - i) as f64);
            let fall = libm::exp(-(x * x + y * y) / (2.0 * SIGMA * SIGMA));
            (fall * f64::from(1 << 20)) as i32
        };
        let mut pattern = Pattern {
            gaussian: array::from_fn(|y| array::from_fn(|x| gaussian(x, y))),
            closeness: [[0; SIZE]; SIZE],
            extremes: [[0; 2]; SIZE],
        };
        for own in [0, SIZE] {
            pattern.gaussian[0][own] = Self::TAKEN;
        }
        pattern
    }

    fn has(&self, cell: usize) -> bool {
        self.closeness[cell / SIZE][cell % SIZE] >= Self::TAKEN
    }

    fn add(&mut self, cell: usize) {
        self.weigh(cell, 1);
    }

    fn remove(&mut self, cell: usize) {
        self.weigh(cell, -1);
    }

    fn weigh(&mut self, cell: usize, sign: i32) {
        /// Eight rows away the Gaussian is below 1.
        const REACH: usize = 7;
        let [x, y] = [cell % SIZE, cell / SIZE];
        for away in SIZE - REACH..=SIZE + REACH {
            let row = (y + away) % SIZE;
            let closeness = &mut self.closeness[row];
            let gaussian = &self.gaussian[away % SIZE][SIZE - x..2 * SIZE - x];
            let [mut least, mut greatest] = [i32::MAX, i32::MIN];
            for (closeness, gaussian) in closeness.iter_mut().zip(gaussian) {
                *closeness += sign * gaussian;
                least = least.min(*closeness);
                greatest = greatest.max(*closeness);
            }
            self.extremes[row] = [least, greatest];
        }
    }

    /// The cell of the pattern that is closest to others of it.
    fn tightest_cluster(&self) -> usize {
        self.first(self.extremes.iter().map(|row| row[1]).max())
    }

    /// The cell that is farthest from those of the pattern.
    fn largest_void(&self) -> usize {
        self.first(self.extremes.iter().map(|row| row[0]).min())
    }

    /// The first cell whose closeness is that extreme.
    fn first(&self, extreme: Option<i32>) -> usize {
        let extreme = extreme.expect("rows");
        let mut rows = self.extremes.iter();
        let row = rows
            .position(|row| row.contains(&extreme))
            .expect("of a row");
        let mut cells = self.closeness[row].iter();
        row * SIZE + cells.position(|&cell| cell == extreme).expect("in it")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use std::f64::consts::TAU;

    #[test]
    fn every_rank_is_there_once() {
        let mut sorted = ranks();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..CELLS as u16));
        let mut sorted = *TILE;
        sorted.sort_unstable_by(f32::total_cmp);
        assert!(sorted[0] > 0.0 && sorted[CELLS - 1] < 1.0);
    }

    /// The mean power of a pattern of some density at frequencies of up to 6 periods in the tile, as a part of white
    /// noise's.
    fn low_power(ranks: &[u16; CELLS], density: f64) -> f64 {
        let taken = (0..CELLS).filter(|&cell| f64::from(ranks[cell]) < density * CELLS as f64);
        let taken: Vec<usize> = taken.collect();
        let amplitude = |across: usize, down: usize| {
            let waves = taken.iter().map(|cell| {
                let periods = across * (cell % SIZE) + down * (cell / SIZE);
                DVec2::from_angle(TAU * periods as f64 / SIZE as f64)
            });
            waves.sum::<DVec2>()
        };
        let frequencies = (0..=6).flat_map(|across| (0..=6).map(move |down| (across, down)));
        let low = frequencies
            .filter(|&(across, down)| (1..=36).contains(&(across * across + down * down)));
        let powers: Vec<f64> = low
            .map(|(across, down)| amplitude(across, down).length_squared())
            .collect();
        let white = density * (1.0 - density) * CELLS as f64;
        powers.iter().sum::<f64>() / powers.len() as f64 / white
    }

    #[test]
    fn noise_is_blue() {
        let ranks = ranks();
        for (density, limit) in [
            (0.02, 0.3),
            (0.1, 0.1),
            (0.5, 0.04),
            (0.7, 0.04),
            (0.95, 0.15),
        ] {
            let power = low_power(&ranks, density);
            assert!(power < limit, "{density}: {power}");
        }
    }
}
