//! The reflectance model: a base layer, Lambert plus a Phong highlight (Phong 1975, "Illumination for Computer
//! Generated Pictures"), blended with a perfect mirror.
//!
//! Conventions, for all functions here: directions are of unit length and point away from the
//! surface; the shading normal is on the viewer's side; colours are linear RGB. Both sides of a surface reflect alike.
//! The base layer's weight is 1 - `reflective`, the mirror's is `reflective`. Values of [`Reflectance::reflect_light`]
//! include the cosine, and the 1/pi of a Lambert surface is part of the light: see
//! [`PointLight::color_at`](crate::light::PointLight::color_at).

mod features;
mod reflectance;

pub use features::{FeatureSet, Features, Only};
pub use reflectance::{Material, Reflectance, mirror};
