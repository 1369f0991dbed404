//! Test helpers: exact points against boxes, for tests of error bounds, and all instruction sets, for tests of single kernels.

use std::sync::OnceLock;

use fearless_simd::Level;
use glam::{DVec3, Vec3};
use morph_collision_testkit::oracle::Dyadic;

use super::{Aabb, BoxMap, Kernel};

/// The levels of [`Kernel::available`].
pub(crate) fn levels() -> &'static [Level] {
    static LEVELS: OnceLock<Vec<Level>> = OnceLock::new();
    LEVELS.get_or_init(|| Kernel::available().iter().map(|kernel| kernel.level).collect())
}

/// An exact point.
pub(crate) type ExactPoint = [Dyadic; 3];

/// The exact image of a point, times a determinant, and how far from it a body's point may be.
#[derive(Debug)]
pub(crate) struct Image {
    /// Positive.
    pub(crate) determinant: Dyadic,
    pub(crate) scaled: ExactPoint,
    /// The rows of a matrix, times the determinant, and the largest coordinates of the vectors that it maps to offsets.
    pub(crate) scaled_offset: ([ExactPoint; 3], ExactPoint),
}

impl Image {
    /// The largest offset along an axis, times the determinant.
    fn offset_along(&self, axis: usize) -> Dyadic {
        let (rows, reach) = &self.scaled_offset;
        (0..3)
            .map(|column| rows[axis][column].clone().abs() * reach[column].clone())
            .sum()
    }
}

/// The image of a point under a map with these columns.
pub(crate) fn exact_image([x, y, z, translation]: &[DVec3; 4], p: &ExactPoint) -> ExactPoint {
    std::array::from_fn(|row| {
        let products = [x, y, z]
            .into_iter()
            .zip(p)
            .map(|(column, p)| Dyadic::from(column[row]) * p.clone());
        products.sum::<Dyadic>() + Dyadic::from(translation[row])
    })
}

/// The inverse of a linear part times its determinant, and the determinant. Both are negated if the determinant is negative.
pub(crate) fn adjugate(columns: &[DVec3; 4]) -> ([ExactPoint; 3], Dyadic) {
    let m = |row: usize, column: usize| Dyadic::from(columns[column][row]);
    // Entry (row, column) is the cofactor of (column, row).
    let cofactor = |row: usize, column: usize| {
        let [r, s] = [(column + 1) % 3, (column + 2) % 3];
        let [c, d] = [(row + 1) % 3, (row + 2) % 3];
        m(r, c) * m(s, d) - m(r, d) * m(s, c)
    };
    let rows: [ExactPoint; 3] = std::array::from_fn(|row| std::array::from_fn(|column| cofactor(row, column)));
    let determinant = (0..3).map(|i| rows[0][i].clone() * m(i, 0)).sum::<Dyadic>();
    if determinant.is_negative() {
        return (rows.map(|row| row.map(|x| -x)), -determinant);
    }
    (rows, determinant)
}

/// The box of one point.
pub(crate) fn box_at(point: Vec3) -> Aabb {
    Aabb { min: point, max: point }
}

/// Whether a point is in a box or on its surface, exactly.
pub(crate) fn holds(bounds: &Aabb, point: &ExactPoint) -> bool {
    (0..3).all(|i| Dyadic::from(bounds.min[i]) <= point[i] && point[i] <= Dyadic::from(bounds.max[i]))
}

/// How far a box must be widened to hold a point; negative for a point inside.
pub(crate) fn lack(bounds: &Aabb, point: &ExactPoint) -> f64 {
    let beyond = |i: usize| {
        let below = Dyadic::from(bounds.min[i]) - point[i].clone();
        below.max(point[i].clone() - Dyadic::from(bounds.max[i])).to_f64()
    };
    (0..3).map(beyond).fold(f64::NEG_INFINITY, f64::max)
}

/// The fraction of a map's slack that the mapped box of a point needs to hold the exact image.
pub(crate) fn slack_used(map: &BoxMap, point: &Aabb, image: &Image) -> f64 {
    let mapped = map.one(point);
    let used = |i: usize| {
        let (along, offset) = (image.scaled[i].clone(), image.offset_along(i));
        let end = |end: f32| Dyadic::from(end) * image.determinant.clone();
        let room_below = along.clone() - offset.clone() - end(mapped.min[i]);
        let room = room_below.min(end(mapped.max[i]) - along - offset);
        let twice_slack = Dyadic::from(map.offset_max[i]) - Dyadic::from(map.offset_min[i]);
        1.0 - 2.0 * room.ratio(&(twice_slack * image.determinant.clone()))
    };
    (0..3).map(used).fold(f64::NEG_INFINITY, f64::max)
}
