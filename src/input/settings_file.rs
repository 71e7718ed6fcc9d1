//! Render settings as scene files, path files and the command line give them.

use super::extra_light::ExtraLight;
use super::samples::Samples;
use super::technique::{GlobalIllumination, Mode};
use crate::integrator::IntegratorSettings;
use crate::render::{PixelSampling, RenderSettings};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The render settings that one source gives: a scene file, a path file or the command line.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// The rendering technique.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mode: Option<Mode>,
    /// Columns and rows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<(u32, u32)>,
    /// The camera samples of each pixel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<Samples>,
    /// The largest number of bounces of a path.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounces: Option<u32>,
    /// Splitting factors: the number of rays traced from the first diffuse bounce of a path, the second, and so on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub splits: Option<Vec<u32>>,
    /// Shadow rays for emitters, from every surface that a camera sample sees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shadow_rays: Option<u32>,
    /// A light that is not in the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<ExtraLight>,
    /// Seed of the sample points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u32>,
    /// Whether all frames use the same sample points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lock_seed: Option<bool>,
    /// Exposure, in stops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<f32>,
    /// Samples are added until a frame's estimated relMSE, that of an irradiance cache included, is below this.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target_error: Option<f64>,
    /// How indirect diffuse light is computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gi: Option<GlobalIllumination>,
}

/// 16,384 x 16,384: about 20 GB of memory in the montecarlo modes.
const MAX_PIXELS: u32 = 1 << 28;

/// The most paths that splits may make of a camera sample.
const MAX_PATHS: u64 = 1 << 24;

/// The default columns and rows.
const SIZE: (u32, u32) = (1280, 720);

/// The largest number of columns of a preview.
const PREVIEW_COLUMNS: u32 = 320;

/// What a white surface looks like in a headlight that it faces, relative to display white.
const HEADLIGHT: f32 = 0.9;

/// The smallest target error.
pub const MIN_TARGET_ERROR: f64 = 1e-6;

/// The relMSE that camera samples may leave where nothing says how many there are, unless light is path traced: edges
/// are smooth. Not in raytracing, which has one ray a pixel by definition.
pub const DEFAULT_ERROR: f64 = 2e-4;

/// The same where light is path traced: noise is hardly visible.
pub const DEFAULT_PATH_TRACED_ERROR: f64 = RenderSettings::NOISE;

/// A setting that is out of range or does not go with another.
#[derive(Debug, Error, PartialEq)]
#[error("{key}: {message}")]
pub struct SettingsError {
    /// The setting's name.
    pub key: &'static str,
    /// What is wrong and what to write instead.
    pub message: String,
}

impl SettingsError {
    /// The message with the setting's command line option in place of its name.
    pub fn of_flag(&self) -> String {
        format!("--{}: {}", self.key.replace('_', "-"), self.message)
    }
}

impl Settings {
    /// These settings, completed by those of `weaker`.
    pub fn or(self, weaker: Settings) -> Settings {
        Settings {
            mode: self.mode.or(weaker.mode),
            size: self.size.or(weaker.size),
            samples: self.samples.or(weaker.samples),
            bounces: self.bounces.or(weaker.bounces),
            splits: self.splits.or(weaker.splits),
            shadow_rays: self.shadow_rays.or(weaker.shadow_rays),
            light: self.light.or(weaker.light),
            seed: self.seed.or(weaker.seed),
            lock_seed: self.lock_seed.or(weaker.lock_seed),
            exposure: self.exposure.or(weaker.exposure),
            target_error: self.target_error.or(weaker.target_error),
            gi: self.gi.or(weaker.gi),
        }
    }

    /// Columns and rows of frames of the same aspect ratio, with at most `columns` columns.
    pub fn size_within(&self, columns: u32) -> (u32, u32) {
        let (width, height) = self.size.unwrap_or(SIZE);
        let columns = width.min(columns);
        let rows = f64::from(height) * f64::from(columns) / f64::from(width);
        (columns, (rows.round() as u32).max(1))
    }

