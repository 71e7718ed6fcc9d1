//! Fits a quadratic function to the values around each record. This gives the irradiance gradients of Ward and Heckbert
//! 1992 and averages the noise of neighbours (weighted least squares, as the nodal functions of Renka 1988,
//! "Multivariate Interpolation of Large Sets of Scattered Data"). How many neighbours is decided by the values: as many as
//! agree with fewer, within their noise (Lepski 1990, "On a Problem of Adaptive Estimation in Gaussian White Noise").

use super::least_squares::{Coefficients, LeastSquares};
use super::neighbours::Neighbours;
use super::placement::MAX_ANGLE;
use crate::accel::QueryState;
use crate::integrator::{sees_eye, sees_record};
use crate::irradiance_cache::{IrradianceRecord, LinearIrradiance};
use crate::math::to_world;
use crate::scene::{Scene, SurfacePoint};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// How far neighbours are, in radii of the record, from few to many.
const REACHES: [f32; 3] = [1.9, 3.1, 4.8];

/// Neighbours whose radii differ by up to this factor count.
const MAX_RATIO: f32 = 2.1;

/// How many standard errors of fewer neighbours more may be off.
const TOLERANCE: f64 = 2.0;

/// Records see each other up to this part of the sum of their free radii: their eyes are above them.
const SURE: f32 = 0.95;

/// What was gathered at a record.
#[derive(Clone, Copy, Debug)]
pub(super) struct GatheredValue {
    pub(super) point: SurfacePoint,
    pub(super) mean_radiance: Vec3,
    /// Half the difference between the values by each half of the paths.
    pub(super) half_difference: Vec3,
    /// How many paths gathered it.
    pub(super) paths: u32,
}

/// The function that fits the values around a record, and that of half the differences between the halves of their paths.
pub(super) type RecordFit = [LinearIrradiance; 2];

/// The values of some records.
pub(super) struct Fits<'a> {
    scene: &'a Scene,
    records: &'a [IrradianceRecord],
    values: &'a [GatheredValue],
    neighbours: Neighbours,
}

impl<'a> Fits<'a> {
    /// Of records and their values.
    pub(super) fn new(
        scene: &'a Scene,
        records: &'a [IrradianceRecord],
        values: &'a [GatheredValue],
    ) -> Fits<'a> {
        Fits {
            scene,
            records,
            values,
            neighbours: Neighbours::new(records),
        }
    }

    /// For each record the function on its tangent plane that fits the values of the records around it best, which it
    /// sees; and the same of half the differences between the halves of their paths.
    pub(super) fn gradients(&self) -> Vec<RecordFit> {
        let numbers = (0..self.records.len()).into_par_iter();
        let fit = |query_state: &mut QueryState, index: usize| self.fit(index, query_state);
        numbers.map_init(QueryState::default, fit).collect()
    }

    /// Whether a record stands too far apart from its neighbours: values are off the function through them by more than
    /// their noise and `misfit`, in the mean and relative to the function.
    pub(super) fn is_coarse(&self, index: usize, misfit: f64) -> bool {
        let neighbours = self.around(index, REACHES[0], &mut QueryState::default());
        let fit = fit_within(&neighbours, 1.0);
        let value = fit.coefficients[0][0].element_sum();
        fit.residuals > 2.0 * fit.noise + (misfit * value).powi(2)
    }

    fn sees(&self, index: usize, neighbour: usize, query_state: &mut QueryState) -> bool {
        let (record, other) = (&self.records[index], &self.records[neighbour]);
        let point = &self.values[index].point;
        let distance = point.position.distance(other.position);
        if distance < SURE * (record.free_radius + other.free_radius) {
            let on_surface = IrradianceRecord {
                free_radius: f32::INFINITY,
                ..*other
            };
            return sees_record(self.scene, point, &on_surface, query_state);
        }
        sees_eye(self.scene, point, other.eye, query_state)
    }

    fn fit(&self, index: usize, query_state: &mut QueryState) -> RecordFit {
        let record = &self.records[index];
        let largest = REACHES[REACHES.len() - 1];
        let neighbours = self.around(index, largest, query_state);
        let fits = REACHES.map(|reach| fit_within(&neighbours, reach / largest));
        let mut chosen = &fits[0];
        for (count, fit) in fits.iter().enumerate().skip(1) {
            let agrees = |fewer: &ReachFit| {
                let [value, of_fewer] = [fit, fewer].map(|fit| fit.coefficients[0][0]);
                let off = (value - of_fewer).element_sum();
                off.abs() <= TOLERANCE * fewer.standard_error
            };
            if !fits[..count].iter().all(agrees) {
                break;
            }
            chosen = fit;
        }
        let [along_x, along_y] = tangents(record.normal);
        let [value, half_difference] = [0, 1].map(|color| {
            let [value, x, y, ..] = chosen.coefficients[color].map(|c| c.as_vec3());
            let gradient =
                |channel: usize| (x[channel] * along_x + y[channel] * along_y) / record.radius;
            LinearIrradiance {
                mean_radiance: value,
                gradient: [0, 1, 2].map(gradient),
            }
        });
        [bounded(value, &neighbours, record.radius), half_difference]
    }

    /// What a record sees within a reach; itself is among it.
    fn around(&self, index: usize, reach: f32, query_state: &mut QueryState) -> Vec<Neighbour> {
        let record = &self.records[index];
        let tangents = tangents(record.normal);
        let angle_weight = IrradianceRecord::angle_weight(MAX_ANGLE);
        let wide = IrradianceRecord {
            radius: reach * record.radius,
            ..*record
        };
        let mut found = Vec::new();
        let (position, radius) = (record.position, record.radius);
        self.neighbours
            .visit(position, radius, MAX_RATIO, wide.radius, |neighbour| {
                let other = &self.records[neighbour];
                let distance_squared =
                    wide.distance_squared(other.position, other.normal, angle_weight);
                if distance_squared >= 1.0
                    || (neighbour != index && !self.sees(index, neighbour, query_state))
                {
                    return;
                }
                let value = &self.values[neighbour];
                let offset = (other.position - position) / radius;
                let area = f64::from(other.radius / radius).powi(2);
                found.push(Neighbour {
                    weight: f64::from(value.paths) * area.min(1.0),
                    distance_squared: distance_squared.into(),
                    offset: tangents.map(|tangent| f64::from(offset.dot(tangent))),
                    mean_radiance: value.mean_radiance.as_dvec3(),
                    half_difference: value.half_difference.as_dvec3(),
                });
            });
        found
    }
}

