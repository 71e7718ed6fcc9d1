//! Advice from the measurements: the cheapest setting for an error.

use super::bias::BiasRow;
use super::measure::Measurement;
use super::technique::Technique;

/// The cheapest setting whose relMSE is `target` or less with every seed, in words, or what would reach it.
/// `techniques` are those of the measurements, and the last argument is columns and rows of the sequence's frames.
///
/// A biased technique is as good as any: its relMSE includes the bias, which the words say.
pub(super) fn advice(
    techniques: &[Technique],
    measurements: &[Measurement],
    bias: &[BiasRow],
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
        let is_biased = |row: &BiasRow| row.is_biased && row.curve == best.curve;
        let included = match bias.iter().any(is_biased) {
            true => ", bias included",
            false => "",
        };
        return format!(
            "relMSE {target}: `{}`, {:.3} s per frame of {width}x{height}{baking} (measured: {:.2e}{included}).",
            best.flags, best.full_size_seconds, best.rel_mse,
        );
    }
    let ahead = (1..measurements.len()).filter_map(|last| {
        let [a, b] = [&measurements[last - 1], &measurements[last]];
        let next = measurements.get(last + 1);
        let ends_curve = next.is_none_or(|next| next.curve != b.curve);
        let slope = (b.rel_mse / a.rel_mse).ln() / (b.full_size_seconds / a.full_size_seconds).ln();
        // An error that falls no more never gets there.
        let falls = a.curve == b.curve && ends_curve && slope < -0.5 && b.rel_mse > 0.0;
        let flags = techniques[last].flags_to(target).filter(|_| falls)?;
        let factor = (target / b.spread[1]).powf(1.0 / slope);
        Some((flags, b.full_size_seconds * factor))
    });
    match ahead.min_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((flags, seconds)) => format!(
            "relMSE {target}: no setting measured gets there. Extrapolated, `{flags}` does, in about {seconds:.1} s per \
             frame of {width}x{height}.",
        ),
        None => format!("relMSE {target}: no setting measured gets there."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::{GlobalIllumination, Mode, Samples, Settings};
    use crate::metrics::Estimate;

    /// A technique of some samples, and what it costs.
    fn measured(
        curve: &'static str,
        gi: GlobalIllumination,
        samples: u32,
        seconds: f64,
        error: f64,
    ) -> (Technique, Measurement) {
        let technique = Technique {
            curve,
            settings: Settings {
                mode: Some(Mode::Montecarlo),
                samples: Some(Samples::Spread(samples)),
                splits: (gi == GlobalIllumination::PathTraced).then(|| vec![1]),
                gi: Some(gi),
                ..Settings::default()
            },
            is_checked: false,
        };
        let measurement = Measurement {
            curve,
            flags: technique.flags(),
            has_indirect: true,
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
        };
        (technique, measurement)
    }

    fn said(all: &[(Technique, Measurement)], bias: &[BiasRow], target: f64) -> String {
        let (techniques, measurements): (Vec<_>, Vec<_>) = all.iter().cloned().unzip();
        advice(&techniques, &measurements, bias, target, (100, 100))
    }

    #[test]
    fn the_cheapest_that_is_good_enough_is_advised() {
        let path_traced = |curve, samples, seconds, error| {
            measured(
                curve,
                GlobalIllumination::PathTraced,
                samples,
                seconds,
                error,
            )
        };
        let all = [
            path_traced("a", 1, 1.0, 0.02),
            path_traced("a", 2, 2.0, 0.0095),
            path_traced("a", 3, 4.0, 0.005),
            path_traced("b", 9, 3.0, 0.008),
        ];
        // Two samples are beyond it with some seeds.
        let good = said(&all, &[], 0.01);
        assert!(
            good.starts_with("relMSE 0.01: `--mode montecarlo --samples 9 --splits 1`, 3.000 s per frame of 100x100 (measured: 8.00e-3)"),
            "{good}"
        );
        // The error falls as 1 / n from 4 s and 0.0055 with the worst seed.
        let extrapolated = said(&all, &[], 0.001);
        assert!(
            extrapolated
                .contains("`--mode montecarlo --samples 3 --splits 1 --target-error 0.001` does"),
            "{extrapolated}"
        );
        assert!(extrapolated.contains("about 2"), "{extrapolated}");
        let none = said(&all[3..4], &[], 0.001);
        assert!(none.ends_with("no setting measured gets there."), "{none}");
    }

    #[test]
    fn a_cache_is_advised_with_its_cost_and_bias_and_never_beyond_what_is_measured() {
        let cached = |samples, seconds, error| {
            let of_cache = GlobalIllumination::Cached;
            let (technique, mut of) = measured("cache", of_cache, samples, seconds, error);
            of.bake_seconds = 0.5;
            (technique, of)
        };
        let all = [cached(4, 0.5, 0.02), cached(16, 2.0, 0.005)];
        let bias = |curve, is_biased| BiasRow {
            curve,
            flags: String::new(),
            size: (10, 10),
            pixels: 9,
            squared_bias: Estimate::of(&[1.0, 2.0]),
            mean_bias: Estimate::of(&[1.0, 2.0]),
            is_biased,
        };
        let good = "--samples 16 --gi cached`, 2.000 s per frame of 100x100, 25 % of it for the irradiance cache \
                    (measured: 5.00e-3";
        for (bias, end) in [
            (bias("cache", true), ", bias included)."),
            (bias("cache", false), ")."),
            (bias("another", true), ")."),
        ] {
            let said = said(&all, &[bias], 0.01);
            assert!(said.ends_with(&format!("{good}{end}")), "{said}");
        }
        // The error falls here, but more samples leave the cache error.
        let none = said(&all, &[], 0.001);
        assert!(none.ends_with("no setting measured gets there."), "{none}");
    }
}
