//! The resolved scene: immutable, checked, with its acceleration structure.
//!
//! What the renderer may assume of a [`Scene`]:
//!
//! - Every number is finite.
//! - Coordinates are in *scene space* (pbrt: render space): world space less [`Scene::origin`], in metres, right-handed with
//!   +Y up, in single precision. The origin is the median of the geometry, so that precision is finest where most of the
//!   scene is. Cameras and input are in world space, in double precision.
//! - Every index of a vertex, a material or a texture exists.
//! - No triangle has zero area; its geometric normal is of unit length, on the side that sees its vertices
//!   counter-clockwise.
//! - A mesh has one normal per vertex or none; each is of unit length, or zero for the geometric normal. It has one
//!   texture coordinate per vertex or none.
//! - A mesh with a material per vertex has exactly one triangle.
//! - Sphere radii are above 0.
//! - Colours are linear RGB. Diffuse and mirror weights are in 0..1; specular weights, exponents, light intensities,
//!   emitted radiance, ambient light and the radiance of the sky are 0 or more.
//! - Textures have at least one texel and are filtered as linear RGB in 0..1.
//! - [`Scene::features`] holds every feature that a used material has; code that is compiled for fewer features than
//!   these gives wrong colours.
//! - Primitives are numbered: triangles first, then spheres.
//!
//! Knows nothing of files, cameras or integrators.

mod builder;
mod emission;
mod emitter;
mod emitters;
mod find_emitters;
mod light_groups;
mod light_sample;
mod mesh_material;
mod names;
mod primitive;
mod ray_offset;
mod resolved;
mod shadow_packet;
mod surface_differential;
mod surface_interaction;
mod surface_point;

pub use builder::{SceneBuilder, SourceMesh};
pub use light_groups::{LightAmount, LightGroup};
pub use light_sample::LightSample;
pub use mesh_material::MeshMaterial;
pub use names::{MeshName, SceneNames};
pub use resolved::Scene;
pub use shadow_packet::ShadowPacket;
pub use surface_interaction::SurfaceInteraction;
pub use surface_point::{SurfacePoint, SurfacePointPacket};
