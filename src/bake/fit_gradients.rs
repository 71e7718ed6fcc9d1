//! Fits a linear function to the values around each record. This gives the irradiance gradients of Ward and Heckbert
//! 1992 and averages the noise of neighbours (weighted least squares, as the nodal functions of Renka 1988,
//! "Multivariate Interpolation of Large Sets of Scattered Data").

use crate::irradiance_cache::{IrradianceRecord, IrradianceRecords, LinearIrradiance};
use crate::math::to_world;
use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

/// Ridge regularisation of the gradient, in units of the radius, relative to the sum of the weights.
const REGULARIZATION: f64 = 0.005;

/// For each record the linear function on its tangent plane that fits the values of the records around it best.
pub(super) fn fit_gradients(
    records: &IrradianceRecords,
    mean_radiance: &[Vec3],
) -> Vec<LinearIrradiance> {
    let numbers = (0..records.len()).into_par_iter();
    numbers
        .map(|index| fit_at(records, &records[index], mean_radiance))
        .collect()
}

fn fit_at(
    records: &IrradianceRecords,
    record: &IrradianceRecord,
    mean_radiance: &[Vec3],
) -> LinearIrradiance {
    let tangents = [Vec3::X, Vec3::Y].map(|axis| to_world(record.normal, axis));
    let mut matrix = DMat3::ZERO;
    let mut right_sides = [DVec3::ZERO; 3];
    // The record itself is among those visited.
    records.visit(record.position, record.normal, 1.0, |index, weight| {
        let weight = f64::from(weight);
        let offset = (records[index].position - record.position) / record.radius;
        let [x, y] = tangents.map(|tangent| f64::from(offset.dot(tangent)));
        let row = DVec3::new(1.0, x, y);
        matrix += weight * DMat3::from_cols(row, x * row, y * row);
        for (side, channel) in right_sides.iter_mut().zip(mean_radiance[index].to_array()) {
            *side += weight * f64::from(channel) * row;
        }
    });
    let weights = matrix.x_axis.x;
    matrix.y_axis.y += REGULARIZATION * weights;
    matrix.z_axis.z += REGULARIZATION * weights;
    let inverse = matrix.inverse();
    let solved = right_sides.map(|side| inverse * side);
    LinearIrradiance {
        mean_radiance: Vec3::from_array(solved.map(|function| function.x as f32)),
        gradient: solved.map(|function| {
            let [x, y] = [function.y, function.z].map(|change| change as f32);
            (x * tangents[0] + y * tangents[1]) / record.radius
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::irradiance_cache::OccluderPlanes;
    use crate::math::Aabb;
    use crate::sampling::Random;

    /// Values that are linear on a plane are found, up to the regularisation.
    #[test]
    fn finds_linear_values() {
        let normal = Vec3::new(0.48, 0.6, 0.64);
        let bounds = Aabb {
            min: Vec3::splat(-3.0),
            max: Vec3::splat(3.0),
        };
        let mut records = IrradianceRecords::new(bounds, 0.5);
        let mut random = Random::new(7);
        let change = Vec3::new(0.3, -0.2, 0.1);
        let change = change - normal * change.dot(normal);
        let expected = |position: Vec3| Vec3::new(2.0, 1.0, 1.0) * (1.0 + change.dot(position));
        let mut values = Vec::new();
        for _ in 0..400 {
            let point = random.vector(1.0);
            let position = point - normal * point.dot(normal);
            records.push(IrradianceRecord {
                position,
                normal,
                radius: 0.4,
                occluders: OccluderPlanes::default(),
            });
            values.push(expected(position));
        }
        let fitted = fit_gradients(&records, &values);
        for (index, linear) in fitted.iter().enumerate() {
            let record = &records[index];
            if record.position.length() < 0.6 {
                for offset in [Vec3::ZERO, 0.3 * to_world(normal, Vec3::X)] {
                    let error = linear.at(offset) - expected(record.position + offset);
                    assert!(error.length() < 0.02, "{error}");
                }
            }
        }
    }
}
