/// The numbers below `count`, in an order of which every beginning is spread over all of them: that of their
/// mirrored bits (van der Corput 1935).
pub(super) fn spread(count: u32) -> impl Iterator<Item = u32> {
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
        assert_eq!(spread(0).count(), 0);
        assert_eq!(spread(1).collect::<Vec<_>>(), [0]);
        assert_eq!(spread(6).collect::<Vec<_>>(), [0, 4, 2, 1, 5, 3]);
    }
}
