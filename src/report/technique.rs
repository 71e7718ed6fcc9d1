//! The techniques that a report compares.

use crate::input::{GlobalIllumination, Mode, Samples, Settings};
use crate::render::PixelSampling;

/// The relMSE values that are advised on: noise that is just visible, noise that is hardly so, and smooth edges.
pub(super) const TARGETS: [f64; 3] = [0.01, 0.001, 0.0002];

/// About how many paths take as long as a camera sample without indirect light.
pub(super) const WITHOUT_PATHS: f64 = 0.2;

/// One way to render a frame.
#[derive(Clone, Debug)]
pub struct Technique {
    /// The name of its curve. Techniques of one curve differ only in their sample counts.
    pub curve: &'static str,
    /// What it sets; the rest is the sequence's own.
    pub settings: Settings,
    /// Whether its bias is checked: one of each curve is.
    pub is_checked: bool,
}

/// How many camera samples the frames of a technique have.
#[derive(Clone, Copy)]
enum Amount {
    Given(Samples),
    /// As many as it takes for this error.
    TargetError(f64),
    /// As many as it takes for the error of the mode.
    Default,
}

/// All techniques, in the order of the report.
pub fn techniques() -> Vec<Technique> {
    use Amount::{Default, TargetError};
    use GlobalIllumination::{Cached, PathTraced};
    use Mode::{Montecarlo, Raytracing, Supersampling};
    const CENTER: Amount = Amount::Given(Samples::Center);
    const CORNERS: Amount = Amount::Given(Samples::Corners);
    let spread = |count| Amount::Given(Samples::Spread(count));
    let curve = |curve: &'static str, mode, gi, points: &[(Amount, &[u32])]| {
        let technique = |(number, &(amount, splits)): (usize, &(Amount, &[u32]))| Technique {
            curve,
            settings: Settings {
                mode: Some(mode),
                samples: match amount {
                    Amount::Given(samples) => Some(samples),
                    TargetError(_) | Default => None,
                },
                target_error: match amount {
                    TargetError(target) => Some(target),
                    Amount::Given(_) | Default => None,
                },
                splits: (!splits.is_empty()).then(|| splits.to_vec()),
                gi: Some(gi),
                ..Settings::default()
            },
            is_checked: number == points.len() / 2,
        };
        points.iter().enumerate().map(technique).collect::<Vec<_>>()
    };
    let path_traced =
        |name, points: &[(Amount, &[u32])]| curve(name, Montecarlo, PathTraced, points);
    let without_paths = |name, mode, gi, amounts: &[Amount]| {
        let points: Vec<(Amount, &[u32])> =
            amounts.iter().map(|&amount| (amount, &[][..])).collect();
        curve(name, mode, gi, &points)
    };
    let direct = |name, mode, amounts: &[Amount]| without_paths(name, mode, PathTraced, amounts);
    let cached = |name, amounts: &[Amount]| without_paths(name, Montecarlo, Cached, amounts);
    let [visible, hardly_visible, smooth] = TARGETS.map(TargetError);
    [
        direct("direct light, center", Raytracing, &[CENTER]),
        direct("direct light, corners", Supersampling, &[CORNERS]),
        direct(
            "direct light, spread",
            Supersampling,
            &[spread(4), spread(16)],
        ),
        // With a target error, raytracing is supersampling.
        direct(
            "direct light, adaptive",
            Supersampling,
            &[hardly_visible, smooth],
        ),
        path_traced(
            "path-traced, center",
            &[(CENTER, &[4]), (CENTER, &[16]), (CENTER, &[64])],
        ),
        path_traced("path-traced, corners", &[(CORNERS, &[8]), (CORNERS, &[32])]),
        path_traced(
            "path-traced, 4 camera samples",
            &[(spread(4), &[4]), (spread(4), &[16])],
        ),
        path_traced(
            "path-traced, one path each",
            &[
                (spread(4), &[1]),
                (spread(16), &[1]),
                (spread(64), &[1]),
                (spread(256), &[1]),
            ],
        ),
        // The smallest target would take longer than all others together: advice extrapolates to it.
        path_traced(
            "path-traced, adaptive",
            &[
                (visible, &[2]),
                (TargetError(0.003), &[2]),
                (hardly_visible, &[2]),
            ],
        ),
        cached(
            "irradiance cache",
            &[CENTER, spread(4), spread(16), spread(64)],
        ),
        cached(
            "irradiance cache, adaptive",
            &[visible, hardly_visible, Default, smooth],
        ),
    ]
    .concat()
}

impl Technique {
    /// The flags of `flythrough render` that select it.
    pub fn flags(&self) -> String {
        let Settings {
            mode,
            samples,
            splits,
            target_error,
            gi,
            ..
        } = &self.settings;
        let mut flags = format!("--mode {}", mode.unwrap_or_default());
        if let Some(samples) = samples {
            flags += &format!(" --samples {samples}");
        }
        if let Some(splits) = splits {
            let splits: Vec<String> = splits.iter().map(u32::to_string).collect();
            flags += &format!(" --splits {}", splits.join(","));
        }
        if let Some(target) = target_error {
            flags += &format!(" --target-error {target}");
        }
        if *gi == Some(GlobalIllumination::Cached) {
            flags += " --gi cached";
        }
        flags
    }

