//! The radiance that reaches the camera along a ray: recursive ray tracing (Whitted 1980), path tracing (Kajiya
//! 1986) and irradiance caching (Ward et al. 1988).
//!
//! An [`Integrator`] is built from plain [`IntegratorSettings`], a scene and, for cached light, an irradiance
//! cache. A ray that leaves the scene returns the radiance of the sky; a path at its last bounce returns the ambient light.
//!
//! Paths advance in wavefronts; shadow rays are traced sixteen at a time. Code is compiled for each set of material
//! features, and a scene's own set is chosen: what a scene does not use costs nothing (`cargo bench --bench features`).
//!
//! Textures are filtered over the footprints of camera samples, by ray differentials (Igehy 1999) that mirrors reflect.
//! Rays beyond a diffuse bounce see them bilinearly interpolated: what they miss averages out with the noise.
//!
//! Where a light is so close to a surface that its bright spot dominates the noise, a quarter of the indirect rays is
//! connected to points that were traced from the light, weighted by the balance heuristic (Veach and Guibas 1995):
//! unbiased, and less than half the error in `test3`.
//!
//! Emitters, lights with a radius and suns are sampled by shadow rays from every surface; paths that find an emitter are
//! weighted against these (multiple importance sampling, Veach and Guibas 1995). The sky is found by paths and, where a
//! camera sees a room, by shadow rays through its windows.
//!
//! Tried, and no better: shadow rays to the sky beyond the first bounce, which took twice the time of what they saved;
//! directions of all bounces by what parts of the scene learned of all light, which lowered the error of interiors 1.3 to
//! 2.4 times, and cost as much to look up and to learn.
//! Russian roulette after the first bounce, with probabilities of 1/2 to 1/8, loses as much as it
//! saves.
//!
//! Knows nothing of pixels, frames or time.

mod cached;
mod cached_light;
mod camera_sample;
mod cell_light;
mod cell_place;
mod direct;
mod feature_sets;
mod final_gather;
mod hit_surfaces;
mod light_sampler;
mod lighting;
mod path_state;
mod path_tracer;
mod radiance;
mod sampled_lights;
mod secondary_light;
mod settings;
mod sky_guide;
mod sky_sampler;
mod visible_points;
mod whitted;

pub use camera_sample::CameraSample;
pub use cell_place::{record_in_cell, sees_eye, sees_record};
pub use final_gather::{FinalGather, GatherPaths, GatherPoint};
pub use light_sampler::LightSampler;
pub use lighting::Lighting;
pub use radiance::{Integrator, IntegratorError};
pub use settings::IntegratorSettings;
pub use visible_points::{VisiblePoint, visible_points};