    /// The settings of a preview of the camera's motion: raytracing, at most 320 columns, one sample at each pixel's
    /// centre.
    pub fn preview(self) -> Settings {
        Settings {
            mode: Some(Mode::Raytracing),
            size: Some(self.size_within(PREVIEW_COLUMNS)),
            samples: None,
            splits: None,
            target_error: None,
            gi: None,
            ..self
        }
    }

    /// Checks the range of every setting.
    pub fn check(&self) -> Result<(), SettingsError> {
        let within = |key, value: u32, least: u32, most: u32| {
            if (least..=most).contains(&value) {
                return Ok(());
            }
            let message = format!("{value} is not between {least} and {most}");
            Err(SettingsError { key, message })
        };
        if let Some((width, height)) = self.size {
            within("size", width, 1, 32_768)?;
            within("size", height, 1, 32_768)?;
            if width * height > MAX_PIXELS {
                let key = "size";
                let message = format!("{width}x{height} are more than {MAX_PIXELS} pixels");
                return Err(SettingsError { key, message });
            }
        }
        if let Some(Samples::Spread(samples)) = self.samples {
            within("samples", samples, 1, 1 << 20)?;
        }
        if let Some(bounces) = self.bounces {
            within("bounces", bounces, 0, 64)?;
        }
        for &split in self.splits.iter().flatten() {
            within("splits", split, 1, 1 << 20)?;
        }
        if let Some(shadow_rays) = self.shadow_rays {
            within("shadow_rays", shadow_rays, 1, 1 << 12)?;
        }
        let paths = self.splits.iter().flatten();
        let paths = paths.fold(1_u64, |paths, &split| paths.saturating_mul(split.into()));
        if paths > MAX_PATHS {
            return Err(SettingsError {
                key: "splits",
                message: format!(
                    "multiply to {paths} paths for each camera sample; up to {MAX_PATHS} are possible"
                ),
            });
        }
        if let Some(exposure) = self.exposure
            && (exposure.is_nan() || exposure.abs() > 64.0)
        {
            let message = format!("{exposure} stops are not between -64 and 64");
            return Err(SettingsError {
                key: "exposure",
                message,
            });
        }
        if let Some(target) = self.target_error
            && !(MIN_TARGET_ERROR..=1.0).contains(&target)
        {
            let message = format!("{target} is not between {MIN_TARGET_ERROR} and 1");
            return Err(SettingsError {
                key: "target_error",
                message,
            });
        }
        Ok(())
    }

    /// Checks that settings go together, once all sources are combined.
    pub fn check_together(&self) -> Result<(), SettingsError> {
        let mode = self.mode.unwrap_or_default();
        let has_indirect = matches!(mode, Mode::Montecarlo | Mode::MontecarloSupersampling);
        if self.target_error.is_some()
            && let Some(samples @ (Samples::Center | Samples::Corners)) = self.samples
        {
            return Err(SettingsError {
                key: "target_error",
                message: format!(
                    "{samples} cannot be refined; leave out samples, or give a number"
                ),
            });
        }
        if self.gi == Some(GlobalIllumination::Cached) {
            let wrong = |message: String| SettingsError { key: "gi", message };
            if !has_indirect {
                return Err(wrong(format!(
                    "{mode} has no indirect light to cache; choose a montecarlo mode"
                )));
            }
        }
        Ok(())
    }

    /// How indirect diffuse light is computed in a sequence of `frames` frames. The default is `Cached` in montecarlo
    /// sequences of more than one frame without `splits`, and else `PathTraced`.
    pub fn global_illumination(&self, frames: u32) -> GlobalIllumination {
        let has_indirect = !matches!(
            self.mode.unwrap_or_default(),
            Mode::Raytracing | Mode::Supersampling
        );
        self.gi
            .unwrap_or(if has_indirect && frames > 1 && self.splits.is_none() {
                GlobalIllumination::Cached
            } else {
                GlobalIllumination::PathTraced
            })
    }

