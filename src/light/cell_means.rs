//! Means of a bilinearly interpolated image over the cells of a coarser or finer grid.

/// How far a cell reaches into its neighbours, in cells: more than rounding may move a point at its edge.
const MARGIN: f64 = 0.01;

/// The mean of an image over each cell of a grid of `columns` and `rows`, row by row, both from the upper left: exact for
/// the bilinear interpolation of the image, so that it is 0 only where this is.
///
/// `texel` gives the image, of `width` and `height`, by its column and row. It wraps to the sides and continues its
/// first and last row beyond them.
pub(super) fn cell_means(
    [columns, rows]: [usize; 2],
    [width, height]: [usize; 2],
    texel: impl Fn(usize, usize) -> f64,
) -> Vec<f64> {
    let wrapped = |column: isize| column.rem_euclid(width as isize) as usize;
    let clamped = |row: isize| row.clamp(0, height as isize - 1) as usize;
    let across: Vec<Vec<(usize, f64)>> = (0..columns)
        .map(|cell| weights(cell, columns, width, wrapped))
        .collect();
    let mut means = Vec::with_capacity(columns * rows);
    for cell in 0..rows {
        let mut row = vec![0.0; width];
        for (y, weight) in weights(cell, rows, height, clamped) {
            for (x, sum) in row.iter_mut().enumerate() {
                *sum += weight * texel(x, y);
            }
        }
        let mean =
            |across: &Vec<(usize, f64)>| across.iter().map(|(x, w)| w * row[*x]).sum::<f64>();
        means.extend(across.iter().map(mean));
    }
    means
}

/// The weights of a row's texels in the mean over one of its cells, by `place`, which takes positions in the row to
/// texels.
fn weights(
    cell: usize,
    cells: usize,
    texels: usize,
    place: impl Fn(isize) -> usize,
) -> Vec<(usize, f64)> {
    // In texels from the centre of the first one.
    let position = |edge: f64| edge / cells as f64 * texels as f64 - 0.5;
    let start = position(cell as f64 - MARGIN);
    let end = position(cell as f64 + 1.0 + MARGIN);
    let positions = start.floor() as isize..=end.ceil() as isize;
    positions
        .map(|at| {
            let share = tent_until(end - at as f64) - tent_until(start - at as f64);
            (place(at), share / (end - start))
        })
        .collect()
}

/// The integral up to `x` of the tent of height 1 from -1 to 1: a texel's weight in linear interpolation.
fn tent_until(x: f64) -> f64 {
    let outside = (1.0 - x.abs()).max(0.0);
    let tail = 0.5 * outside * outside;
    if x < 0.0 { tail } else { 1.0 - tail }
}