    /// Whether it uses the irradiance cache.
    pub(super) fn uses_cache(&self) -> bool {
        self.settings.gi == Some(GlobalIllumination::Cached)
    }

    /// Whether it renders indirect diffuse light, as the references do.
    pub(super) fn has_indirect(&self) -> bool {
        !matches!(
            self.settings.mode.unwrap_or_default(),
            Mode::Raytracing | Mode::Supersampling
        )
    }

    /// Its flags with another target error, where more samples reduce the error without bound: they add no indirect
    /// light and do not reduce the error of an irradiance cache.
    pub(super) fn flags_to(&self, target: f64) -> Option<String> {
        let targeted = Technique {
            settings: Settings {
                target_error: Some(target),
                ..self.settings.clone()
            },
            ..self.clone()
        };
        let falls =
            self.has_indirect() && !self.uses_cache() && targeted.settings.check_together().is_ok();
        falls.then(|| targeted.flags())
    }

    /// The error that decides how many samples each pixel gets, if one does.
    pub(super) fn target(&self) -> Option<f64> {
        match (
            self.settings.target_error,
            self.settings.resolve(1).sampling,
        ) {
            (Some(target), _) | (None, PixelSampling::Adaptive(target)) => Some(target),
            _ => None,
        }
    }

    /// About how many paths each pixel traces, for the progress.
    pub(super) fn paths(&self) -> f64 {
        let paths_of_sample = match &self.settings.splits {
            Some(splits) => splits.iter().map(|&split| f64::from(split)).product(),
            None => WITHOUT_PATHS,
        };
        match (self.target(), self.settings.samples) {
            (Some(target), _) if self.has_indirect() && !self.uses_cache() => 0.1 / target,
            (Some(target), _) => 0.005 / target * WITHOUT_PATHS,
            (None, Some(Samples::Spread(count))) => f64::from(count) * paths_of_sample,
            (None, _) => paths_of_sample,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::MIN_TARGET_ERROR;
    use std::collections::BTreeMap;

    #[test]
    fn every_technique_can_be_rendered_and_every_curve_is_checked_once() {
        let mut checked: BTreeMap<&str, usize> = BTreeMap::new();
        let mut flags = Vec::new();
        for technique in techniques() {
            assert_eq!(technique.settings.check(), Ok(()));
            assert_eq!(technique.settings.check_together(), Ok(()));
            *checked.entry(technique.curve).or_default() += usize::from(technique.is_checked);
            flags.push(technique.flags());
        }
        assert!(checked.values().all(|count| *count == 1), "{checked:?}");
        let all = flags.len();
        flags.sort();
        flags.dedup();
        assert_eq!(flags.len(), all, "nothing is measured twice");
    }

    #[test]
    fn only_path_traced_light_at_random_positions_gets_any_error() {
        for technique in techniques() {
            let flags = technique.flags();
            let is_path_traced = flags.contains("montecarlo") && !flags.contains("--gi cached");
            let is_fixed = flags.contains("center") || flags.contains("corners");
            let extended = technique.flags_to(MIN_TARGET_ERROR);
            assert_eq!(extended.is_some(), is_path_traced && !is_fixed, "{flags}");
            if let Some(extended) = extended {
                assert_eq!(extended.matches("--target-error").count(), 1, "{extended}");
                assert!(extended.contains("--target-error 0.000001"), "{extended}");
            }
            assert_eq!(technique.uses_cache(), flags.contains("--gi cached"));
            assert_eq!(technique.has_indirect(), flags.contains("montecarlo"));
        }
    }

    #[test]
    fn samples_follow_an_error_where_nothing_else_counts_them() {
        for technique in techniques() {
            let flags = technique.flags();
            let is_counted = flags.contains("--samples");
            assert_eq!(technique.target().is_none(), is_counted, "{flags}");
        }
    }

    #[test]
    fn flags_are_the_settings() {
        let of = |curve: &str| -> Vec<String> {
            let techniques = techniques().into_iter().filter(|t| t.curve == curve);
            techniques.map(|t| t.flags()).collect()
        };
        for (curve, flags) in [
            ("direct light, center", "--mode raytracing --samples center"),
            (
                "direct light, adaptive",
                "--mode supersampling --target-error 0.0002",
            ),
            (
                "path-traced, corners",
                "--mode montecarlo --samples corners --splits 32",
            ),
            (
                "path-traced, adaptive",
                "--mode montecarlo --splits 2 --target-error 0.001",
            ),
            (
                "irradiance cache",
                "--mode montecarlo --samples 64 --gi cached",
            ),
            (
                "irradiance cache, adaptive",
                "--mode montecarlo --gi cached",
            ),
            (
                "irradiance cache, adaptive",
                "--mode montecarlo --target-error 0.0002 --gi cached",
            ),
        ] {
            assert!(of(curve).iter().any(|of| of == flags), "{:?}", of(curve));
        }
    }
}
