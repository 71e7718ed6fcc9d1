//! Meshes that cases are built from.

use crate::geometry;
use crate::scene::{MeshMaterial, SourceMesh};
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Vertices and the triangles between them.
pub(super) struct Polyhedron {
    pub(super) vertices: Vec<DVec3>,
    pub(super) faces: Vec<[u32; 3]>,
}

impl Polyhedron {
    /// A closed mesh of 20 * 4^levels triangles with vertices on the unit sphere, its faces pointing outward.
    pub(super) fn icosphere(levels: usize) -> Polyhedron {
        let phi = (1.0 + 5.0_f64.sqrt()) / 2.0;
        let mut vertices = Vec::new();
        for (a, b) in [(1.0, phi), (-1.0, phi), (1.0, -phi), (-1.0, -phi)] {
            vertices.extend([
                DVec3::new(0.0, a, b),
                DVec3::new(a, b, 0.0),
                DVec3::new(b, 0.0, a),
            ]);
        }
        let mut faces: Vec<[u32; 3]> = Vec::new();
        for i in 0..12 {
            for j in i + 1..12 {
                for k in j + 1..12 {
                    let [a, b, c] = [i, j, k].map(|vertex: usize| vertices[vertex]);
                    let near = |a: DVec3, b: DVec3| a.distance(b) < 2.1;
                    if near(a, b) && near(b, c) && near(a, c) {
                        let is_outward = (b - a).cross(c - a).dot(a) > 0.0;
                        let [j, k] = if is_outward { [j, k] } else { [k, j] };
                        faces.push([i, j, k].map(|vertex| vertex as u32));
                    }
                }
            }
        }
        for vertex in &mut vertices {
            *vertex = vertex.normalize();
        }
        for _ in 0..levels {
            let mut middles = BTreeMap::new();
            let mut finer = Vec::new();
            for [a, b, c] in faces {
                let mut middle = |a: u32, b: u32| {
                    *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                        let sum = vertices[a as usize] + vertices[b as usize];
                        vertices.push(sum.normalize());
                        vertices.len() as u32 - 1
                    })
                };
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
            faces = finer;
        }
        Polyhedron { vertices, faces }
    }

    /// A closed unit sphere of `rings` rings with poles where `segments` triangles meet.
    pub(super) fn globe(segments: u32, rings: u32) -> Polyhedron {
        let mut vertices = vec![DVec3::Y, DVec3::NEG_Y];
        let mut faces = Vec::new();
        let at = |ring: u32, segment: u32| 2 + (ring - 1) * segments + segment % segments;
        for ring in 1..rings {
            let (radius, y) = (PI * f64::from(ring) / f64::from(rings)).sin_cos();
            for segment in 0..segments {
                let (x, z) = (TAU * f64::from(segment) / f64::from(segments)).sin_cos();
                vertices.push(DVec3::new(radius * x, y, radius * z));
                let next = segment + 1;
                if ring == 1 {
                    faces.push([0, at(1, segment), at(1, next)]);
                } else {
                    let [a, b] = [at(ring - 1, segment), at(ring - 1, next)];
                    let [c, d] = [at(ring, segment), at(ring, next)];
                    faces.extend([[a, c, d], [a, d, b]]);
                }
                if ring == rings - 1 {
                    faces.push([at(ring, segment), 1, at(ring, next)]);
                }
            }
        }
        Polyhedron { vertices, faces }
    }

    /// A box from `min` to `max`, its faces pointing outward.
    pub(super) fn cuboid(min: DVec3, max: DVec3) -> Polyhedron {
        let (vertices, faces) = geometry::cuboid(min, max);
        Polyhedron { vertices, faces }
    }

    /// A parallelogram, counter-clockwise from `corner` by `right` to `up`.
    pub(super) fn quad(corner: DVec3, right: DVec3, up: DVec3) -> Polyhedron {
        Polyhedron {
            vertices: vec![corner, corner + right, corner + right + up, corner + up],
            faces: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    /// A copy whose vertices are mapped by `to`.
    pub(super) fn moved(&self, to: impl Fn(DVec3) -> DVec3) -> Polyhedron {
        Polyhedron {
            vertices: self.vertices.iter().map(|&vertex| to(vertex)).collect(),
            faces: self.faces.clone(),
        }
    }

    /// The vertices of each triangle, in single precision.
    pub(super) fn triangles(&self) -> Vec<[Vec3; 3]> {
        let vertex = |i: u32| self.vertices[i as usize].as_vec3();
        self.faces.iter().map(|face| face.map(vertex)).collect()
    }

    /// A flat-shaded mesh of one material.
    pub(super) fn mesh(&self, material: usize) -> SourceMesh {
        SourceMesh {
            positions: self.vertices.clone(),
            normals: Vec::new(),
            uvs: Vec::new(),
            triangles: self.faces.clone(),
            material: MeshMaterial::Uniform(material),
        }
    }
}
