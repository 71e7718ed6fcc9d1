//! Advice from the measurements: the cheapest setting for an error.

use super::measure::Measurement;

/// The relMSE values that are advised on: noise that is just visible, and noise that is hardly so.
pub(super) const TARGETS: [f64; 2] = [0.01, 0.001];

/// The cheapest setting whose relMSE is `target` or less with every seed, in words, or what would reach it. The last
/// argument is columns and rows of the sequence's frames.
pub(super) fn advice(
    measurements: &[Measurement],
    target: f64,
    (width, height): (u32, u32),
) -> String {
    let good = measurements.iter().filter(|m| m.spread[1] <= target);
    let seconds = |of: &&Measurement| of.full_size_seconds;
    if let Some(best) = good.min_by(|a, b| seconds(a).total_cmp(&seconds(b))) {
        let baking = match best.bake_seconds / best.full_size_seconds {
            0.0 => String::new(),
            fraction => format!(", {:.0} % of it for the irradiance cache", 100.0 * fraction),
        };
        return format!(
            "relMSE {target}: `{}`, {:.3} s per frame of {width}x{height}{baking} (measured: {:.2e}).",
            best.flags, best.full_size_seconds, best.rel_mse,
        );
    }
    let ahead = (1..measurements.len()).filter_map(|last| {
        let [a, b] = [&measurements[last - 1], &measurements[last]];
        let ends_curve = measurements
            .get(last + 1)
            .is_none_or(|next| next.curve != b.curve);
        let slope = (b.rel_mse / a.rel_mse).ln() / (b.full_size_seconds / a.full_size_seconds).ln();
        // An error that falls no more never gets there, and adaptive sampling has a target of its own.
        let falls = b.falls_with_samples
            && a.curve == b.curve
            && ends_curve
            && slope < -0.5
            && b.rel_mse > 0.0;
        let factor = (target / b.rel_mse).powf(1.0 / slope);
        falls.then_some((b, b.full_size_seconds * factor))
    });
    match ahead.min_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((best, seconds)) => format!(
            "relMSE {target}: no setting measured gets there. Extrapolated, `{}` would with more samples, in \
             about {seconds:.1} s per frame of {width}x{height}; `--target-error {target}` adds them.",
            best.flags
        ),
        None => format!("relMSE {target}: no setting measured gets there."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(curve: &'static str, flags: &str, seconds: f64, error: f64) -> Measurement {
        Measurement {
            curve,
            flags: flags.to_owned(),
            falls_with_samples: true,
            size: (10, 10),
            seconds: 0.01 * seconds,
            cpu_seconds: 0.01 * seconds,
            bake_seconds: 0.0,
            full_size_seconds: seconds,
            rays: 1.0,
            rays_per_second: 1.0,
            rmse: 0.0,
            rel_mse: error,
            spread: [0.9 * error, 1.1 * error],
            own_estimate: error,
            p95_relative_error: 0.0,
            mean_bias: 0.0,
            mean_bias_interval: [0.0, 0.0],
            flip: 0.0,
        }
    }

    #[test]
    fn the_cheapest_that_is_good_enough_is_advised() {
        let all = [
            measured("a", "--a 1", 1.0, 0.02),
            measured("a", "--a 2", 2.0, 0.0095),
            measured("a", "--a 3", 4.0, 0.005),
            measured("b", "--b 1", 3.0, 0.008),
        ];
        // --a 2 is beyond it with some seeds.
        let said = advice(&all, 0.01, (100, 100));
        assert!(
            said.contains("`--b 1`, 3.000 s per frame of 100x100 (measured"),
            "{said}"
        );
        // --a falls as 1 / n from 4 s and 0.005.
        let said = advice(&all, 0.001, (100, 100));
        assert!(
            said.contains("`--a 3`") && said.contains("--target-error 0.001"),
            "{said}"
        );
        assert!(said.contains("about 2"), "{said}");
        let said = advice(&all[3..4], 0.001, (100, 100));
        assert!(said.ends_with("no setting measured gets there."), "{said}");
    }
    #[test]
    fn a_cache_is_advised_with_its_cost_and_never_beyond_what_is_measured() {
        let mut all = [
            measured("path", "--gi cached --samples 4", 0.5, 0.02),
            measured("path", "--gi cached --samples 16", 2.0, 0.005),
        ];
        for measured in &mut all {
            measured.bake_seconds = 0.5;
            measured.falls_with_samples = false;
        }
        let said = advice(&all, 0.01, (100, 100));
        assert!(
            said.contains(
                "--samples 16`, 2.000 s per frame of 100x100, 25 % of it for the irradiance cache"
            ),
            "{said}"
        );
        // The error falls here, but more samples leave the cache error.
        let said = advice(&all, 0.001, (100, 100));
        assert!(said.ends_with("no setting measured gets there."), "{said}");
    }
}
