//! Owen-scrambled Sobol points, padded: only the first two Sobol dimensions are used, which together are a
//! (0, 2)-sequence; further pairs of dimensions are the same points, shuffled and scrambled anew (Burley 2020,
//! "Practical Hash-based Owen Scrambling", JCGT 9(4), section 5).

/// The sample points of one film position in one frame.
///
/// Film positions are pixels or, where neighbouring pixels share the samples in their corners, the corners. Sequences
/// of different film positions, frames or seeds are independent of each other.
#[derive(Clone, Copy, Debug)]
pub struct SobolSequence {
    seed: u32,
}

/// The sampling technique of a sample of a mixture, and the sample's index among those of this technique: see
/// [`SobolSequence::choose_technique`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MixtureChoice {
    /// Three of four samples.
    Cosine(u32),
    /// One of four samples.
    Guided(u32),
}

impl SobolSequence {
    /// The sequence of film position (x, y) in `frame`.
    pub fn new(seed: u32, frame: u32, x: u32, y: u32) -> SobolSequence {
        let seed = [frame, x, y].into_iter().fold(hash(seed), |h, v| {
            hash(h ^ hash(v.wrapping_add(0x9e37_79b9)))
        });
        SobolSequence { seed }
    }

    /// One of the sequences of this position, by number: independent of the others and of `self`.
    pub fn stream(self, number: u32) -> SobolSequence {
        SobolSequence {
            seed: hash(self.seed ^ number.wrapping_add(1).wrapping_mul(0x632b_e5ab)),
        }
    }

    /// The point of sample `index` in [0, 1) x [0, 1), in the pair of dimensions `pair`.
    ///
    /// Any 2^k consecutive samples from a multiple of 2^k on have one point in every elementary interval of area
    /// 2^-k.
    #[inline]
    pub fn sample_2d(self, index: u32, pair: u32) -> [f32; 2] {
        let seed = hash(self.seed ^ pair.wrapping_mul(0x9e37_79b9));
        let index = owen_scramble(index, seed);
        // The first dimension reverses the bits of the index; scrambling would reverse them back.
        let x = scramble_reversed(index, seed.wrapping_mul(0x85eb_ca6b) ^ 0x68bc_21eb);
        let y = scramble_reversed(pascal(index), seed.wrapping_mul(0xc2b2_ae35) ^ 0x02e5_be93);
        // Both reversed at once, which swaps them.
        let both = (u64::from(x) << 32 | u64::from(y)).reverse_bits();
        [unit(both as u32), unit((both >> 32) as u32)]
    }

    /// The number of sample `index` in [0, 1), independent of the points of [`SobolSequence::sample_2d`] with the same
    /// `pair`. Any 2^k consecutive samples from a multiple of 2^k on have one number in every 2^k-th of [0, 1).
    #[inline]
    pub fn sample_1d(self, index: u32, pair: u32) -> f32 {
        let seed = hash(self.seed ^ pair.wrapping_mul(0x9e37_79b9) ^ 0x5851_f42d);
        let index = owen_scramble(index, seed);
        unit(scramble_reversed(index, seed.wrapping_mul(0x85eb_ca6b)).reverse_bits())
    }

    /// Chooses one of two sampling techniques: of every four consecutive samples, one, chosen at random, is guided.
    ///
    /// The indices of either technique count from 0, without gaps.
    #[inline]
    pub fn choose_technique(self, index: u32, pair: u32) -> MixtureChoice {
        let (four, place) = (index / 4, index % 4);
        let seed = self.seed ^ pair.wrapping_mul(0x9e37_79b9) ^ 0x2545_f491;
        let chosen = hash(hash(seed) ^ four) % 4;
        if place == chosen {
            MixtureChoice::Guided(four)
        } else {
            let before = place - u32::from(place > chosen);
            MixtureChoice::Cosine(four.wrapping_mul(3).wrapping_add(before))
        }
    }
}

/// The upper 24 bits as a number in [0, 1): the precision of `f32`.
fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Owen scrambling (nested uniform scrambling), most significant bit first.
fn owen_scramble(value: u32, seed: u32) -> u32 {
    scramble_reversed(value.reverse_bits(), seed).reverse_bits()
}

/// Owen scrambling of a number whose bits are reversed: each bit flips by a hash of those below it. The hash is of
/// the form of Laine and Karras 2011, "Stratified Sampling for Stochastic Transparency", with the constants of
/// Vegdahl 2021, "Building a Better LK Hash". `seed` is hashed already.
fn scramble_reversed(mut value: u32, seed: u32) -> u32 {
    value = value.wrapping_add(hash(seed));
    value ^= value.wrapping_mul(0x6c50_b47c);
    value ^= value.wrapping_mul(0xb82f_1e52);
    value ^= value.wrapping_mul(0xc7af_e638);
    value ^ value.wrapping_mul(0x8d22_f6e6)
}

