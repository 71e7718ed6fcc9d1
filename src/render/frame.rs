use super::{PixelSampling, RenderSettings};
use crate::accel::Traversal;
use crate::camera::Camera;
use crate::film::Film;
use crate::sampling::Sequence;
use crate::scene::Scene;
use glam::{DVec2, Vec3};
use rayon::prelude::*;

/// Tiles are squares of this many points: neighbours share what they touch in the cache, and there
/// are enough tiles to keep every thread busy.
const TILE: u32 = 16;

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
    let sample = |film: DVec2, sequence: Sequence, index: u32, traversal: &mut Traversal| {
        let ray = camera.ray(film, size, scene.origin);
        settings
            .integrator
            .radiance(scene, &ray, sequence, index, traversal)
    };
    let grid = Grid::of(settings);
    let points = grid.fill(tile_done, |x, y, work| {
        let sequence = Sequence::new(settings.seed, frame, x, y);
        let corner = DVec2::new(x.into(), y.into());
        match settings.sampling {
            PixelSampling::Corners => work.finite(|t| sample(corner, sequence, 0, t)),
            PixelSampling::Center => work.finite(|t| sample(corner + 0.5, sequence, 0, t)),
            PixelSampling::Spread(count) => {
                let mut sum = Vec3::ZERO;
                for index in 0..count {
                    let [u, v] = sequence.sample_2d(index, 0);
                    let film = corner + DVec2::new(u.into(), v.into());
                    sum += work.finite(|t| sample(film, sequence, index, t));
                }
                sum / count as f32
            }
        }
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

/// What one thread needs while it works on a tile, and what it counts.
#[derive(Default)]
struct Work {
    traversal: Traversal,
    non_finite: u64,
}

impl Work {
    fn finite(&mut self, sample: impl FnOnce(&mut Traversal) -> Vec3) -> Vec3 {
        let light = sample(&mut self.traversal);
        if light.is_finite() {
            return light;
        }
        self.non_finite += 1;
        Vec3::ZERO
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
        point: impl Fn(u32, u32, &mut Work) -> Vec3 + Sync,
    ) -> GridValues {
        let tiles: Vec<(Vec<Vec3>, Work)> = (0..self.tiles())
            .into_par_iter()
            .map(|tile| {
                let mut work = Work::default();
                let values = self.tile_points(tile).map(|(x, y)| point(x, y, &mut work));
                let values = values.collect();
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
            for ((x, y), value) in self.tile_points(tile).zip(values) {
                all.values[y as usize * self.width as usize + x as usize] = value;
            }
            all.rays += work.traversal.rays;
            all.non_finite += work.non_finite;
        }
        all
    }

    /// The points of a tile, row by row.
    fn tile_points(self, tile: u64) -> impl Iterator<Item = (u32, u32)> {
        let tiles_per_row = u64::from(self.width.div_ceil(TILE));
        let x0 = (tile % tiles_per_row) as u32 * TILE;
        let y0 = (tile / tiles_per_row) as u32 * TILE;
        let columns = x0..(x0 + TILE).min(self.width);
        let rows = y0..(y0 + TILE).min(self.height);
        rows.flat_map(move |y| columns.clone().map(move |x| (x, y)))
    }
}
