//! Shapes: triangles of meshes and spheres, with their intersections, distances, normals and texture coordinates.
//! Those of a scene are in scene space (see `scene`), in metres.
//!
//! Knows nothing of materials, files or acceleration structures.

mod cuboid;
mod hit;
mod mesh;
mod polygon;
mod sphere;
mod transform;
mod triangle;

pub use cuboid::cuboid;
pub use hit::Hit;
pub use mesh::{Mesh, VertexIndices};
pub use polygon::{fan, triangulate};
pub use sphere::Sphere;
pub use transform::Transform;
pub use triangle::distance_to_triangle;
