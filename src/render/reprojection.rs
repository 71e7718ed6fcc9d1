use crate::accel::Traversal;
use crate::camera::{Camera, CameraRays};
use crate::film::Film;
use crate::geometry::Hit;
use crate::material::Only;
use crate::math::Ray;
use crate::scene::Scene;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

/// So much, as a share of a point's largest coordinate and of its distance together, may be between the
/// plane of the surface at the point and what a ray that is sent to it meets there.
///
/// The ray's start and direction are rounded to single precision: together they make it pass the point by
/// up to (3^(1/2) + 1) / 2 epsilon of that. What it meets there is on the same surface; where that bends, it
/// is off the plane at the point by about as much, for which the bound leaves room six times over.
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// Tiles of so many pixels in a row and in a column are worked out, and tell the standard error.
pub const TILE: u32 = 8;

/// Which points a frame shows that another one shows, too, and where: of a scene that stands still, seen
/// by two cameras.
///
/// A pixel of frame `to` is matched if the point in its middle is seen in frame `from`, and if the pixels
/// around it there, which are interpolated, show its surroundings rather than what is before or behind it.
/// Rays that leave the scene are not matched: the background is the same in every frame, and a mean over
/// what is matched should not depend on how much of it is seen.
#[derive(Clone, Debug)]
pub struct Reprojection {
    width: u32,
    height: u32,
    /// The share of the pixels that was matched.
    matched: f64,
    matches: Vec<Match>,
}

/// A pixel of frame `to`, and where frame `from` shows the same point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// The pixel of `to`, as an index of [`Film::pixels`].
    pub pixel: usize,
    /// The place in `from`, in pixels from the centre of its first pixel.
    pub place: DVec2,
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

    /// Keeps the matches in about so many squares of [`TILE`] x [`TILE`] pixels, spread evenly, for frames that
    /// are only worked out there. [`Reprojection::matched`] stays what it was.
    pub fn thin(&mut self, tiles: u32) {
        let (width, columns) = (self.width as usize, self.width.div_ceil(TILE) as usize);
        let every = (self.width.div_ceil(TILE) * self.height.div_ceil(TILE)).div_ceil(tiles);
        let tile =
            |pixel: usize| pixel / width / TILE as usize * columns + pixel % width / TILE as usize;
        // The golden ratio's multiples are spread evenly (Knuth, "The Art of Computer Programming" 3, 6.4).
        let chosen = |tile: usize| {
            let place = (tile as u32).wrapping_mul(0x9e37_79b9);
            (u64::from(place) * u64::from(every)) >> 32 == 0
        };
        self.matches.retain(|of| chosen(tile(of.pixel)));
    }

    /// What is seen in both frames, in the order of the pixels.
    pub fn matches(&self) -> &[Match] {
        &self.matches
    }

    /// The share of the pixels that is matched, 0..1.
    pub fn matched(&self) -> f64 {
        self.matched
    }

    /// The pixels of `from` that a match is interpolated from, as indices of [`Film::pixels`], and their
    /// weights, which sum to 1. What has no weight may be there twice.
    pub fn taps(&self, of: &Match) -> [(usize, f64); 4] {
        taps(of.place, self.width as usize, self.height as usize)
    }

    /// What frame `to` has more than `from` shows of the same points, at the matches.
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

/// What bilinear interpolation reads at a place that is not outside the pixels' centres.
fn taps(place: DVec2, width: usize, height: usize) -> [(usize, f64); 4] {
    let corner = place.floor();
    let part = place - corner;
    let (x, y) = (corner.x as usize, corner.y as usize);
    // Beyond the last centre there is no weight.
    let (right, below) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
    [
        (y * width + x, (1.0 - part.x) * (1.0 - part.y)),
        (y * width + right, part.x * (1.0 - part.y)),
        (below * width + x, (1.0 - part.x) * part.y),
        (below * width + right, part.x * part.y),
    ]
}

/// A camera, its film and what it sees.
struct View<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    rays: CameraRays,
    width: u32,
    height: u32,
    size: DVec2,
}

/// A point of a row, before it is known whether `from` sees it.
struct Candidate {
    point: DVec3,
    /// Of its surface, on the viewer's side.
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

    /// What the middle of each pixel shows, relative to the scene's origin.
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