/// A fit without what polynomials do at steps: between the least and the greatest value around a record, and not below
/// black within its radius.
fn bounded(mut fit: LinearIrradiance, neighbours: &[Neighbour], radius: f32) -> LinearIrradiance {
    let near = neighbours.iter().filter(|neighbour| neighbour.is_near());
    let values = near.map(|neighbour| neighbour.mean_radiance.as_vec3());
    let empty = (Vec3::INFINITY, Vec3::ZERO);
    let (least, greatest) = values.fold(empty, |(least, greatest), v| {
        (least.min(v), greatest.max(v))
    });
    fit.mean_radiance = fit.mean_radiance.max(least).min(greatest);
    for (gradient, value) in fit.gradient.iter_mut().zip(fit.mean_radiance.to_array()) {
        *gradient = gradient.clamp_length_max(value / radius);
    }
    fit
}

fn tangents(normal: Vec3) -> [Vec3; 2] {
    [Vec3::X, Vec3::Y].map(|axis| to_world(normal, axis))
}

/// A value around a record.
struct Neighbour {
    /// Of what it says: by paths and area.
    weight: f64,
    /// Its squared distance in units of the largest reach, with what the angle between normals adds.
    distance_squared: f64,
    /// Relative to the record, along two tangents and in radii.
    offset: [f64; 2],
    mean_radiance: DVec3,
    half_difference: DVec3,
}

impl Neighbour {
    /// Whether it is within the least reach.
    fn is_near(&self) -> bool {
        self.distance_squared < f64::from(REACHES[0] / REACHES[REACHES.len() - 1]).powi(2)
    }
}

/// A fit to the neighbours within a reach.
struct ReachFit {
    /// Of mean radiance and half difference.
    coefficients: Coefficients,
    /// The standard error of the value at the record, by the scatter of the neighbours.
    standard_error: f64,
    /// The mean square by which values are off the function, and that of their own noise.
    residuals: f64,
    noise: f64,
}

/// The fit to the neighbours within a part of the largest reach.
fn fit_within(neighbours: &[Neighbour], part: f32) -> ReachFit {
    let part_squared = f64::from(part * part);
    let kernel = |neighbour: &Neighbour| (1.0 - neighbour.distance_squared / part_squared).max(0.0);
    let mut least_squares = LeastSquares::default();
    for neighbour in neighbours {
        let weight = neighbour.weight * kernel(neighbour).powi(2);
        if weight > 0.0 {
            let pair = [neighbour.mean_radiance, neighbour.half_difference];
            least_squares.add(weight, neighbour.offset, pair);
        }
    }
    let coefficients = least_squares.solve();
    let (mut weights, mut squared_weights, mut residuals, mut noise) = (0.0, 0.0, 0.0, 0.0);
    for neighbour in neighbours {
        let weight = neighbour.weight * kernel(neighbour).powi(2);
        let fitted = LeastSquares::value(&coefficients[0], neighbour.offset);
        let residual = (neighbour.mean_radiance - fitted).element_sum();
        weights += weight;
        squared_weights += weight * weight;
        residuals += weight * residual * residual;
        noise += weight * neighbour.half_difference.element_sum().powi(2);
    }
    let (residuals, noise) = (residuals / weights, noise / weights);
    let parts = squared_weights / (weights * weights);
    ReachFit {
        coefficients,
        standard_error: (residuals.max(noise) * parts).sqrt(),
        residuals,
        noise,
    }
}
