//! Lights that are not surfaces of the scene, points and suns; and which of many emitters to sample.
//!
//! Surfaces that emit are in `scene`, which knows shapes and materials.

mod light_bounds;
mod light_tree;
mod point_light;
mod sun;

pub use light_bounds::LightBounds;
pub use light_tree::LightTree;
pub use point_light::{Cone, Falloff, PointLight};
pub use sun::Sun;
