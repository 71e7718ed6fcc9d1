/// The longest Owen-scrambled sequence the generator gives before it must be reseeded.
const SEQUENCE_LENGTH: u32 = 1 << 16;

/// The sample numbers of one film position in one frame: Owen-scrambled Sobol points
/// (Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 9(4)).
///
/// Film positions are pixels or, when neighbours share their corners, lattice points. Sequences
/// of different film positions, frames or seeds are independent of each other.
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    seed: u32,
}

impl Sequence {
    /// The sequence of film position (x, y) in `frame`.
    pub fn new(seed: u32, frame: u32, x: u32, y: u32) -> Sequence {
        let seed = [frame, x, y]
            .into_iter()
            .fold(hash(seed), |h, v| hash(h ^ hash(v.wrapping_add(0x9e37_79b9))));
        Sequence { seed }
    }

    /// Four numbers in [0, 1) of sample `index`, for the purpose numbered `set`.
    ///
    /// Within a set the points of consecutive indices are stratified together, best in the first
    /// two numbers; sets are padded, that is shuffled independently of each other (Burley,
    /// section 5). Beyond 65,536 samples another scramble is used, independent of the first.
    #[inline]
    pub fn sample_4d(self, index: u32, set: u32) -> [f32; 4] {
        let block = index / SEQUENCE_LENGTH;
        let scramble = hash(self.seed ^ (block << 16 | set));
        sobol_burley::sample_4d(index % SEQUENCE_LENGTH, 0, scramble)
    }
}

/// A bijective 32-bit hash of low bias: "lowbias32", C. Wellons 2018, "Prospecting for Hash
/// Functions".
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
    fn sixteen_samples_fill_a_sixteenth_each_and_4_by_4_squares() {
        let sequence = Sequence::new(1, 2, 3, 4);
        for set in [0, 1, 2, 5, 300] {
            for first in [0, 16, 65_536, 131_120] {
                let points: Vec<_> = (0..16).map(|i| sequence.sample_4d(first + i, set)).collect();
                for dimension in 0..4 {
                    let mut hit = [false; 16];
                    for p in &points {
                        hit[(p[dimension] * 16.0) as usize] = true;
                    }
                    assert_eq!(hit, [true; 16]);
                }
                let mut hit = [false; 16];
                for p in &points {
                    hit[(p[0] * 4.0) as usize * 4 + (p[1] * 4.0) as usize] = true;
                }
                assert_eq!(hit, [true; 16]);
            }
        }
    }

    #[test]
    fn neighbours_frames_and_seeds_do_not_correlate() {
        let base = Sequence::new(0, 0, 0, 0);
        let others = [
            Sequence::new(0, 0, 1, 0),
            Sequence::new(0, 0, 0, 1),
            Sequence::new(0, 1, 0, 0),
            Sequence::new(1, 0, 0, 0),
        ];
        for other in others {
            let n = 4096;
            let covariance = (0..n)
                .map(|i| {
                    let a = f64::from(base.sample_4d(i, 1)[0]) - 0.5;
                    let b = f64::from(other.sample_4d(i, 1)[0]) - 0.5;
                    12.0 * a * b
                })
                .sum::<f64>()
                / f64::from(n);
            // Five standard deviations of the mean of n products of independent uniforms.
            assert!(covariance.abs() < 5.0 / f64::from(n).sqrt(), "{covariance}");
        }
    }
}
