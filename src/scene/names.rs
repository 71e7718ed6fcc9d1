//! What the parts of a scene are called in its files, for messages.

/// What a mesh is called.
#[derive(Clone, Debug)]
pub struct MeshName {
    /// The number of its object.
    pub object: usize,
    /// Its part of the object, in parentheses; nothing of an object with one mesh.
    pub part: String,
}

/// What the parts of a scene are called in its files, by their indices in the scene.
#[derive(Clone, Debug, Default)]
pub struct SceneNames {
    /// The materials, as in `"wood"`.
    pub materials: Vec<String>,
    /// The object and the part of each mesh.
    pub meshes: Vec<MeshName>,
    /// The object of each sphere.
    pub spheres: Vec<String>,
    /// The point lights, as in `lights[0]`.
    pub lights: Vec<String>,
}

impl SceneNames {
    /// The name of a material; its number where it has none.
    pub fn material(&self, index: usize) -> String {
        let name = self.materials.get(index).cloned();
        name.unwrap_or_else(|| format!("number {index}"))
    }

    /// The name of a mesh; its number where it has none.
    pub fn mesh(&self, index: usize) -> String {
        match self.meshes.get(index) {
            Some(MeshName { object, part }) => format!("objects[{object}]{part}"),
            None => format!("mesh {index}"),
        }
    }

    /// The number of the object of a mesh; that of the mesh where it has no name.
    pub fn object(&self, mesh: usize) -> usize {
        self.meshes.get(mesh).map_or(mesh, |name| name.object)
    }

    /// The name of a point light; its number where it has none.
    pub fn light(&self, index: usize) -> String {
        let name = self.lights.get(index).cloned();
        name.unwrap_or_else(|| format!("light {index}"))
    }

    /// The name of a sphere; its number where it has none.
    pub fn sphere(&self, index: usize) -> String {
        let name = self.spheres.get(index).cloned();
        name.unwrap_or_else(|| format!("sphere {index}"))
    }
}