    /// Where a point is seen on the film.
    fn project(&self, point: DVec3) -> Option<DVec2> {
        self.camera.project(self.size, point + self.scene.origin)
    }

    /// How far a point is from the eye.
    fn distance(&self, point: DVec3) -> f64 {
        (point + self.scene.origin).distance(self.camera.position)
    }

    /// How wide a pixel is at a distance.
    fn pixel(&self, distance: f64) -> f64 {
        distance * 2.0 * self.camera.half_height / self.size.y
    }

    /// The matches of a row of this view's film in `from`, whose pixels show `points`.
    fn matches_of_row(&self, y: u32, from: &View, points: &[Option<DVec3>]) -> Vec<Match> {
        let rays = self.row(y);
        let mut candidates = Vec::new();
        let mut sights = Vec::new();
        for (x, (ray, hit)) in (0..).zip(rays.iter().zip(hits(self.scene, &rays))) {
            let Some(hit) = hit else { continue };
            let point = ray.at(hit.t);
            let (Some(before), Some(now)) = (from.project(point), self.project(point)) else {
                continue;
            };
            // How far the point moves, rather than where it comes from: the ray through the pixel's centre
            // was rounded, and a camera that stands still moves no point at all.
            let place = DVec2::new(x.into(), y.into()) + (before - now);
            if from.interpolates(place) {
                let surface = self.scene.surface::<Only<0>>(ray, &hit);
                let pixel = y as usize * self.width as usize + x as usize;
                candidates.push(Candidate {
                    point,
                    normal: surface.point.geometric_normal.as_dvec3(),
                    of: Match { pixel, place },
                });
                sights.push(from.rays.through(before));
            }
        }
        let found = hits(self.scene, &sights);
        let is_match = |candidate: &Candidate, ray: &Ray, hit: Option<Hit>| {
            hit.is_some_and(|hit| from.sees(candidate, ray, &hit))
                && from.shows_surroundings(candidate, points)
        };
        let all = candidates.iter().zip(sights.iter().zip(found));
        all.filter(|(candidate, (ray, hit))| is_match(candidate, ray, *hit))
            .map(|(candidate, _)| candidate.of)
            .collect()
    }

    /// Whether no pixel is missing around a place.
    fn interpolates(&self, place: DVec2) -> bool {
        place.cmpge(DVec2::ZERO).all() && place.cmple(self.size - 1.0).all()
    }

    /// Whether what the ray to a point meets is the point, seen from the same side.
    ///
    /// How far it is along the ray does not tell: on a surface that is seen at a glance, that is many times
    /// the rounding. How far it is from the plane of the surface does, since it is on the line from the eye
    /// to the point. Neither does the primitive, which is any of those that meet in an edge.
    fn sees(&self, candidate: &Candidate, ray: &Ray, hit: &Hit) -> bool {
        let magnitude = candidate.point.abs().max_element() + self.distance(candidate.point);
        candidate.off_plane(ray.at(hit.t)) <= ROUNDING * magnitude
            && candidate.normal.dot(ray.direction.as_dvec3()) < 0.0
    }

    /// Whether the pixels that a match is interpolated from show nothing farther from the plane of its
    /// surface than a pixel is wide.
    ///
    /// A plane, be it ever so steep, passes. A smooth shape's point that is seen k pixels inside its outline
    /// has its neighbours 1/(4k) pixels from its plane, whatever the shape's size: it passes almost up to
    /// the outline, beyond which what is seen is behind it by more than a pixel unless it is hardly behind
    /// it at all.
    fn shows_surroundings(&self, candidate: &Candidate, points: &[Option<DVec3>]) -> bool {
        let pixel = self.pixel(self.distance(candidate.point));
        let taps = taps(
            candidate.of.place,
            self.width as usize,
            self.height as usize,
        );
        let read = taps.into_iter().filter(|(_, weight)| *weight > 0.0);
        read.map(|(number, _)| points[number])
            .all(|point| point.is_some_and(|point| candidate.off_plane(point) <= pixel))
    }
}

impl Candidate {
    /// How far a point is from the plane of the surface.
    fn off_plane(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point).abs()
    }
}

/// What rays that run side by side meet.
fn hits(scene: &Scene, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    scene.closest_coherent(rays, &mut hits, &mut Traversal::default());
    hits
}
