//! Fits a linear function to the values around each record. This gives the irradiance gradients of Ward and Heckbert
//! 1992 and averages the noise of neighbours (weighted least squares, as the nodal functions of Renka 1988,
//! "Multivariate Interpolation of Large Sets of Scattered Data").

use super::placement::MAX_ANGLE;
use crate::accel::QueryState;
use crate::integrator::sees;
use crate::irradiance_cache::{IrradianceRecord, IrradianceRecords, LinearIrradiance};
use crate::math::to_world;
use crate::scene::{Scene, SurfacePoint};
use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

/// Ridge regularisation of the gradient, in units of the radius, relative to the sum of the weights.
const REGULARIZATION: f64 = 0.005;

/// How far neighbours are, in radii of the record.
const REACH: f32 = 1.5;

/// Neighbours of up to this many times the radius count.
const MAX_RATIO: f32 = 2.5;

/// What was gathered at a record.
#[derive(Clone, Copy, Debug)]
pub(super) struct GatheredValue {
    pub(super) point: SurfacePoint,
    pub(super) mean_radiance: Vec3,
    /// How many paths gathered it.
    pub(super) paths: u32,
}

/// For each record the linear function on its tangent plane that fits the values of the records around it best, which it
/// sees.
pub(super) fn fit_gradients(
    scene: &Scene,
    records: &IrradianceRecords,
    values: &[GatheredValue],
) -> Vec<LinearIrradiance> {
    let numbers = (0..records.len()).into_par_iter();
    let fit = |query_state: &mut QueryState, index: usize| {
        let is_seen = |neighbour: usize| {
            let point = &values[index].point;
            let is_doubtful = records[index].is_obstructed
                || records[neighbour].is_doubtful(point.position, point.shading_normal);
            !is_doubtful || sees(scene, point, records[neighbour].eye, query_state)
        };
        fit_at(records, index, values, is_seen)
    };
    numbers.map_init(QueryState::default, fit).collect()
}

fn fit_at(
    records: &IrradianceRecords,
    index: usize,
    values: &[GatheredValue],
    mut is_seen: impl FnMut(usize) -> bool,
) -> LinearIrradiance {
    let record = &records[index];
    let tangents = [Vec3::X, Vec3::Y].map(|axis| to_world(record.normal, axis));
    let mut matrix = DMat3::ZERO;
    let mut right_sides = [DVec3::ZERO; 3];
    let reach = REACH * record.radius;
    let wide = IrradianceRecord {
        radius: reach,
        ..*record
    };
    let normal_weight = 1.0 / (1.0 - libm::cosf(MAX_ANGLE));
    // The record itself is among them.
    records.visit_within(record.position, reach, |neighbour| {
        let other = &records[neighbour];
        let weight = wide.weight(other.position, other.normal, normal_weight);
        let is_alike = other.radius <= MAX_RATIO * record.radius;
        if weight <= 0.0 || !is_alike || (neighbour != index && !is_seen(neighbour)) {
            return;
        }
        let value = &values[neighbour];
        let area = f64::from(other.radius / record.radius).powi(2);
        let weight = f64::from(weight * reach.powi(4)) * f64::from(value.paths).min(4096.0) * area.min(1.0);
        let offset = (other.position - record.position) / record.radius;
        let [x, y] = tangents.map(|tangent| f64::from(offset.dot(tangent)));
        let row = DVec3::new(1.0, x, y);
        matrix += weight * DMat3::from_cols(row, x * row, y * row);
        for (side, channel) in right_sides.iter_mut().zip(value.mean_radiance.to_array()) {
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
