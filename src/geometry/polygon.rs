//! Triangulation of planar polygons.

use glam::{DVec2, DVec3};

/// Ear clipping takes time quadratic in the number of vertices, in the worst case cubic.
const MAX_VERTICES: usize = 1024;

/// Triangles whose area is below this fraction of the polygon's may be wound the wrong way: they are invisible,
/// and collinear vertices often cause them.
const NEGLIGIBLE: f64 = 1e-6;

/// Triangulates a polygon of three vertices or more, keeping its winding: as a fan around the first vertex if that
/// covers it, else by ear clipping (Meisters 1975, "Polygons have ears"). Vertices need not be coplanar.
///
/// None for polygons that intersect themselves, and for concave ones of more than 1024 vertices.
pub fn triangulate(vertices: &[DVec3]) -> Option<Vec<[usize; 3]>> {
    let fan = fan(vertices.len());
    if fan.len() == 1 {
        return Some(fan);
    }
    let flat = projected(vertices);
    let area = |[a, b, c]: [usize; 3]| (flat[b] - flat[a]).perp_dot(flat[c] - flat[a]);
    let whole: f64 = fan.iter().map(|&triangle| area(triangle).abs()).sum();
    let is_wound = |triangle| area(triangle) >= -NEGLIGIBLE * whole;
    if fan.iter().all(|&triangle| is_wound(triangle)) {
        return Some(fan);
    }
    if flat.len() > MAX_VERTICES {
        return None;
    }
    let is_inside = |p: usize, [a, b, c]: [usize; 3]| {
        area([a, b, p]) > 0.0 && area([b, c, p]) > 0.0 && area([c, a, p]) > 0.0
    };
    let mut left: Vec<usize> = (0..flat.len()).collect();
    let mut triangles = Vec::new();
    let mut at = 0;
    while left.len() > 3 {
        let count = left.len();
        let triangle = |i: usize| [i, i + 1, i + 2].map(|i| left[i % count]);
        let ear = (at..at + count)
            .find(|&i| is_wound(triangle(i)) && !left.iter().any(|&p| is_inside(p, triangle(i))))?;
        triangles.push(triangle(ear));
        left.remove((ear + 1) % count);
        at = ear;
    }
    let last = [left[0], left[1], left[2]];
    triangles.push(last);
    is_wound(last).then_some(triangles)
}

/// The triangles of a fan around the first of `vertices` vertices.
pub fn fan(vertices: usize) -> Vec<[usize; 3]> {
    (2..vertices).map(|i| [0, i - 1, i]).collect()
}

/// The vertices projected along their mean normal, so that they run counter-clockwise.
fn projected(vertices: &[DVec3]) -> Vec<DVec2> {
    let from = |p: DVec3| p - vertices[0];
    let normal: DVec3 = vertices
        .windows(2)
        .map(|pair| from(pair[0]).cross(from(pair[1])))
        .sum();
    let (right, up) = normal.normalize_or(DVec3::Z).any_orthonormal_pair();
    let flat = |p: DVec3| DVec2::new(p.dot(right), p.dot(up));
    vertices.iter().map(|&p| flat(from(p))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(vertices: &[DVec3], triangles: &[[usize; 3]]) -> DVec3 {
        let doubled = |[a, b, c]: &[usize; 3]| {
            (vertices[*b] - vertices[*a]).cross(vertices[*c] - vertices[*a])
        };
        triangles.iter().map(doubled).sum::<DVec3>() * 0.5
    }

    #[test]
    fn convex_polygons_become_fans() {
        let pentagon = [(0, 0), (2, 0), (3, 1), (1, 3), (0, 1)]
            .map(|(x, y)| DVec3::new(f64::from(x), f64::from(y), 5.0));
        let fan = Some(vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(triangulate(&pentagon), fan);
        // Seen from behind, and tilted.
        let turned = pentagon.map(|p| DVec3::new(p.y, p.x, p.z));
        assert_eq!(triangulate(&turned), fan);
        assert_eq!(
            triangulate(&pentagon.map(|p| DVec3::new(p.y, p.x + p.y, p.x))),
            fan
        );
    }

    #[test]
    fn concave_polygons_are_cut_inside() {
        // An arrow head whose first vertex does not see the third, and a comb.
        let arrow = vec![(0.0, 0.0), (2.0, -1.0), (1.0, 0.0), (2.0, 1.0)];
        let mut comb = vec![(20.5, -1.0)];
        for tooth in 0..10 {
            let x = f64::from(tooth);
            comb.extend([(20.0 - 2.0 * x, 5.0), (19.0 - 2.0 * x, 0.0)]);
        }
        comb.push((0.0, -1.0));
        for outline in [arrow, comb] {
            for turn in 0..outline.len() {
                let mut vertices: Vec<DVec3> = outline
                    .iter()
                    .map(|&(x, y)| DVec3::new(x, 0.0, y))
                    .collect();
                vertices.rotate_left(turn);
                let triangles = triangulate(&vertices).expect("cut");
                assert_eq!(triangles.len(), vertices.len() - 2);
                // They cover the polygon once: none is wound the other way.
                let single = triangles.iter().map(|&t| area(&vertices, &[t]).length());
                let whole = area(&vertices, &triangles).length();
                assert!((single.sum::<f64>() - whole).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn crossed_polygons_have_no_triangles() {
        let bow_tie =
            [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 3.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        assert_eq!(triangulate(&bow_tie), None);
        assert_eq!(
            triangulate(&[DVec3::ONE; 4]),
            Some(vec![[0, 1, 2], [0, 2, 3]])
        );
    }
}
