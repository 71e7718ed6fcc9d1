//! The reflectance model: a base layer, Lambert plus a Phong highlight (Phong 1975, "Illumination for Computer
//! Generated Pictures"), blended with a perfect mirror.
//!
//! Conventions, for all functions here: directions are of unit length and point away from the
//! surface; the shading normal is on the viewer's side; colours are linear RGB. Both sides of a surface reflect alike.
//! The base layer's weight is 1 - `reflective`, the mirror's is `reflective`. Values of [`Bsdf::eval_cos`]
//! include the cosine, and the 1/pi of a Lambert surface is part of the light: see
//! [`PointLight::irradiance_over_pi`](crate::light::PointLight::irradiance_over_pi).

mod bsdf;
mod features;
mod parameters;

pub use bsdf::{Bsdf, reflect};
pub use features::{FeatureMask, FeatureSet, Features};
pub use parameters::{Emission, Material};
