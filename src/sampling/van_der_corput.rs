//! The van der Corput order, in which every prefix is spread over the whole (van der Corput 1935,
//! "Verteilungsfunktionen").

/// The numbers below `count` by the radical inverse of their index in base 2: every prefix is spread evenly.
pub fn van_der_corput_order(count: u32) -> impl Iterator<Item = u32> {
    let bits = count.next_power_of_two().trailing_zeros();
    (0..1_u64 << bits)
        .map(move |i| (i as u32).reverse_bits().unbounded_shr(32 - bits))
        .filter(move |number| *number < count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_once_and_spread() {
        assert_eq!(van_der_corput_order(0).count(), 0);
        assert_eq!(van_der_corput_order(1).collect::<Vec<_>>(), [0]);
        assert_eq!(
            van_der_corput_order(6).collect::<Vec<_>>(),
            [0, 4, 2, 1, 5, 3]
        );
    }

    /// The first 2^n of them are nowhere further apart than one part of the whole in 2^n.
    #[test]
    fn prefixes_are_spread() {
        assert!(van_der_corput_order(8).eq([0, 4, 2, 6, 1, 5, 3, 7]));
        for count in [1, 2, 3, 49, 240, 1000] {
            let mut all: Vec<u32> = van_der_corput_order(count).collect();
            for parts in [1_u32, 2, 4, 8] {
                let part = count.next_power_of_two() / parts.min(count);
                let mut first = all[..parts.min(count) as usize].to_vec();
                first.push(count);
                first.sort_unstable();
                assert_eq!(first[0], 0);
                let gaps = first.windows(2).map(|pair| pair[1] - pair[0]);
                assert!(gaps.max() <= Some(part.max(1)), "{count}: {first:?}");
            }
            all.sort_unstable();
            assert_eq!(all, (0..count).collect::<Vec<_>>());
        }
    }
}
