use super::WIDTH;
use super::node::PADDING;
use super::simd::F32x8;
use crate::geometry::{Hit, plane_distance};
use crate::math::Ray;
use glam::Vec3;

/// Up to eight triangles, coordinate by coordinate; a lane that is not needed repeats the last.
#[derive(Debug)]
#[repr(C, align(32))]
pub(super) struct TriangleBlock {
    /// `corners[corner][axis][lane]`.
    corners: [[[f32; WIDTH]; 3]; 3],
    /// The triangles' numbers.
    ids: [u32; WIDTH],
}

impl TriangleBlock {
    /// Takes one to eight numbers of `triangles`.
    pub(super) fn new(ids: &[u32], triangles: &[[Vec3; 3]]) -> TriangleBlock {
        let ids: [u32; WIDTH] = std::array::from_fn(|lane| ids[lane.min(ids.len() - 1)]);
        let corners = std::array::from_fn(|corner| {
            std::array::from_fn(|axis| ids.map(|id| triangles[id as usize][corner][axis]))
        });
        TriangleBlock { corners, ids }
    }

    /// Takes over every triangle that the ray meets nearer than `best`, or as near with a lower
    /// number.
    #[inline(always)]
    pub(super) fn closest<V: F32x8>(&self, ray: &Ray, sheared: &ShearedRay, best: &mut Hit) {
        let mut passed = self.pass_inside::<V>(sheared, best.t as f32 * PADDING);
        while passed != 0 {
            let lane = passed.trailing_zeros() as usize;
            passed &= passed - 1;
            let hit = Hit {
                t: plane_distance(ray, self.triangle(lane)),
                primitive: self.ids[lane],
            };
            if hit.t > 0.0 && hit.primitive != ray.exclude && is_before(&hit, best) {
                *best = hit;
            }
        }
    }

    /// Whether the ray meets any of the triangles in its interval.
    #[inline(always)]
    pub(super) fn occludes<V: F32x8>(&self, ray: &Ray, sheared: &ShearedRay) -> bool {
        let mut passed = self.pass_inside::<V>(sheared, ray.t_max * PADDING);
        while passed != 0 {
            let lane = passed.trailing_zeros() as usize;
            passed &= passed - 1;
            let t = plane_distance(ray, self.triangle(lane));
            if t > 0.0 && t < f64::from(ray.t_max) && self.ids[lane] != ray.exclude {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn triangle(&self, lane: usize) -> [Vec3; 3] {
        let [a, b, c] = &self.corners;
        let corner = |[x, y, z]: &[[f32; WIDTH]; 3]| Vec3::new(x[lane], y[lane], z[lane]);
        [corner(a), corner(b), corner(c)]
    }

    /// A bit for each triangle that the ray's line passes through, if its corners do not all lie
    /// behind the ray's start or beyond `limit`.
    ///
    /// The edge functions of Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection"
    /// (JCGT 2(1)): those of neighbours are exact negatives of each other, so a line cannot pass
    /// between them. Zero counts as inside. The method's distance is only as good as the largest
    /// coordinate of the triangle, so that is left to [`plane_distance`].
    #[inline(always)]
    fn pass_inside<V: F32x8>(&self, ray: &ShearedRay, limit: f32) -> u32 {
        let (ax, ay, at) = ray.shear::<V>(&self.corners[0]);
        let (bx, by, bt) = ray.shear::<V>(&self.corners[1]);
        let (cx, cy, ct) = ray.shear::<V>(&self.corners[2]);
        let edge_a = cx.mul(by).sub(cy.mul(bx));
        let edge_b = ax.mul(cy).sub(ay.mul(cx));
        let edge_c = bx.mul(ay).sub(by.mul(ax));

        let zero = V::splat(0.0);
        let least = edge_a.min(edge_b).min(edge_c);
        let most = edge_a.max(edge_b).max(edge_c);
        // All three zero: the line lies in the triangle's plane, and does not pass through it.
        let not_flat = least.lt(most) | zero.lt(least) | most.lt(zero);
        let in_reach = zero.lt(at.max(bt).max(ct)) & at.min(bt).min(ct).le(V::splat(limit));
        (zero.le(least) | most.le(zero)) & not_flat & in_reach
    }
}

/// Whether `hit` is nearer than `other`; at the same distance, to single precision, the lower
/// number is.
#[inline(always)]
pub(super) fn is_before(hit: &Hit, other: &Hit) -> bool {
    let (t, other_t) = (hit.t as f32, other.t as f32);
    t < other_t || (t == other_t && hit.primitive < other.primitive)
}

/// A ray in the space where it runs along +Z from the origin: axes permuted so that its largest
/// component is z, then sheared.
pub(super) struct ShearedRay {
    axes: [usize; 3],
    /// The origin, in permuted axes.
    origin: [f32; 3],
    /// The slopes of x and y against z.
    slopes: [f32; 2],
    /// How much further along the ray one unit of z is.
    stretch: f32,
}

impl ShearedRay {
    pub(super) fn new(ray: &Ray) -> ShearedRay {
        let size = ray.direction.abs();
        let kz = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
        let d = ray.direction;
        let o = ray.origin;
        // A slope so small that its products with lengths underflow would turn a ray inside a
        // triangle's plane into noise.
        let slope = |k: usize| {
            let slope = d[k] / d[kz];
            if slope.abs() < 1e-25 { 0.0 } else { slope }
        };
        ShearedRay {
            axes: [kx, ky, kz],
            origin: [o[kx], o[ky], o[kz]],
            slopes: [slope(kx), slope(ky)],
            stretch: 1.0 / d[kz],
        }
    }

    /// Eight points, seen along the ray: x, y, and the ray parameter at their z.
    #[inline(always)]
    fn shear<V: F32x8>(&self, points: &[[f32; WIDTH]; 3]) -> (V, V, V) {
        // Spelled out: code in closures would not be compiled for the vector instructions.
        let [kx, ky, kz] = self.axes;
        let (x, y, z) = (
            V::load(&points[kx]),
            V::load(&points[ky]),
            V::load(&points[kz]),
        );
        let [ox, oy, oz] = self.origin;
        let (ox, oy, oz) = (V::splat(ox), V::splat(oy), V::splat(oz));
        let (sx, sy) = (V::splat(self.slopes[0]), V::splat(self.slopes[1]));
        let z = z.sub(oz);
        let t = z.mul(V::splat(self.stretch));
        (x.sub(ox).sub(sx.mul(z)), y.sub(oy).sub(sy.mul(z)), t)
    }
}
