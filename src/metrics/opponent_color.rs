//! Colour spaces of the eye's opponent channels: YCxCz (Zhang and Wandell 1997, "A Spatial Extension of CIELAB for
//! Digital Color-Image Reproduction") and CIELAB.

use glam::{DMat3, DVec3};

/// From linear sRGB to CIE XYZ: the primaries and the white D65 of IEC 61966-2-1.
pub(super) fn rgb_to_xyz() -> DMat3 {
    DMat3::from_cols(
        DVec3::new(
            10_135_552.0 / 24_577_794.0,
            2_613_072.0 / 12_288_897.0,
            1_425_312.0 / 73_733_382.0,
        ),
        DVec3::new(
            8_788_810.0 / 24_577_794.0,
            8_788_810.0 / 12_288_897.0,
            8_788_810.0 / 73_733_382.0,
        ),
        DVec3::new(
            4_435_075.0 / 24_577_794.0,
            887_015.0 / 12_288_897.0,
            70_074_185.0 / 73_733_382.0,
        ),
    )
}

/// YCxCz of XYZ relative to white.
pub(super) fn opponent(xyz: DVec3) -> DVec3 {
    DVec3::new(
        116.0 * xyz.y - 16.0,
        500.0 * (xyz.x - xyz.y),
        200.0 * (xyz.y - xyz.z),
    )
}

/// XYZ relative to white of YCxCz.
pub(super) fn from_opponent(color: DVec3) -> DVec3 {
    let y = (color.x + 16.0) / 116.0;
    DVec3::new(y + color.y / 500.0, y, y - color.z / 200.0)
}

/// CIELAB of XYZ relative to white, with a and b in proportion to L.
pub(super) fn hunt_lab(xyz: DVec3) -> DVec3 {
    const DELTA: f64 = 6.0 / 29.0;
    let lab = opponent(xyz.map(|t| {
        if t > DELTA.powi(3) {
            libm::cbrt(t)
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    }));
    let scale = 0.01 * lab.x;
    DVec3::new(lab.x, scale * lab.y, scale * lab.z)
}
