use super::look_up::{LANES, LookUp};
use super::{Leaf, Places};
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
        for same in by_leaf(&self.places, points).chunk_by(|a, b| a.0 == b.0) {
            for numbers in same.chunks(LANES) {
                let of_number = |&(_, number): &(u32, u32)| points[number as usize];
                let mut look_up = LookUp::new(numbers.iter().map(of_number), self.places.turn());
                for &place in self.places.tree().boxes(same[0].0) {
                    let place = place as usize;
                    look_up.add(&self.places[place], &self.light[place]);
                }
                for (lane, &(_, number)) in numbers.iter().enumerate() {
                    lights[number as usize] = look_up.light(lane);
                }
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
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        self.places
            .visit(position, normal, REACH, |number, weight| {
                sum += weight * self.light[number].light;
                weights += weight;
            });
        (weights > 0.0).then(|| sum / weights)
    }

    /// Bytes.
    pub fn memory(&self) -> usize {
        self.places.memory() + size_of_val(&*self.light)
    }
}

/// The leaf that each point lies in, and the point's number: sorted.
fn by_leaf(places: &Places, points: &[(Vec3, Vec3)]) -> Vec<(u32, u32)> {
    let mut last: Option<Leaf> = None;
    let leaf = |(number, (position, _)): (u32, &(Vec3, Vec3))| {
        let same = last.filter(|leaf| leaf.holds(*position));
        let leaf = same.unwrap_or_else(|| places.tree().leaf(*position));
        last = Some(leaf);
        (leaf.node, number)
    };
    let mut leaves: Vec<(u32, u32)> = (0..).zip(points).map(leaf).collect();
    leaves.sort_unstable();
    leaves
}
