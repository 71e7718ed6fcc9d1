use crate::irradiance_cache::{IrradianceRecord, IrradianceRecords, LinearIrradiance};
use crate::math::to_world;
use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

/// A change of light over the radius as large as the light itself is believed only so far: what neighbours
/// say counts as much as this share of their weight against it.
const STIFFNESS: f64 = 0.005;

/// The light around each place as a linear function on its tangent plane: what suits the light gathered
/// there and at its neighbours best, which takes most of their noise away (weighted least squares).
pub(super) fn fit(places: &IrradianceRecords, light: &[Vec3]) -> Vec<LinearIrradiance> {
    let numbers = (0..places.len()).into_par_iter();
    numbers
        .map(|number| around(places, &places[number], light))
        .collect()
}

fn around(
    places: &IrradianceRecords,
    place: &IrradianceRecord,
    light: &[Vec3],
) -> LinearIrradiance {
    let tangents = [Vec3::X, Vec3::Y].map(|axis| to_world(place.normal, axis));
    let mut matrix = DMat3::ZERO;
    let mut right_sides = [DVec3::ZERO; 3];
    // The place itself is among them.
    places.visit(place.position, place.normal, 1.0, |number, weight| {
        let weight = f64::from(weight);
        let way = (places[number].position - place.position) / place.radius;
        let [x, y] = tangents.map(|tangent| f64::from(way.dot(tangent)));
        let row = DVec3::new(1.0, x, y);
        matrix += weight * DMat3::from_cols(row, x * row, y * row);
        for (side, channel) in right_sides.iter_mut().zip(light[number].to_array()) {
            *side += weight * f64::from(channel) * row;
        }
    });
    let weights = matrix.x_axis.x;
    matrix.y_axis.y += STIFFNESS * weights;
    matrix.z_axis.z += STIFFNESS * weights;
    let inverse = matrix.inverse();
    let solved = right_sides.map(|side| inverse * side);
    LinearIrradiance {
        light: Vec3::from_array(solved.map(|function| function.x as f32)),
        gradient: solved.map(|function| {
            let [x, y] = [function.y, function.z].map(|change| change as f32);
            (x * tangents[0] + y * tangents[1]) / place.radius
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::irradiance_cache::OccluderPlanes;
    use crate::math::Aabb;
    use crate::sampling::Random;

    /// Light that is linear on a plane is found, but for the stiffness.
    #[test]
    fn finds_linear_light() {
        let normal = Vec3::new(0.48, 0.6, 0.64);
        let bounds = Aabb {
            min: Vec3::splat(-3.0),
            max: Vec3::splat(3.0),
        };
        let mut places = IrradianceRecords::new(bounds, 0.5);
        let mut random = Random::new(7);
        let change = Vec3::new(0.3, -0.2, 0.1);
        let change = change - normal * change.dot(normal);
        let true_light = |position: Vec3| Vec3::new(2.0, 1.0, 1.0) * (1.0 + change.dot(position));
        let mut light = Vec::new();
        for _ in 0..400 {
            let point = random.vector(1.0);
            let position = point - normal * point.dot(normal);
            places.push(IrradianceRecord {
                position,
                normal,
                radius: 0.4,
                walls: OccluderPlanes::default(),
            });
            light.push(true_light(position));
        }
        let fitted = fit(&places, &light);
        for (number, linear) in fitted.iter().enumerate() {
            let place = &places[number];
            if place.position.length() < 0.6 {
                for way in [Vec3::ZERO, 0.3 * to_world(normal, Vec3::X)] {
                    let off = linear.at(way) - true_light(place.position + way);
                    assert!(off.length() < 0.02, "{off}");
                }
            }
        }
    }
}
