//! The surface at a hit: position, normals, reflectance, and how rays leave it.

use super::mesh_material::MeshMaterial;
use super::resolved::{Scene, Triangle};
use super::surface_point::SurfacePoint;
use crate::geometry::Hit;
use crate::material::{Features, Reflectance};
use crate::math::{NO_PRIMITIVE, Ray};
use glam::{DVec3, Vec2, Vec3};

/// The surface at a hit, seen from the ray's side.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// The point, on the viewer's side.
    pub point: SurfacePoint,
    /// How it reflects light.
    pub reflectance: Reflectance,
}

/// A point on a shape, before the viewer's side is known.
struct ShapePoint {
    position: DVec3,
    geometric_normal: Vec3,
    shading_normal: Vec3,
    reflectance: Reflectance,
    /// Whether rays that leave on the normal's side, and on the other, cannot hit the shape again.
    convex: [bool; 2],
}

impl Scene {
    /// The surface that `ray` sees at `hit`.
    #[inline]
    pub fn surface<F: Features>(&self, ray: &Ray, hit: &Hit) -> Surface {
        let number = hit.primitive as usize;
        let point = match self.triangles.get(number) {
            Some(triangle) => self.triangle_point::<F>(ray.at(hit.t), triangle),
            None => self.sphere_point::<F>(ray.at(hit.t), number - self.triangles.len()),
        };
        let outside = point.geometric_normal.dot(ray.direction) < 0.0;
        let geometric_normal = if outside {
            point.geometric_normal
        } else {
            -point.geometric_normal
        };
        // Interpolated normals are flipped to the side that is seen.
        let agrees = point.shading_normal.dot(geometric_normal) >= 0.0;
        let shading_normal = if agrees {
            point.shading_normal
        } else {
            -point.shading_normal
        };
        let position = round_towards_origin(point.position, ray, hit.t);
        let magnitude = ray.origin.abs().max_element().max(self.magnitude);
        let is_convex = point.convex[usize::from(!outside)];
        Surface {
            point: SurfacePoint {
                position,
                geometric_normal,
                shading_normal,
                offset: offset(position, geometric_normal, magnitude),
                exclude: if is_convex {
                    hit.primitive
                } else {
                    NO_PRIMITIVE
                },
            },
            reflectance: point.reflectance,
        }
    }

    /// Whether `ray` hits the front of a shape: the side that [`Scene::normal`] points to.
    pub fn is_front(&self, ray: &Ray, hit: &Hit) -> bool {
        self.normal(ray, hit).dot(ray.direction) < 0.0
    }

    /// The unit normal of what `ray` hits, whichever side it hits: out of a sphere, and of a triangle to the side
    /// from which its vertices run counter-clockwise.
    pub fn normal(&self, ray: &Ray, hit: &Hit) -> Vec3 {
        let number = hit.primitive as usize;
        match self.triangles.get(number) {
            Some(triangle) => triangle.normal,
            None => {
                let sphere = &self.spheres[number - self.triangles.len()];
                (ray.at(hit.t) - sphere.center).normalize().as_vec3()
            }
        }
    }

    #[inline]
    fn triangle_point<F: Features>(&self, position: DVec3, triangle: &Triangle) -> ShapePoint {
        let vertices = triangle.vertices;
        let mesh = &self.meshes[triangle.mesh as usize];
        let material = &self.mesh_materials[triangle.mesh as usize];
        let is_textured = |id: usize| F::TEXTURES && self.materials[id].texture.is_some();
        let is_uniform = match material {
            MeshMaterial::Uniform(id) => !is_textured(*id),
            MeshMaterial::PerVertex(_) => false,
        };
        // Flat and of one colour: the weights are not needed.
        let weights = if is_uniform && mesh.normals.is_empty() {
            [1.0, 0.0, 0.0]
        } else {
            mesh.weights(vertices, position)
        };
        let uv = if F::TEXTURES {
            mesh.uv(vertices, weights)
        } else {
            Vec2::ZERO
        };
        let at = |material: usize| self.materials[material].at::<F>(uv, &self.textures);
        ShapePoint {
            position,
            geometric_normal: triangle.normal,
            shading_normal: mesh.shading_normal(vertices, weights, triangle.normal),
            reflectance: match material {
                MeshMaterial::Uniform(id) => at(*id),
                MeshMaterial::PerVertex(ids) => Reflectance::barycentric(ids.map(at), weights),
            },
            convex: [true, true],
        }
    }

    #[inline]
    fn sphere_point<F: Features>(&self, position: DVec3, index: usize) -> ShapePoint {
        let sphere = &self.spheres[index];
        let normal = (position - sphere.center).normalize();
        let material = &self.materials[self.sphere_materials[index]];
        let uv = match material.texture {
            Some(_) if F::TEXTURES => sphere.uv(normal),
            _ => Vec2::ZERO,
        };
        ShapePoint {
            position: sphere.center + normal * sphere.radius,
            geometric_normal: normal.as_vec3(),
            shading_normal: normal.as_vec3(),
            reflectance: material.at::<F>(uv, &self.textures),
            convex: [true, false],
        }
    }
}

/// A hit point, rounded to single precision towards the ray's origin and moved towards it by a few units of
/// rounding: the space in between is free, but just behind the point there may be a wall, as in a corner.
#[inline]
fn round_towards_origin(point: DVec3, ray: &Ray, t: f64) -> Vec3 {
    const ROUNDINGS: f64 = 4.0 * f32::EPSILON as f64;
    let direction = ray.direction.as_dvec3();
    let back = (ROUNDINGS * point.abs().max_element()).min(0.5 * t);
    let point = point - back * direction;
    let nearest = point.as_vec3();
    let beyond = (nearest.as_dvec3() - point) * direction;
    // Branches would be mispredicted half of the time: so there are none.
    Vec3::from_array([0, 1, 2].map(|axis| {
        let back = -ray.direction[axis].signum() as i32;
        stepped(nearest[axis], back * i32::from(beyond[axis] > 0.0))
    }))
}

/// The float `steps` representable numbers above `x`; both are finite.
#[inline]
fn stepped(x: f32, steps: i32) -> f32 {
    // The bits without the sign count the representable numbers between 0 and a number.
    let bits = x.to_bits() as i32;
    let sign = bits >> 31;
    let number = (((bits & i32::MAX) ^ sign) - sign) + steps;
    let sign = number >> 31;
    f32::from_bits((((number ^ sign) - sign) | (sign << 31)) as u32)
}

/// Twice the error bound of a point along the normal: the distance at which rays start.
///
/// The point was computed in double precision, so almost all of its error is its rounding to single
/// precision: an ulp in each coordinate. Doubling keeps a ray's origin on its side of the exact surface after the
/// origin, too, is rounded. `magnitude` bounds the coordinates that the point was computed from.
fn offset(position: Vec3, normal: Vec3, magnitude: f32) -> f32 {
    const DOUBLE_PRECISION_ERROR: f32 = 32.0 * f64::EPSILON as f32;
    (2.0 * f32::EPSILON * position.abs()).dot(normal.abs()) + DOUBLE_PRECISION_ERROR * magnitude
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_lead_to_the_next_numbers() {
        for x in [0.0, -0.0, 1.0, -1.0, 1.999_999_9, -1e-45, 3e38] {
            assert_eq!(stepped(x, 1), x.next_up());
            assert_eq!(stepped(x, -1), x.next_down());
            assert_eq!(stepped(x, 0), x);
        }
    }
}
