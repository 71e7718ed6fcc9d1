//! Numbers at axes and of keys.

/// The least of 1, 2, 5, 10, 20, 50 and so on that is not less.
pub(super) fn round_step(at_least: f64) -> u32 {
    let mut ten = 1;
    loop {
        for factor in [1, 2, 5] {
            let step = factor * ten;
            // The greatest step is 10^9.
            if f64::from(step) >= at_least || step >= 1_000_000_000 {
                return step;
            }
        }
        ten *= 10;
    }
}

/// A short label of a number at an axis of length `span`; distinct for distinct marks up to seven digits.
pub(super) fn label(value: f64, span: f64) -> String {
    // More digits do not fit.
    if value.abs() >= 1e7 {
        return format!("{value:.3e}");
    }
    let digits = (1.0 - span.log10()).ceil().clamp(0.0, 9.0) as usize;
    let text = format!("{value:.digits$}");
    let text = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    match text {
        "-0" => "0".to_owned(),
        _ => text.to_owned(),
    }
}

/// Rising numbers as `0, 3–5`; beyond three runs the first and the last as `0 … 9`.
pub(super) fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let runs = runs.map(|run| match *run {
        [.., last] if run.len() > 1 => format!("{}–{last}", run[0]),
        _ => run[0].to_string(),
    });
    let runs: Vec<String> = runs.collect();
    match numbers {
        [first, .., last] if runs.len() > 3 => format!("{first} … {last}"),
        _ => runs.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        for (at_least, step) in [
            (0.0, 1),
            (1.0, 1),
            (1.1, 2),
            (3.0, 5),
            (5.5, 10),
            (101.0, 200),
        ] {
            assert_eq!(round_step(at_least), step);
        }
        assert_eq!(round_step(f64::INFINITY), 1_000_000_000);
    }

    #[test]
    fn labels_tell_marks_apart() {
        for (value, span, expected) in [
            (10.0, 36.0, "10"),
            (-0.0, 36.0, "0"),
            (0.5, 4.0, "0.5"),
            (2.0, 4.0, "2"),
            (1_000_000.5, 2.0, "1000000.5"),
            (0.002, 0.01, "0.002"),
            (-2e12, 1e12, "-2.000e12"),
        ] {
            assert_eq!(label(value, span), expected);
        }
    }

    #[test]
    fn numbers_in_a_row_are_ranges() {
        assert_eq!(ranges(&[0]), "0");
        assert_eq!(ranges(&[0, 3, 4, 5, 9]), "0, 3–5, 9");
        assert_eq!(ranges(&[0, 3, 5, 9]), "0 … 9");
    }
}
