//! Lights that are not surfaces of the scene: points, suns, the sky; and which of many emitters to sample.
//!
//! Surfaces that emit are in `scene`, which knows shapes and materials.

mod cell_means;
mod light_bounds;
mod light_tree;
mod point_light;
mod sky;
mod sky_gradient;
mod sky_map;
mod sphere_cells;
mod sun;

pub use light_bounds::LightBounds;
pub use light_tree::LightTree;
pub use point_light::{Cone, Falloff, PointLight};
pub use sky::Sky;
pub use sky_gradient::SkyGradient;
pub use sky_map::SkyMap;
pub use sun::Sun;

#[cfg(test)]
mod tests;
