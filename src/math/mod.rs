//! Rays, bounding boxes, bases and colour transfer functions.
//!
//! Knows nothing of shapes, files or threads.

mod aabb;
mod basis;
pub mod color;
mod ray;

pub use aabb::Aabb;
pub use basis::{rotation_xyz, to_world};
pub use ray::{NO_PRIMITIVE, Ray};