    /// The settings of frames in a sequence of `frames`, with defaults for what nothing says: raytracing, 1280 x 720,
    /// 4 bounces, 32 paths from the first diffuse bounce, 4 shadow rays, seed 0; as many samples as [`DEFAULT_ERROR`] or
    /// [`DEFAULT_PATH_TRACED_ERROR`] takes, in raytracing one in the middle of each pixel; for indirect
    /// light see [`Settings::global_illumination`].
    pub fn resolve(&self, frames: u32) -> RenderSettings {
        let mode = self.mode.unwrap_or_default();
        let (width, height) = self.size.unwrap_or(SIZE);
        let bounces = self.bounces.unwrap_or(4);
        let integrator = match (mode, self.global_illumination(frames)) {
            (Mode::Raytracing | Mode::Supersampling, _) => IntegratorSettings::Whitted { bounces },
            (_, GlobalIllumination::PathTraced) => IntegratorSettings::PathTraced {
                bounces,
                splits: self.splits.clone().unwrap_or_else(|| vec![32, 1, 1, 1]),
            },
            (_, GlobalIllumination::Cached) => IntegratorSettings::Cached { bounces },
        };
        let sampling = match (self.samples, self.target_error, mode) {
            (Some(samples), ..) => samples.into(),
            (None, Some(_), _) => PixelSampling::Spread(1),
            (None, None, Mode::Raytracing) => PixelSampling::Center,
            (None, None, _) => PixelSampling::Adaptive(match integrator {
                IntegratorSettings::PathTraced { .. } => DEFAULT_PATH_TRACED_ERROR,
                IntegratorSettings::Whitted { .. } | IntegratorSettings::Cached { .. } => {
                    DEFAULT_ERROR
                }
            }),
        };
        let display_white = libm::exp2f(-self.exposure.unwrap_or(0.0));
        RenderSettings {
            shadow_rays: self.shadow_rays.unwrap_or(RenderSettings::SHADOW_RAYS),
            headlight: match self.light {
                Some(ExtraLight::Camera) => HEADLIGHT * display_white,
                None => 0.0,
            },
            sampling,
            seed: self.seed.unwrap_or(0),
            lock_seed: self.lock_seed.unwrap_or(false),
            display_white,
            target_error: self.target_error,
            ..RenderSettings::new(integrator, width, height)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stronger_source_wins_setting_by_setting() {
        let flags = Settings {
            samples: Some(Samples::Spread(4)),
            ..Settings::default()
        };
        let file = Settings {
            samples: Some(Samples::Spread(9)),
            mode: Some(Mode::MontecarloSupersampling),
            bounces: Some(2),
            ..Settings::default()
        };
        let resolved = flags.or(file).resolve(1);
        assert_eq!(resolved.sampling, PixelSampling::Spread(4));
        let splits = vec![32, 1, 1, 1];
        assert_eq!(
            resolved.integrator,
            IntegratorSettings::PathTraced { bounces: 2, splits }
        );
        assert_eq!((resolved.width, resolved.height), (1280, 720));
    }

    #[test]
    fn samples_are_as_many_as_it_takes_but_in_raytracing() {
        let sampling = |mode: Mode, samples, target_error, frames| {
            let settings = Settings {
                mode: Some(mode),
                samples,
                target_error,
                ..Settings::default()
            };
            assert_eq!(settings.check_together(), Ok(()));
            settings.resolve(frames).sampling
        };
        use PixelSampling::{Adaptive, Center, Corners, Spread};
        assert_eq!(sampling(Mode::Raytracing, None, None, 9), Center);
        assert_eq!(sampling(Mode::Raytracing, None, Some(0.1), 9), Spread(1));
        assert_eq!(
            sampling(Mode::Supersampling, None, None, 9),
            Adaptive(DEFAULT_ERROR)
        );
        assert_eq!(
            sampling(Mode::Montecarlo, None, None, 9),
            Adaptive(DEFAULT_ERROR)
        );
        let of_still = Adaptive(DEFAULT_PATH_TRACED_ERROR);
        assert_eq!(sampling(Mode::Montecarlo, None, None, 1), of_still);
        let corners = Some(Samples::Corners);
        assert_eq!(sampling(Mode::Montecarlo, corners, None, 9), Corners);
        for samples in [Samples::Corners, Samples::Center] {
            let settings = Settings {
                samples: Some(samples),
                target_error: Some(0.1),
                ..Settings::default()
            };
            assert_eq!(
                settings.check_together().map_err(|e| e.key),
                Err("target_error")
            );
        }
    }

    #[test]
    fn montecarlo_sequences_are_cached_by_default() {
        use GlobalIllumination::{Cached, PathTraced};
        let known = |mode: Mode, splits: Option<Vec<u32>>, gi, frames| {
            let settings = Settings {
                mode: Some(mode),
                splits,
                gi,
                ..Settings::default()
            };
            settings.global_illumination(frames)
        };
        assert_eq!(known(Mode::Montecarlo, None, None, 2), Cached);
        assert_eq!(known(Mode::MontecarloSupersampling, None, None, 2), Cached);
        assert_eq!(known(Mode::Montecarlo, None, None, 1), PathTraced);
        assert_eq!(known(Mode::Montecarlo, Some(vec![8]), None, 2), PathTraced);
        assert_eq!(known(Mode::Supersampling, None, None, 2), PathTraced);
        assert_eq!(
            known(Mode::Montecarlo, None, Some(PathTraced), 2),
            PathTraced
        );
        assert_eq!(known(Mode::Montecarlo, None, Some(Cached), 1), Cached);
    }

    #[test]
    fn resolved_settings_have_the_integrator_of_the_mode_and_the_sequence() {
        let integrator = |mode: Mode, frames: u32| {
            let settings = Settings {
                mode: Some(mode),
                bounces: Some(2),
                ..Settings::default()
            };
            settings.resolve(frames).integrator
        };
        let whitted = IntegratorSettings::Whitted { bounces: 2 };
        assert_eq!(integrator(Mode::Supersampling, 9), whitted);
        let cached = IntegratorSettings::Cached { bounces: 2 };
        assert_eq!(integrator(Mode::Montecarlo, 9), cached);
        let splits = vec![32, 1, 1, 1];
        let path_traced = IntegratorSettings::PathTraced { bounces: 2, splits };
        assert_eq!(integrator(Mode::Montecarlo, 1), path_traced);
    }

    #[test]
    fn previews_are_small_and_fast_whatever_is_set() {
        let settings = Settings {
            mode: Some(Mode::MontecarloSupersampling),
            size: Some((1000, 4001)),
            samples: Some(Samples::Spread(64)),
            bounces: Some(7),
            splits: Some(vec![8]),
            target_error: Some(0.01),
            gi: Some(GlobalIllumination::Cached),
            exposure: Some(1.0),
            ..Settings::default()
        };
        let preview = settings.preview();
        assert_eq!(preview.check_together(), Ok(()));
        assert_eq!(
            preview.global_illumination(99),
            GlobalIllumination::PathTraced
        );
        let expected = RenderSettings {
            display_white: 0.5,
            ..RenderSettings::new(IntegratorSettings::Whitted { bounces: 7 }, 320, 1280)
        };
        assert_eq!(preview.resolve(99), expected);
        assert_eq!(expected.sampling, PixelSampling::Center);
        for (size, small) in [
            (None, (320, 180)),
            (Some((96, 54)), (96, 54)),
            (Some((4000, 1)), (320, 1)),
        ] {
            let settings = Settings {
                size,
                ..Settings::default()
            };
            assert_eq!(settings.preview().size, Some(small));
        }
    }
}
