//! Every intersecting pair of triangles of two bodies.

use std::ops::ControlFlow;

use glam::DVec3;

use super::certain::certainly;
use super::triangles_intersect;

/// All pairs `(triangle of a, triangle of b)` that share a point, in ascending order.
///
/// Vertices are in world space. Every pair whose `f64` boxes overlap is decided exactly, in integers unless error-bounded
/// `f64` arithmetic is certain. Boxes are compared by their coordinates, which is exact too. Takes quadratic time, except
/// for a sort along x.
///
/// # Panics
///
/// If a triangle names a vertex that does not exist.
pub fn intersecting_pairs(
    a: &[DVec3],
    a_triangles: &[[u32; 3]],
    b: &[DVec3],
    b_triangles: &[[u32; 3]],
) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    visit_intersecting_pairs(a, a_triangles, b, b_triangles, |of_a, of_b| {
        pairs.push((of_a, of_b));
        ControlFlow::Continue(())
    });
    pairs.sort_unstable();
    pairs
}

/// Like [`intersecting_pairs`], in any order, until `found` breaks.
pub(crate) fn visit_intersecting_pairs(
    a: &[DVec3],
    a_triangles: &[[u32; 3]],
    b: &[DVec3],
    b_triangles: &[[u32; 3]],
    mut found: impl FnMut(u32, u32) -> ControlFlow<()>,
) {
    let boxed_a = boxed_triangles(a, a_triangles);
    let mut boxed_b = boxed_triangles(b, b_triangles);
    boxed_b.sort_by(|p, q| p.min.x.total_cmp(&q.min.x));

    // The largest x coordinate of each triangle of `b` and all before it.
    let mut reach = f64::NEG_INFINITY;
    let reaches: Vec<f64> = boxed_b
        .iter()
        .map(|triangle| {
            reach = reach.max(triangle.max.x);
            reach
        })
        .collect();

    for triangle_a in &boxed_a {
        // Triangles of `b` before `first` end before this one starts; those from `end` on start beyond its end.
        let first = reaches.partition_point(|reach| *reach < triangle_a.min.x);
        let end = boxed_b.partition_point(|triangle_b| triangle_b.min.x <= triangle_a.max.x);
        for triangle_b in boxed_b.get(first..end).unwrap_or_default() {
            if triangle_a.box_overlaps(triangle_b)
                && triangle_a.meets(triangle_b)
                && found(triangle_a.index, triangle_b.index).is_break()
            {
                return;
            }
        }
    }
}

/// A triangle's index and vertices with their bounding box.
struct BoxedTriangle {
    index: u32,
    vertices: [DVec3; 3],
    min: DVec3,
    max: DVec3,
}

impl BoxedTriangle {
    /// Boxes are closed: touching counts as overlapping.
    fn box_overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    fn meets(&self, other: &Self) -> bool {
        certainly(&self.vertices, &other.vertices)
            .unwrap_or_else(|| triangles_intersect(&self.vertices, &other.vertices))
    }
}

/// Skips triangles with a coordinate that is not finite, because they intersect nothing.
fn boxed_triangles(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Vec<BoxedTriangle> {
    (0u32..)
        .zip(triangles)
        .map(|(index, corners)| {
            let [p, q, r] = corners.map(|corner| vertices[corner as usize]);
            BoxedTriangle {
                index,
                vertices: [p, q, r],
                min: p.min(q).min(r),
                max: p.max(q).max(r),
            }
        })
        .filter(|triangle| triangle.vertices.iter().all(|vertex| vertex.is_finite()))
        .collect()
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    fn soup(rng: &mut Pcg64Mcg, count: u32, size: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let mut vertices = Vec::new();
        for _ in 0..count {
            let mut point = || DVec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
            let centre = point();
            vertices.extend((0..3).map(|_| centre + point() * size));
        }
        (vertices, (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
    }

    #[test]
    fn boxes_and_sorting_lose_no_pair() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut found = 0;
        for _ in 0..10 {
            let (a, a_triangles) = soup(&mut rng, 30, 0.8);
            let (b, b_triangles) = soup(&mut rng, 40, 0.6);
            let mut expected = Vec::new();
            for i in 0..30usize {
                for j in 0..40usize {
                    let triangle = |v: &[DVec3], t: usize| [v[3 * t], v[3 * t + 1], v[3 * t + 2]];
                    if triangles_intersect(&triangle(&a, i), &triangle(&b, j)) {
                        expected.push((i as u32, j as u32));
                    }
                }
            }
            found += expected.len();
            assert_eq!(intersecting_pairs(&a, &a_triangles, &b, &b_triangles), expected);
        }
        assert!(found > 100, "{found} pairs try nothing");
    }

    #[test]
    fn a_triangle_that_is_not_finite_meets_nothing() {
        let a = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(f64::NAN, 0.0, 0.0)];
        let pairs = intersecting_pairs(&a, &[[0, 1, 3], [0, 1, 2]], &a, &[[3, 3, 3], [2, 1, 0]]);
        assert_eq!(pairs, [(1, 1)]);
    }
}
