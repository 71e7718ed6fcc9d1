use super::{PixelSampling, RenderSettings};
use crate::accel::Traversal;
use crate::camera::Camera;
use crate::film::Film;
use crate::integrator::CameraSample;
use crate::sampling::Sequence;
use crate::scene::Scene;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

/// Tiles are squares of this many points: neighbours share what they touch in the cache, and there
/// are enough tiles to keep every thread busy.
const TILE: u32 = 16;

/// So many camera rays set out together.
const BATCH: usize = 64;

/// A frame and what it took.
#[derive(Debug)]
pub struct RenderedFrame {
    /// The picture.
    pub film: Film,
    /// How many rays were traced.
    pub rays: u64,
    /// Samples whose light was not a finite number, replaced by black: a fault of the scene's
    /// numbers or of the program.
    pub non_finite_samples: u64,
}

/// How many steps of progress a frame makes.
pub fn tile_count(settings: &RenderSettings) -> u64 {
    Grid::of(settings).tiles()
}

/// Renders frame number `frame` through `camera` on the threads of the current pool.
///
/// `tile_done` is told the rays of each tile when it is finished.
pub fn render_frame(
    scene: &Scene,
    camera: &Camera,
    settings: &RenderSettings,
    frame: u32,
    tile_done: &(dyn Fn(u64) + Sync),
) -> RenderedFrame {
    let size = DVec2::new(settings.width.into(), settings.height.into());
    let rays = camera.rays(size, scene.origin);
    let grid = Grid::of(settings);
    let count = match settings.sampling {
        PixelSampling::Spread(count) => count,
        PixelSampling::Center | PixelSampling::Corners => 1,
    };
    let points = grid.fill(tile_done, |points, work| {
        // In double precision: a million equal numbers would not add up in single precision.
        let mut sums = vec![DVec3::ZERO; points.len()];
        let mut batch = Vec::with_capacity(BATCH);
        let mut owners = Vec::with_capacity(BATCH);
        for (number, &(x, y)) in points.iter().enumerate() {
            let sequence = Sequence::new(settings.seed, frame, x, y);
            let corner = DVec2::new(x.into(), y.into());
            for index in 0..count {
                let film = match settings.sampling {
                    PixelSampling::Corners => corner,
                    PixelSampling::Center => corner + 0.5,
                    PixelSampling::Spread(_) => {
                        let [u, v] = sequence.sample_2d(index, 0);
                        corner + DVec2::new(u.into(), v.into())
                    }
                };
                batch.push(CameraSample {
                    ray: rays.through(film),
                    sequence,
                    index,
                });
                owners.push(number);
                if batch.len() == BATCH {
                    work.add_radiance(scene, settings, &mut batch, &mut owners, &mut sums);
                }
            }
        }
        work.add_radiance(scene, settings, &mut batch, &mut owners, &mut sums);
        let mean = |sum: DVec3| (sum / f64::from(count)).as_vec3();
        sums.into_iter().map(mean).collect()
    });
    let mut film = Film::new(settings.width, settings.height);
    match settings.sampling {
        PixelSampling::Corners => average_corners(&points.values, &mut film),
        _ => film.pixels_mut().copy_from_slice(&points.values),
    }
    RenderedFrame {
        film,
        rays: points.rays,
        non_finite_samples: points.non_finite,
    }
}

/// Each pixel becomes the mean of the four lattice points around it.
fn average_corners(lattice: &[Vec3], film: &mut Film) {
    let (width, stride) = (film.width() as usize, film.width() as usize + 1);
    for (y, row) in film.pixels_mut().chunks_exact_mut(width).enumerate() {
        let (above, below) = lattice[y * stride..].split_at(stride);
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = 0.25 * ((above[x] + above[x + 1]) + (below[x] + below[x + 1]));
        }
    }
}

/// The points of a frame that are worked out one by one: its pixels, or their corners.
#[derive(Clone, Copy)]
struct Grid {
    width: u32,
    height: u32,
}

struct GridValues {
    values: Vec<Vec3>,
    rays: u64,
    non_finite: u64,
}

/// What a thread needs while it works on a tile, and what it counts.
#[derive(Default)]
struct Work {
    traversal: Traversal,
    non_finite: u64,
}

impl Work {
    /// Adds the light of up to [`BATCH`] samples to the sums of their owners, and forgets them.
    fn add_radiance(
        &mut self,
        scene: &Scene,
        settings: &RenderSettings,
        batch: &mut Vec<CameraSample>,
        owners: &mut Vec<usize>,
        sums: &mut [DVec3],
    ) {
        let mut radiance = [Vec3::ZERO; BATCH];
        let radiance = &mut radiance[..batch.len()];
        settings
            .integrator
            .radiance(scene, batch, &mut self.traversal, radiance);
        for (owner, light) in owners.iter().zip(radiance) {
            if light.is_finite() {
                sums[*owner] += light.as_dvec3();
            } else {
                self.non_finite += 1;
            }
        }
        batch.clear();
        owners.clear();
    }
}

impl Grid {
    fn of(settings: &RenderSettings) -> Grid {
        let more = u32::from(settings.sampling == PixelSampling::Corners);
        Grid {
            width: settings.width + more,
            height: settings.height + more,
        }
    }

    fn tiles(self) -> u64 {
        u64::from(self.width.div_ceil(TILE)) * u64::from(self.height.div_ceil(TILE))
    }

    /// Works out every point, tile by tile in parallel.
    fn fill(
        self,
        tile_done: &(dyn Fn(u64) + Sync),
        tile: impl Fn(&[(u32, u32)], &mut Work) -> Vec<Vec3> + Sync,
    ) -> GridValues {
        let tiles: Vec<(Vec<Vec3>, Work)> = (0..self.tiles())
            .into_par_iter()
            .map(|number| {
                let mut work = Work::default();
                let values = tile(&self.tile_points(number), &mut work);
                tile_done(work.traversal.rays);
                (values, work)
            })
            .collect();
        let mut all = GridValues {
            values: vec![Vec3::ZERO; self.width as usize * self.height as usize],
            rays: 0,
            non_finite: 0,
        };
        for (tile, (values, work)) in (0..).zip(tiles) {
            for ((x, y), value) in self.tile_points(tile).into_iter().zip(values) {
                all.values[y as usize * self.width as usize + x as usize] = value;
            }
            all.rays += work.traversal.rays;
            all.non_finite += work.non_finite;
        }
        all
    }

    /// The points of a tile, in squares of two by two, in squares of four by four, and so on: rays
    /// that are traced together stay close.
    fn tile_points(self, tile: u64) -> Vec<(u32, u32)> {
        let tiles_per_row = u64::from(self.width.div_ceil(TILE));
        let x0 = (tile % tiles_per_row) as u32 * TILE;
        let y0 = (tile / tiles_per_row) as u32 * TILE;
        (0..TILE * TILE)
            .map(|i| (x0 + every_second_bit(i), y0 + every_second_bit(i >> 1)))
            .filter(|(x, y)| *x < self.width && *y < self.height)
            .collect()
    }
}

/// Bits 0, 2, 4 and 6, side by side.
fn every_second_bit(bits: u32) -> u32 {
    (0..4).fold(0, |gathered, i| gathered | (bits >> (2 * i) & 1) << i)
}
