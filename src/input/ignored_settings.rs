//! Settings that are given and make no difference.

use super::settings_file::Settings;
use crate::integrator::IntegratorSettings;
use crate::render::PixelSampling;
use crate::scene::Scene;

/// A setting that makes no difference to the frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IgnoredSetting {
    /// Its name.
    pub key: &'static str,
    /// Why, and what to do.
    pub reason: String,
}

impl Settings {
    /// The settings that frames of a scene, in a sequence of `frames`, do not use, though they are given here.
    pub fn ignored(&self, scene: &Scene, frames: u32) -> Vec<IgnoredSetting> {
        let mode = self.mode.unwrap_or_default();
        let resolved = self.resolve(frames);
        let has_fixed_samples = matches!(
            resolved.sampling,
            PixelSampling::Center | PixelSampling::Corners
        );
        let is_random = !has_fixed_samples || scene.has_soft_shadows();
        let mut ignored = Vec::new();
        let mut ignore = |key, is_given: bool, reason: String| {
            if is_given {
                ignored.push(IgnoredSetting { key, reason });
            }
        };
        match resolved.integrator {
            IntegratorSettings::Whitted { .. } => {
                let no_paths =
                    format!("{mode} traces no paths of indirect light; choose a montecarlo mode");
                ignore("splits", self.splits.is_some(), no_paths.clone());
                ignore("gi", self.gi.is_some(), no_paths);
                let no_chance =
                    format!("{mode} uses random numbers only with `samples` or soft shadows");
                ignore("seed", self.seed.is_some() && !is_random, no_chance.clone());
                ignore(
                    "lock_seed",
                    self.lock_seed == Some(true) && !is_random,
                    no_chance,
                );
            }
            IntegratorSettings::Cached { .. } => {
                let reason = "an irradiance cache traces its own paths; choose gi \"path-traced\"";
                ignore("splits", self.splits.is_some(), reason.to_owned());
            }
            IntegratorSettings::PathTraced { bounces: 0, .. } => {
                let reason = "there is no indirect light after 0 `bounces`";
                ignore("splits", self.splits.is_some(), reason.to_owned());
            }
            IntegratorSettings::PathTraced { .. } => {}
        }
        let samples_sky = resolved.integrator.gathers() && !scene.sky.is_black();
        let has_shadow_rays = scene.has_soft_shadows() || samples_sky;
        let reason = "no light has a size: nothing emits, and no light has a radius or an angle";
        ignore(
            "shadow_rays",
            self.shadow_rays.is_some() && !has_shadow_rays,
            reason.to_owned(),
        );
        ignored
    }
}

/// The settings of some sources that make no difference, each with the number of its source; the strongest source is
/// first.
///
/// A setting counts only where its own source, with those weaker than it, ignores it: a file's settings are made for
/// the file's mode, and another one that is chosen for once does not make them wrong.
pub fn ignored_settings(
    sources: &[Settings],
    scene: &Scene,
    frames: u32,
) -> Vec<(usize, IgnoredSetting)> {
    let from = |first: usize| {
        let sources = sources[first..].iter().cloned();
        sources.fold(Settings::default(), Settings::or)
    };
    let of_all = from(0).ignored(scene, frames);
    let of_all = |key: &str| of_all.iter().any(|ignored| ignored.key == key);
    let mut found: Vec<(usize, IgnoredSetting)> = Vec::new();
    for (number, source) in sources.iter().enumerate() {
        let own = source.gives();
        for ignored in from(number).ignored(scene, frames) {
            let is_new = found.iter().all(|(_, earlier)| earlier.key != ignored.key);
            if own.contains(&ignored.key) && of_all(ignored.key) && is_new {
                found.push((number, ignored));
            }
        }
    }
    found
}

impl Settings {
    /// The keys that may be ignored and are given here.
    fn gives(&self) -> Vec<&'static str> {
        let given = [
            ("splits", self.splits.is_some()),
            ("gi", self.gi.is_some()),
            ("seed", self.seed.is_some()),
            ("lock_seed", self.lock_seed == Some(true)),
            ("shadow_rays", self.shadow_rays.is_some()),
        ];
        let given = given.into_iter().filter(|(_, is_given)| *is_given);
        given.map(|(key, _)| key).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::Samples;
    use super::super::technique::GlobalIllumination::{Cached, PathTraced};
    use super::super::technique::Mode::{self, Montecarlo, Raytracing, Supersampling};
    use super::*;
    use crate::light::{Sky, Sun};
    use crate::scene::SceneBuilder;
    use glam::Vec3;

