//! Reprojection: which pixels of two frames show the same points of a static scene.

use crate::accel::QueryState;
use crate::camera::{Camera, CameraRays};
use crate::film::Film;
use crate::geometry::Hit;
use crate::material::FeatureMask;
use crate::math::Ray;
use crate::scene::Scene;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

/// Tolerance between the tangent plane of a point and the hit of a ray that is sent to the point, as a fraction of the
/// point's largest coordinate plus its distance.
///
/// The ray's origin and direction are rounded to single precision: together they make it miss the point by
/// up to (3^(1/2) + 1) / 2 epsilon of that. The hit is on the same surface; where that is curved, it
/// is off the tangent plane by about as much, which is a sixth of the tolerance.
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// Columns and rows of pixels in a tile: matches are thinned tile by tile, and the standard error is estimated from
/// them.
pub const TILE: u32 = 8;

/// The pixels of a frame whose points another frame shows, too, and where: of a static scene, seen
/// by two cameras.
///
/// A pixel of frame `to` is matched if the point in its middle is visible in frame `from`, and if the pixels
/// around it there, which are interpolated, show its surroundings rather than what is in front of or behind it.
/// Rays that leave the scene are not matched: the background is the same in every frame, and a mean over
/// matches should not depend on how much of it is visible.
#[derive(Clone, Debug)]
pub struct Reprojection {
    width: u32,
    height: u32,
    /// The fraction of the pixels that was matched.
    matched: f64,
    matches: Vec<Match>,
}

/// A pixel of frame `to`, and where frame `from` shows the same point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// The pixel of `to`, as an index of [`Film::pixels`].
    pub pixel: usize,
    /// The position in `from`, in pixels from the centre of its first pixel.
    pub position: DVec2,
}

impl Reprojection {
    /// Follows the points in the middle of the pixels of `to` back to `from`, both of `width` x `height`
    /// pixels, on the threads of the current pool.
    pub fn new(scene: &Scene, from: &Camera, to: &Camera, width: u32, height: u32) -> Reprojection {
        let from = View::new(scene, from, width, height);
        let to = View::new(scene, to, width, height);
        let points = from.points();
        let rows = (0..height).into_par_iter();
        let matches = rows.flat_map_iter(|y| to.matches_of_row(y, &from, &points));
        let matches: Vec<Match> = matches.collect();
        let pixels = f64::from(width) * f64::from(height);
        Reprojection {
            width,
            height,
            matched: matches.len() as f64 / pixels.max(1.0),
            matches,
        }
    }

    /// Columns of both frames.
    pub(super) fn width(&self) -> u32 {
        self.width
    }

    /// Rows of both frames.
    pub(super) fn height(&self) -> u32 {
        self.height
    }

    /// Keeps the matches in about this many tiles of [`TILE`] x [`TILE`] pixels, evenly distributed, for frames that
    /// are only rendered there. [`Reprojection::matched`] does not change.
    pub fn thin(&mut self, tiles: u32) {
        let (width, columns) = (self.width as usize, self.width.div_ceil(TILE) as usize);
        let every = (self.width.div_ceil(TILE) * self.height.div_ceil(TILE)).div_ceil(tiles);
        let tile =
            |pixel: usize| pixel / width / TILE as usize * columns + pixel % width / TILE as usize;
        // The golden ratio's multiples are evenly distributed (Knuth, "The Art of Computer Programming" 3, 6.4).
        let chosen = |tile: usize| {
            let multiple = (tile as u32).wrapping_mul(0x9e37_79b9);
            (u64::from(multiple) * u64::from(every)) >> 32 == 0
        };
        self.matches.retain(|of| chosen(tile(of.pixel)));
    }

    /// The matches, in the order of the pixels.
    pub fn matches(&self) -> &[Match] {
        &self.matches
    }

    /// The fraction of the pixels that is matched, 0..1.
    pub fn matched(&self) -> f64 {
        self.matched
    }

    /// The pixels of `from` that a match is interpolated from, as indices of [`Film::pixels`], and their
    /// weights, which sum to 1. A pixel of weight 0 may be listed twice.
    pub fn taps(&self, of: &Match) -> [(usize, f64); 4] {
        taps(of.position, self.width as usize, self.height as usize)
    }

    /// At the matches, the radiance in frame `to` less that of the same points in `from`.
    pub fn residual(&self, [from, to]: [&Film; 2]) -> Vec<Vec3> {
        self.assert_size(from);
        self.assert_size(to);
        let residual = |of: &Match| {
            let now = to.pixels()[of.pixel].as_dvec3();
            (now - self.interpolate(of, from)).as_vec3()
        };
        self.matches.iter().map(residual).collect()
    }

    fn interpolate(&self, of: &Match, from: &Film) -> DVec3 {
        let taps = self.taps(of).into_iter();
        taps.map(|(pixel, weight)| weight * from.pixels()[pixel].as_dvec3())
            .sum()
    }

    fn assert_size(&self, film: &Film) {
        let sizes = [(film.width(), film.height()), (self.width, self.height)];
        assert_eq!(sizes[0], sizes[1], "films are of the reprojection's size");
    }
}

/// The taps of bilinear interpolation at a position within the pixels' centres.
fn taps(position: DVec2, width: usize, height: usize) -> [(usize, f64); 4] {
    let corner = position.floor();
    let part = position - corner;
    let (x, y) = (corner.x as usize, corner.y as usize);
    // Pixels beyond the last centre have weight 0.
    let (right, below) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
    [
        (y * width + x, (1.0 - part.x) * (1.0 - part.y)),
        (y * width + right, part.x * (1.0 - part.y)),
        (below * width + x, (1.0 - part.x) * part.y),
        (below * width + right, part.x * part.y),
    ]
}

