//! The techniques that a report compares.

use crate::input::{GlobalIllumination, MIN_TARGET_ERROR, Mode, Samples, Settings};

/// About how many paths take as long as a camera sample without indirect light.
pub(super) const WITHOUT_PATHS: f64 = 0.2;

/// One way to render a frame.
#[derive(Clone, Debug)]
pub struct Technique {
    /// The name of its curve. Techniques of one curve differ only in their sample counts.
    pub curve: &'static str,
    /// What it sets; the rest is the sequence's own.
    pub settings: Settings,
    /// Whether its bias is checked: at most one of each curve is.
    pub is_checked: bool,
}

/// How many camera samples the frames of a technique have.
#[derive(Clone, Copy)]
enum Amount {
    Samples(Samples),
    /// As many as it takes.
    TargetError(f64),
}

/// All techniques, in the order of the report.
pub fn techniques() -> Vec<Technique> {
    use Amount::TargetError;
    use Mode::{Montecarlo, Raytracing, Supersampling};
    const CENTER: Amount = Amount::Samples(Samples::Center);
    const CORNERS: Amount = Amount::Samples(Samples::Corners);
    let spread = |count| Amount::Samples(Samples::Spread(count));
    let curve = |curve: &'static str, mode: Mode, gi, points: &[(Amount, &[u32])]| {
        let technique = |(number, (amount, splits)): (usize, &(Amount, &[u32]))| Technique {
            curve,
            settings: Settings {
                mode: Some(mode),
                samples: match amount {
                    Amount::Samples(samples) => Some(*samples),
                    TargetError(_) => None,
                },
                target_error: match amount {
                    Amount::Samples(_) => None,
                    TargetError(target) => Some(*target),
                },
                splits: (!splits.is_empty()).then(|| splits.to_vec()),
                gi: Some(gi),
                ..Settings::default()
            },
            is_checked: number == points.len() / 2,
        };
        points.iter().enumerate().map(technique).collect::<Vec<_>>()
    };
    let path_traced = |name, points: &[(Amount, &[u32])]| {
        curve(name, Montecarlo, GlobalIllumination::PathTraced, points)
    };
    let direct = |name, mode, amounts: &[Amount]| {
        let points: Vec<(Amount, &[u32])> =
            amounts.iter().map(|&amount| (amount, &[][..])).collect();
        curve(name, mode, GlobalIllumination::PathTraced, &points)
    };
    let cached = |name, amounts: &[Amount]| {
        let points: Vec<(Amount, &[u32])> =
            amounts.iter().map(|&amount| (amount, &[][..])).collect();
        curve(name, Montecarlo, GlobalIllumination::Cached, &points)
    };
    let targets = [TargetError(0.003), TargetError(0.001), TargetError(0.0003)];
    [
        direct("raytracing", Raytracing, &[CENTER]),
        direct("supersampling: corners", Supersampling, &[CORNERS]),
        direct(
            "supersampling: spread",
            Supersampling,
            &[spread(4), spread(16)],
        ),
        direct(
            "supersampling, to a target error",
            Supersampling,
            &targets[1..],
        ),
        path_traced(
            "montecarlo",
            &[(CENTER, &[4]), (CENTER, &[16]), (CENTER, &[64])],
        ),
        path_traced("montecarlo: corners", &[(CORNERS, &[8]), (CORNERS, &[32])]),
        path_traced(
            "montecarlo, 4 camera samples",
            &[(spread(4), &[1]), (spread(4), &[4]), (spread(4), &[16])],
        ),
        path_traced(
            "montecarlo, one path each",
            &[
                (spread(4), &[1]),
                (spread(16), &[1]),
                (spread(64), &[1]),
                (spread(256), &[1]),
            ],
        ),
        path_traced(
            "montecarlo, splitting twice",
            &[(spread(4), &[2, 2]), (spread(4), &[8, 2])],
        ),
        path_traced(
            "montecarlo, to a target error",
            &[
                (TargetError(0.01), &[2]),
                (targets[0], &[2]),
                (targets[1], &[2]),
            ],
        ),
        cached(
            "montecarlo, irradiance cache",
            &[CENTER, spread(4), spread(16), spread(64)],
        ),
        cached("montecarlo, irradiance cache, to a target error", &targets),
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

    /// Whether `--target-error` can be added to the flags, and more samples reduce the error without bound: they do not
    /// reduce the cache error.
    pub(super) fn falls_with_samples(&self) -> bool {
        let targeted = Settings {
            target_error: Some(MIN_TARGET_ERROR),
            ..self.settings.clone()
        };
        let is_free = self.settings.target_error.is_none() && !self.uses_cache();
        is_free && targeted.check_together().is_ok()
    }

    /// About how many paths each pixel traces, for the progress.
    pub(super) fn paths(&self) -> f64 {
        let samples = match self.settings.samples {
            Some(Samples::Spread(count)) => count,
            _ => 1,
        };
        let paths = match &self.settings.splits {
            Some(splits) => splits.iter().map(|&split| f64::from(split)).product(),
            None => WITHOUT_PATHS,
        };
        let wanted = self
            .settings
            .target_error
            .map_or(1.0, |target| 0.1 / target);
        f64::from(samples) * paths * wanted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn every_technique_can_be_rendered_and_every_curve_is_checked_once_at_most() {
        let mut checked: BTreeMap<&str, usize> = BTreeMap::new();
        for technique in techniques() {
            assert_eq!(technique.settings.check(), Ok(()));
            assert_eq!(technique.settings.check_together(), Ok(()));
            *checked.entry(technique.curve).or_default() += usize::from(technique.is_checked);
        }
        assert!(checked.values().all(|count| *count <= 1), "{checked:?}");
        assert_eq!(checked["montecarlo"], 1);
    }

    #[test]
    fn adaptive_sampling_needs_path_traced_light() {
        for technique in techniques() {
            let flags = technique.flags();
            let gathers = flags.contains("montecarlo") && !flags.contains("--gi cached");
            let has_target = flags.contains("--target-error");
            let falls = technique.falls_with_samples();
            assert_eq!(falls, gathers && !has_target, "{flags}");
            assert_eq!(
                technique.uses_cache(),
                flags.contains("--gi cached"),
                "{flags}"
            );
        }
    }

    #[test]
    fn flags_are_the_settings() {
        let find = |curve: &str| techniques().into_iter().rfind(|t| t.curve == curve);
        for (curve, flags) in [
            ("raytracing", "--mode raytracing"),
            (
                "montecarlo, splitting twice",
                "--mode montecarlo --samples 4 --splits 8,2",
            ),
            (
                "montecarlo, irradiance cache",
                "--mode montecarlo --samples 64 --gi cached",
            ),
            (
                "montecarlo, to a target error",
                "--mode montecarlo --samples 4 --splits 2 --target-error 0.001",
            ),
        ] {
            assert_eq!(find(curve).map(|t| t.flags()).as_deref(), Some(flags));
        }
    }
}
