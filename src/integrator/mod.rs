//! The radiance that reaches the camera along a ray: recursive ray tracing (Whitted 1980), path tracing (Kajiya
//! 1986) and irradiance caching (Ward et al. 1988).
//!
//! An [`Integrator`] is built from plain [`IntegratorSettings`], a scene and, for cached light, an irradiance
//! cache. A ray that leaves the scene returns the background; a path at its last bounce returns the ambient light.
//! Knows nothing of pixels, frames or time.

mod cached;
mod camera_sample;
mod direct;
mod feature_sets;
mod final_gather;
mod hit_surfaces;
mod light_sampler;
mod path_state;
mod path_tracer;
mod radiance;
mod settings;
mod visible_points;
mod whitted;

pub use camera_sample::CameraSample;
pub use final_gather::{FinalGather, GatherPoint};
pub use light_sampler::LightSampler;
pub use radiance::{Integrator, IntegratorError};
pub use settings::IntegratorSettings;
pub use visible_points::{VisiblePoint, visible_points};
