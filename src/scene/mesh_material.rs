//! The materials of a mesh.

/// The materials of a mesh, as indices of the scene's materials.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MeshMaterial {
    /// One for the whole mesh.
    Uniform(usize),
    /// One for each vertex of the mesh's only triangle, interpolated barycentrically.
    PerVertex([usize; 3]),
}
