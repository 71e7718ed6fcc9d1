use super::kernel::add_all;
use super::look_up::{LANES, LookUp};
use super::{BoxTree, Leaf, Places};
use glam::Vec3;

/// The light at a place, and how it changes along the surface.
#[derive(Clone, Copy, Debug)]
pub struct Linear {
    /// In the middle.
    pub light: Vec3,
    /// The change of each channel along x, y and z.
    pub gradient: [Vec3; 3],
}

impl Linear {
    /// Away from the middle.
    #[inline]
    pub fn at(&self, way: Vec3) -> Vec3 {
        self.light + Vec3::from_array(self.gradient.map(|gradient| gradient.dot(way)))
    }
}

/// The light at what the camera sees, where a certain number of bounces is left.
#[derive(Debug)]
pub struct VisibleLight {
    /// Where it is known.
    pub places: Places,
    /// Place by place.
    pub light: Vec<Linear>,
}

impl VisibleLight {
    /// The light at some points, positions and unit normals given; none where it is not known. Each gets
    /// what it would get alone.
    ///
    /// The mean of what the places say that a point lies in (Shepard 1968; of linear functions as in Renka
    /// 1988, "Multivariate Interpolation of Large Sets of Scattered Data").
    pub fn lights(&self, points: &[(Vec3, Vec3)]) -> Vec<Option<Vec3>> {
        let mut lights = vec![None; points.len()];
        let tree = self.places.tree();
        let mut rest = leaves(tree, points);
        while let Some(&(node, first)) = rest.first() {
            // Those of the same leaf, as many as fit; lanes that are left over repeat the first.
            let mut group = [first; LANES];
            let mut count = 0;
            rest.retain(|&(leaf, number)| {
                let joins = leaf == node && count < LANES;
                if joins {
                    group[count] = number;
                    count += 1;
                }
                !joins
            });
            let mut look_up = LookUp::new(group.map(|n| points[n as usize]), self.places.turn());
            add_all(&mut look_up, tree.boxes(node), &self.places, &self.light);
            for (lane, &number) in group[..count].iter().enumerate() {
                lights[number as usize] = look_up.light(lane);
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

/// The number of the leaf that each point lies in, and the point's.
fn leaves(tree: &BoxTree, points: &[(Vec3, Vec3)]) -> Vec<(u32, u32)> {
    let mut last: Option<Leaf> = None;
    let leaf = |(number, (position, _)): (u32, &(Vec3, Vec3))| {
        let same = last.filter(|leaf| leaf.holds(*position));
        let leaf = same.unwrap_or_else(|| tree.leaf(*position));
        last = Some(leaf);
        (leaf.node, number)
    };
    (0..).zip(points).map(leaf).collect()
}
