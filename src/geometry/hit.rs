/// Where a ray meets a primitive: just enough to work out the surface once, for the nearest hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray parameter, in lengths of the ray's direction; above 0. In double precision, so
    /// that the point it stands for is as exact as single precision can write it.
    pub t: f64,
    /// The primitive: triangles are numbered first, spheres after them.
    pub primitive: u32,
}
