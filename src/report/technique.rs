//! The techniques that a report compares.

use crate::input::{GlobalIllumination, MIN_TARGET_ERROR, Mode, Settings};

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

/// All techniques, in the order of the report.
pub fn techniques() -> Vec<Technique> {
    use Mode::{Montecarlo, MontecarloSupersampling, Raytracing, Supersampling};
    // Camera samples of a pixel, and paths from each diffuse bounce.
    type Points<'a> = &'a [(Option<u32>, &'a [u32])];
    let curve = |curve: &'static str, mode: Mode, points: Points| -> Vec<Technique> {
        let technique = |(number, (samples, splits)): (usize, &(Option<u32>, &[u32]))| Technique {
            curve,
            settings: Settings {
                mode: Some(mode),
                samples: *samples,
                splits: (!splits.is_empty()).then(|| splits.to_vec()),
                gi: Some(GlobalIllumination::PathTraced),
                ..Settings::default()
            },
            is_checked: number == points.len() / 2,
        };
        points.iter().enumerate().map(technique).collect()
    };
    let targets = [0.01, 0.003, 0.001].map(|target| Technique {
        curve: "montecarlo, to a target error",
        settings: Settings {
            mode: Some(Montecarlo),
            samples: Some(4),
            splits: Some(vec![2]),
            target_error: Some(target),
            gi: Some(GlobalIllumination::PathTraced),
            ..Settings::default()
        },
        is_checked: target == 0.003,
    });
    let cached = curve(
        "montecarlo, irradiance cache",
        Montecarlo,
        &[
            (None, &[]),
            (Some(4), &[]),
            (Some(16), &[]),
            (Some(64), &[]),
        ],
    );
    let cached = cached.into_iter().map(|technique| Technique {
        settings: Settings {
            gi: Some(GlobalIllumination::Cached),
            ..technique.settings
        },
        ..technique
    });
    let mut all = [
        curve("raytracing", Raytracing, &[(None, &[])]),
        curve("supersampling: corners", Supersampling, &[(None, &[])]),
        curve(
            "supersampling: spread",
            Raytracing,
            &[(Some(4), &[]), (Some(16), &[])],
        ),
        curve(
            "montecarlo",
            Montecarlo,
            &[(None, &[4]), (None, &[16]), (None, &[64])],
        ),
        curve(
            "montecarlo, 4 camera samples",
            Montecarlo,
            &[(Some(4), &[1]), (Some(4), &[4]), (Some(4), &[16])],
        ),
        curve(
            "montecarlo, one path each",
            Montecarlo,
            &[
                (Some(4), &[1]),
                (Some(16), &[1]),
                (Some(64), &[1]),
                (Some(256), &[1]),
            ],
        ),
        curve(
            "montecarlo, splitting twice",
            Montecarlo,
            &[(Some(4), &[2, 2]), (Some(4), &[8, 2])],
        ),
        curve(
            "montecarlo-supersampling",
            MontecarloSupersampling,
            &[(None, &[8]), (None, &[32])],
        ),
    ]
    .concat();
    all.extend(cached);
    all.extend(targets);
    all
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
        let samples = self.settings.samples.unwrap_or(1);
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