/// A scene through a camera, and the camera's film.
struct View<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    rays: CameraRays,
    width: u32,
    height: u32,
    size: DVec2,
}

/// A pixel whose point may be visible in `from`.
struct Candidate {
    point: DVec3,
    /// The geometric normal on the viewer's side.
    normal: DVec3,
    of: Match,
}

impl<'a> View<'a> {
    fn new(scene: &'a Scene, camera: &'a Camera, width: u32, height: u32) -> View<'a> {
        let size = DVec2::new(width.into(), height.into());
        View {
            scene,
            camera,
            rays: camera.rays(size, scene.origin),
            width,
            height,
            size,
        }
    }

    /// The rays through the middle of a row's pixels.
    fn row(&self, y: u32) -> Vec<Ray> {
        let centre = |x: u32| DVec2::new(x.into(), y.into()) + 0.5;
        let rays = (0..self.width).map(|x| self.rays.through(centre(x)));
        rays.collect()
    }

    /// The point in the middle of each pixel, relative to the scene's origin.
    fn points(&self) -> Vec<Option<DVec3>> {
        let row = |y| {
            let rays = self.row(y);
            let hits = hits(self.scene, &rays);
            let point = |(ray, hit): (&Ray, Option<Hit>)| hit.map(|hit| ray.at(hit.t));
            let points: Vec<_> = rays.iter().zip(hits).map(point).collect();
            points
        };
        let rows = (0..self.height).into_par_iter();
        rows.flat_map_iter(row).collect()
    }

    /// The position of a point on the film.
    fn project(&self, point: DVec3) -> Option<DVec2> {
        self.camera.project(self.size, point + self.scene.origin)
    }

    /// The distance of a point from the eye.
    fn distance(&self, point: DVec3) -> f64 {
        (point + self.scene.origin).distance(self.camera.position)
    }

    /// The width of a pixel at a distance.
    fn pixel(&self, distance: f64) -> f64 {
        distance * 2.0 * self.camera.half_height / self.size.y
    }

    /// The matches of a row of this view's film in `from`, whose pixels show `points`.
    fn matches_of_row(&self, y: u32, from: &View, points: &[Option<DVec3>]) -> Vec<Match> {
        let rays = self.row(y);
        let mut candidates = Vec::new();
        let mut rays_from = Vec::new();
        for (x, (ray, hit)) in (0..).zip(rays.iter().zip(hits(self.scene, &rays))) {
            let Some(hit) = hit else { continue };
            let point = ray.at(hit.t);
            let (Some(before), Some(now)) = (from.project(point), self.project(point)) else {
                continue;
            };
            // The motion of the point is added to the pixel's centre, rather than `before` used: the ray through the
            // centre was rounded, and a static camera must give no motion at all.
            let position = DVec2::new(x.into(), y.into()) + (before - now);
            if from.interpolates(position) {
                let surface = self.scene.surface::<FeatureMask<0>>(ray, &hit);
                let pixel = y as usize * self.width as usize + x as usize;
                candidates.push(Candidate {
                    point,
                    normal: surface.point.geometric_normal.as_dvec3(),
                    of: Match { pixel, position },
                });
                rays_from.push(from.rays.through(before));
            }
        }
        let found = hits(self.scene, &rays_from);
        let is_match = |candidate: &Candidate, ray: &Ray, hit: Option<Hit>| {
            hit.is_some_and(|hit| from.sees(candidate, ray, &hit))
                && from.shows_surroundings(candidate, points)
        };
        let all = candidates.iter().zip(rays_from.iter().zip(found));
        all.filter(|(candidate, (ray, hit))| is_match(candidate, ray, *hit))
            .map(|(candidate, _)| candidate.of)
            .collect()
    }

    /// Whether the film has all pixels around a position.
    fn interpolates(&self, position: DVec2) -> bool {
        position.cmpge(DVec2::ZERO).all() && position.cmple(self.size - 1.0).all()
    }

    /// Whether the hit of the ray to a point is the point, seen from the same side.
    ///
    /// The distance along the ray is no criterion: on a surface at a grazing angle, its error is many times
    /// the rounding. Nor is the primitive, which is any of those that share an edge. The distance from the tangent
    /// plane is one, since the hit is on the line from the eye to the point.
    fn sees(&self, candidate: &Candidate, ray: &Ray, hit: &Hit) -> bool {
        let magnitude = candidate.point.abs().max_element() + self.distance(candidate.point);
        candidate.off_plane(ray.at(hit.t)) <= ROUNDING * magnitude
            && candidate.normal.dot(ray.direction.as_dvec3()) < 0.0
    }

    /// Whether the pixels that a match is interpolated from show points within a pixel's width of its tangent plane.
    ///
    /// A plane at any angle passes. A point of a smooth shape k pixels inside its silhouette
    /// has its neighbours 1/(4k) pixels from its tangent plane, whatever the shape's size: it passes almost up to
    /// the silhouette. Points beyond the silhouette are farther behind than a pixel's width, unless there is hardly
    /// any step in depth.
    fn shows_surroundings(&self, candidate: &Candidate, points: &[Option<DVec3>]) -> bool {
        let pixel = self.pixel(self.distance(candidate.point));
        let taps = taps(
            candidate.of.position,
            self.width as usize,
            self.height as usize,
        );
        let read = taps.into_iter().filter(|(_, weight)| *weight > 0.0);
        read.map(|(index, _)| points[index])
            .all(|point| point.is_some_and(|point| candidate.off_plane(point) <= pixel))
    }
}

impl Candidate {
    /// The distance of a point from the tangent plane.
    fn off_plane(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point).abs()
    }
}

/// The hits of coherent rays.
fn hits(scene: &Scene, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    scene.closest_coherent(rays, &mut hits, &mut QueryState::default());
    hits
}