    /// Without lights.
    fn dark() -> Scene {
        SceneBuilder::default().build().0
    }

    /// All of which may be ignored.
    fn all(mode: Option<Mode>) -> Settings {
        Settings {
            mode,
            splits: Some(vec![8]),
            gi: Some(PathTraced),
            seed: Some(1),
            lock_seed: Some(true),
            bounces: Some(2),
            exposure: Some(1.0),
            ..Settings::default()
        }
    }

    fn keys_in(scene: &Scene, settings: &Settings) -> Vec<&'static str> {
        let ignored = settings.ignored(scene, 9);
        ignored.iter().map(|ignored| ignored.key).collect()
    }

    fn keys(settings: &Settings) -> Vec<&'static str> {
        keys_in(&dark(), settings)
    }

    #[test]
    fn each_mode_ignores_what_it_does_not_use() {
        for mode in [None, Some(Raytracing), Some(Supersampling)] {
            let center = Settings {
                samples: Some(Samples::Center),
                ..all(mode)
            };
            assert_eq!(keys(&center), ["splits", "gi", "seed", "lock_seed"]);
            let spread = Settings {
                samples: Some(Samples::Spread(9)),
                ..all(mode)
            };
            assert_eq!(keys(&spread), ["splits", "gi"]);
        }
        assert_eq!(keys(&all(Some(Montecarlo))), [""; 0]);
        let cached = Settings {
            gi: Some(Cached),
            ..all(Some(Montecarlo))
        };
        assert_eq!(keys(&cached), ["splits"]);
        let direct = Settings {
            bounces: Some(0),
            ..all(Some(Montecarlo))
        };
        assert_eq!(keys(&direct), ["splits"]);
        assert_eq!(keys(&Settings::default()), [""; 0]);
    }

    /// Soft shadows are random in every mode; where light is gathered, shadow rays look for the sky, too.
    #[test]
    fn shadow_rays_are_for_lights_with_a_size() {
        let mut sunny = SceneBuilder::default();
        sunny.suns.push(Sun {
            to_sun: Vec3::Y,
            irradiance: Vec3::ONE,
            one_minus_cos: 0.01,
        });
        let sunny = sunny.build().0;
        let mut open = dark();
        open.sky = Sky::Uniform(Vec3::ONE);
        let settings = |mode| Settings {
            mode: Some(mode),
            samples: Some(Samples::Center),
            seed: Some(1),
            shadow_rays: Some(4),
            ..Settings::default()
        };
        for (scene, mode, ignored) in [
            (&dark(), Raytracing, &["seed", "shadow_rays"][..]),
            (&open, Raytracing, &["seed", "shadow_rays"]),
            (&sunny, Raytracing, &[]),
            (&dark(), Montecarlo, &["shadow_rays"]),
            (&open, Montecarlo, &[]),
            (&sunny, Montecarlo, &[]),
        ] {
            assert_eq!(keys_in(scene, &settings(mode)), ignored, "{mode}");
        }
    }

    #[test]
    fn settings_count_where_they_are_given() {
        let found = |sources: &[Settings]| -> Vec<(usize, &'static str)> {
            let ignored = ignored_settings(sources, &dark(), 9).into_iter();
            ignored
                .map(|(source, ignored)| (source, ignored.key))
                .collect()
        };
        let none = Settings::default();
        let splits = |mode| Settings {
            mode,
            splits: Some(vec![8]),
            ..Settings::default()
        };
        let mode = |mode| Settings {
            mode: Some(mode),
            ..Settings::default()
        };
        assert_eq!(
            found(&[splits(None), none.clone(), mode(Raytracing)]),
            [(0, "splits")]
        );
        assert_eq!(
            found(&[none.clone(), none.clone(), splits(None)]),
            [(2, "splits")]
        );
        assert_eq!(
            found(&[splits(None), none.clone(), splits(None)]),
            [(0, "splits")]
        );
        // The file is made for another mode than the flag chooses.
        assert_eq!(
            found(&[mode(Raytracing), none.clone(), splits(Some(Montecarlo))]),
            []
        );
        // The flag makes use of what the file's mode does not.
        assert_eq!(
            found(&[mode(Montecarlo), none, splits(Some(Raytracing))]),
            []
        );
    }
}
