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
}
