//! Rays and their differentials, bounding boxes, bases and colour transfer functions.
//!
//! Knows nothing of shapes, files or threads.

mod aabb;
mod basis;
pub mod color;
mod ray;
mod ray_differential;

pub use aabb::Aabb;
pub use basis::{rotation_xyz, to_world};
pub use ray::{NO_PRIMITIVE, Ray};
pub use ray_differential::RayDifferential;
