use super::WIDTH;
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
        let mut passed = self.pass_inside::<V>(sheared);
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
        let mut passed = self.pass_inside::<V>(sheared);
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

    fn triangle(&self, lane: usize) -> [Vec3; 3] {
        self.corners.map(|[x, y, z]| Vec3::new(x[lane], y[lane], z[lane]))
    }

    /// A bit for each triangle that the ray's line passes through.
    ///
    /// The edge functions of Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection"
    /// (JCGT 2(1)): those of neighbours are exact negatives of each other, so a line cannot pass
    /// between them. Zero counts as inside. The method's distance is only as good as the largest
    /// coordinate of the triangle, so that is left to [`plane_distance`].
    #[inline(always)]
    fn pass_inside<V: F32x8>(&self, ray: &ShearedRay) -> u32 {
        let [kx, ky, kz] = ray.axes;
        let shear_x = V::splat(ray.shear[0]);
        let shear_y = V::splat(ray.shear[1]);
        let sheared = |corner: &[[f32; WIDTH]; 3]| {
            let z = V::load(&corner[kz]).sub(V::splat(ray.origin[2]));
            let x = V::load(&corner[kx]).sub(V::splat(ray.origin[0])).sub(shear_x.mul(z));
            let y = V::load(&corner[ky]).sub(V::splat(ray.origin[1])).sub(shear_y.mul(z));
            (x, y)
        };
        let (ax, ay) = sheared(&self.corners[0]);
        let (bx, by) = sheared(&self.corners[1]);
        let (cx, cy) = sheared(&self.corners[2]);
        let edge_a = cx.mul(by).sub(cy.mul(bx));
        let edge_b = ax.mul(cy).sub(ay.mul(cx));
        let edge_c = bx.mul(ay).sub(by.mul(ax));

        let zero = V::splat(0.0);
        let least = edge_a.min(edge_b).min(edge_c);
        let most = edge_a.max(edge_b).max(edge_c);
        // All three zero: the line lies in the triangle's plane, and does not pass through it.
        let not_flat = least.lt(most) | zero.lt(least) | most.lt(zero);
        (zero.le(least) | most.le(zero)) & not_flat
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
    shear: [f32; 2],
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
            shear: [slope(kx), slope(ky)],
        }
    }
}