/// The second Sobol dimension, its bits reversed: the index times Pascal's matrix modulo 2. The matrix is a Kronecker
/// power of its upper left 2 x 2 block, so the product takes five steps.
fn pascal(mut index: u32) -> u32 {
    index ^= (index & 0xffff_0000) >> 16;
    index ^= (index & 0xff00_ff00) >> 8;
    index ^= (index & 0xf0f0_f0f0) >> 4;
    index ^= (index & 0xcccc_cccc) >> 2;
    index ^ (index & 0xaaaa_aaaa) >> 1
}

/// A bijective 32-bit hash of low bias: "lowbias32" of Wellons 2018, "Prospecting for Hash Functions".
fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_elementary_interval_holds_one_point() {
        let sequence = SobolSequence::new(1, 2, 3, 4);
        for pair in [0, 1, 7, 300] {
            for first in [0, 64, 64 * 1025, 1 << 31] {
                let points: Vec<_> = (0..64)
                    .map(|i| sequence.sample_2d(first + i, pair))
                    .collect();
                for columns in [1, 2, 4, 8, 16, 32, 64] {
                    let rows = 64 / columns;
                    let mut hit = [false; 64];
                    for [x, y] in &points {
                        let column = (x * columns as f32) as usize;
                        hit[column * rows + (y * rows as f32) as usize] = true;
                    }
                    assert_eq!(hit, [true; 64], "{columns} columns");
                }
                let mut hit = [false; 64];
                for i in 0..64 {
                    hit[(sequence.sample_1d(first + i, pair) * 64.0) as usize] = true;
                }
                assert_eq!(hit, [true; 64]);
            }
        }
    }

    #[test]
    fn one_of_four_samples_is_guided_and_no_index_is_used_twice() {
        let mut places = [0; 4];
        for x in 0..1000 {
            let sequence = SobolSequence::new(0, 0, x, 0);
            let mut choices: Vec<MixtureChoice> =
                (0..64).map(|i| sequence.choose_technique(i, 3)).collect();
            for four in choices.chunks(4) {
                let guided = four
                    .iter()
                    .position(|d| matches!(d, MixtureChoice::Guided(_)));
                places[guided.expect("one of four")] += 1;
            }
            choices.sort_by_key(|choice| match choice {
                MixtureChoice::Cosine(number) => *number,
                MixtureChoice::Guided(number) => 48 + number,
            });
            let cosine = (0..48).map(MixtureChoice::Cosine);
            assert!(
                choices
                    .into_iter()
                    .eq(cosine.chain((0..16).map(MixtureChoice::Guided)))
            );
        }
        // Five standard deviations of 16,000 choices with a chance of a quarter.
        assert!(
            places.iter().all(|n: &i32| (n - 4000).abs() < 274),
            "{places:?}"
        );
    }

    #[test]
    fn positions_frames_seeds_and_pairs_do_not_correlate() {
        let base = SobolSequence::new(0, 0, 0, 0);
        let n = 4096;
        let draw = |s: SobolSequence, pair: u32| -> Vec<f64> {
            (0..n)
                .map(|i| f64::from(s.sample_2d(i, pair)[0]) - 0.5)
                .collect()
        };
        let first = draw(base, 1);
        let others = [
            draw(SobolSequence::new(0, 0, 1, 0), 1),
            draw(SobolSequence::new(0, 0, 0, 1), 1),
            draw(SobolSequence::new(0, 1, 0, 0), 1),
            draw(SobolSequence::new(1, 0, 0, 0), 1),
            draw(base.stream(0), 1),
            draw(base.stream(1), 1),
            draw(base, 2),
            (0..n)
                .map(|i| f64::from(base.sample_2d(i, 1)[1]) - 0.5)
                .collect(),
            (0..n)
                .map(|i| f64::from(base.sample_1d(i, 1)) - 0.5)
                .collect(),
        ];
        let halves = (draw(base.stream(0), 2), draw(base.stream(1), 2));
        let pairs = others.iter().map(|other| (&first, other));
        for (first, other) in pairs.chain([(&halves.0, &halves.1)]) {
            let sum: f64 = first.iter().zip(other).map(|(a, b)| 12.0 * a * b).sum();
            let covariance = sum / f64::from(n);
            // Five standard deviations of the mean of n products of independent uniforms.
            assert!(covariance.abs() < 5.0 / f64::from(n).sqrt(), "{covariance}");
        }
    }
}
