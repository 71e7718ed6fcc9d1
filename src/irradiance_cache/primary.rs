use super::kernel::Lookup;
use super::lookup::LANES;
use super::{IrradianceRecords, Leaf, Octree};
use crate::simd::Kernel;
use glam::Vec3;

/// The light at a place, and how it changes along the surface.
#[derive(Clone, Copy, Debug)]
pub struct LinearIrradiance {
    /// In the middle.
    pub light: Vec3,
    /// The change of each channel along x, y and z.
    pub gradient: [Vec3; 3],
}

impl LinearIrradiance {
    /// Away from the middle.
    #[inline]
    pub fn at(&self, way: Vec3) -> Vec3 {
        self.light + Vec3::from_array(self.gradient.map(|gradient| gradient.dot(way)))
    }
}

/// The light at what the camera sees, where a certain number of bounces is left.
#[derive(Debug)]
pub struct PrimaryIrradiance {
    /// Where it is known.
    pub places: IrradianceRecords,
    /// IrradianceRecord by place.
    pub light: Vec<LinearIrradiance>,
}

impl PrimaryIrradiance {
    /// The light at some points, positions and unit normals given; none where it is not known. Each gets
    /// what it would get alone.
    ///
    /// The mean of what the places say that a point lies in (Shepard 1968; of linear functions as in Renka
    /// 1988, "Multivariate Interpolation of Large Sets of Scattered Data").
    pub fn lights(&self, points: &[(Vec3, Vec3)], kernel: Kernel) -> Vec<Option<Vec3>> {
        let mut lights = vec![None; points.len()];
        let tree = self.places.tree();
        for group in groups(tree, points) {
            let of_group = group.numbers.map(|number| points[number as usize]);
            let around = tree.boxes(group.leaf.node);
            let known = kernel.run(Lookup {
                points: &of_group,
                numbers: around,
                places: &self.places,
                light: &self.light,
            });
            for (&number, light) in group.numbers[..group.count].iter().zip(known) {
                lights[number as usize] = light;
            }
        }
        for (light, (position, normal)) in lights.iter_mut().zip(points) {
            if light.is_none() {
                *light = self.light_beside(*position, *normal);
            }
        }
        lights
    }

    /// As the places say that a point lies just beside.
    fn light_beside(&self, position: Vec3, normal: Vec3) -> Option<Vec3> {
        const REACH: f32 = 2.0;
        let light = |number: usize| self.light[number].light;
        self.places.mean(position, normal, REACH, light)
    }

    /// Bytes.
    pub fn memory(&self) -> usize {
        self.places.memory() + size_of_val(&*self.light)
    }
}

/// Points of one leaf that are looked up together.
struct Group {
    leaf: Leaf,
    /// How many they are.
    count: usize,
    /// Their numbers; lanes that are left over repeat the first.
    numbers: [u32; LANES],
}

/// The points in groups.
fn groups(tree: &Octree, points: &[(Vec3, Vec3)]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (number, (position, _)) in (0..).zip(points) {
        let takes = |group: &&mut Group| group.count < LANES && group.leaf.holds(*position);
        if let Some(group) = groups.iter_mut().rev().find(takes) {
            group.numbers[group.count] = number;
            group.count += 1;
        } else {
            groups.push(Group {
                leaf: tree.leaf(*position),
                count: 1,
                numbers: [number; LANES],
            });
        }
    }
    groups
}
