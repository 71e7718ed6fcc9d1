//! Light that surfaces do not emit: point lights, and the sky around the scene.

mod cell_means;
mod point_light;
mod sky;
mod sky_gradient;
mod sky_map;
mod sphere_cells;

pub use point_light::{Falloff, PointLight};
pub use sky::Sky;
pub use sky_gradient::SkyGradient;
pub use sky_map::SkyMap;

#[cfg(test)]
mod tests;
