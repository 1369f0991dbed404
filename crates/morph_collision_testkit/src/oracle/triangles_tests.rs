//! Hand-made triangles of every kind, and random ones whose construction determines the answer.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::*;

const PERMUTATIONS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

fn triangle(vertices: [[f64; 3]; 3]) -> [DVec3; 3] {
    vertices.map(DVec3::from_array)
}

/// The answer, after checking that it depends neither on the order of the triangles nor on that of their
/// vertices.
fn intersect(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> bool {
    intersect_in_any_order(&triangle(a), &triangle(b))
}

fn intersect_in_any_order(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let answer = triangles_intersect(a, b);
    for order_a in PERMUTATIONS {
        for order_b in PERMUTATIONS {
            let (a, b) = (order_a.map(|i| a[i]), order_b.map(|i| b[i]));
            assert_eq!(triangles_intersect(&a, &b), answer, "{a:?} {b:?}");
            assert_eq!(triangles_intersect(&b, &a), answer, "{b:?} {a:?}");
        }
    }
    answer
}

/// In the plane z = 0.
const FLOOR: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

/// A triangle in the plane z = 0 with these corners.
fn flat(corners: [[f64; 2]; 3]) -> [[f64; 3]; 3] {
    corners.map(|[x, y]| [x, y, 0.0])
}

#[test]
fn crossing_triangles_meet() {
    assert!(intersect(FLOOR, [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]]));
    // Interlocked: each pierces the other once.
    assert!(intersect(FLOOR, [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [-9.0, 1.0, 0.5]]));
}

#[test]
fn triangles_apart_do_not_meet() {
    assert!(!intersect(FLOOR, [[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [0.0, 4.0, 1.0]]));
    // Crosses the plane, but outside.
    assert!(!intersect(FLOOR, [[3.0, 3.0, -1.0], [3.0, 3.0, 1.0], [9.0, 9.0, 1.0]]));
    // Each crosses the other's plane, and only edges separate them.
    assert!(!intersect(
        FLOOR,
        [[2.0, -1.0, 0.5], [2.0, 1.0, 3.0], [2.0, -9.0, -9.0]]
    ));
}

#[test]
fn a_vertex_that_touches_counts() {
    assert!(intersect(FLOOR, [[0.0, 0.0, 0.0], [-1.0, 0.0, 1.0], [0.0, -1.0, 1.0]])); // vertex on vertex
    assert!(intersect(FLOOR, [[2.0, 2.0, 0.0], [3.0, 3.0, 1.0], [3.0, 2.5, 1.0]])); // vertex on edge
    assert!(intersect(FLOOR, [[1.0, 1.0, 0.0], [3.0, 3.0, 1.0], [3.0, 2.5, 1.0]])); // vertex on face
}

#[test]
fn an_edge_that_touches_counts() {
    assert!(intersect(FLOOR, [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, -1.0, 5.0]])); // shared edge
    assert!(intersect(FLOOR, [[2.0, 0.0, -1.0], [2.0, 0.0, 1.0], [2.0, -1.0, 0.0]])); // edge crosses edge
    assert!(intersect(FLOOR, [[1.0, 1.0, 0.0], [9.0, 1.0, 0.0], [1.0, 1.0, 1.0]])); // edge lies in the face
}

#[test]
fn coplanar_triangles_meet_where_they_overlap_touch_or_contain() {
    assert!(intersect(FLOOR, FLOOR));
    assert!(intersect(FLOOR, flat([[1.0, 1.0], [5.0, 1.0], [1.0, 5.0]]))); // overlap
    assert!(intersect(FLOOR, flat([[0.5, 0.5], [1.0, 0.5], [0.5, 1.0]]))); // contained
    assert!(intersect(flat([[-9.0, -9.0], [30.0, -9.0], [-9.0, 30.0]]), FLOOR)); // containing
    assert!(intersect(FLOOR, flat([[-1.0, 1.0], [5.0, 1.0], [2.0, 1.5]]))); // a bar across: no vertex inside
    assert!(intersect(FLOOR, flat([[4.0, 0.0], [5.0, 0.0], [5.0, 1.0]]))); // at a vertex
    assert!(intersect(FLOOR, flat([[3.0, 1.0], [1.0, 3.0], [4.0, 4.0]]))); // along an edge
}

#[test]
fn coplanar_triangles_apart_do_not_meet() {
    assert!(!intersect(FLOOR, flat([[5.0, 0.0], [6.0, 0.0], [5.0, 1.0]])));
    assert!(!intersect(FLOOR, flat([[3.0, 2.0], [4.0, 2.0], [3.0, 4.0]])));
    let tilted = |corners: [[f64; 2]; 3]| corners.map(|[x, y]| [x, y, 3.0 * x - 7.0 * y + 1.0]);
    assert!(!intersect(
        tilted([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]]),
        tilted([[3.0, 2.0], [4.0, 2.0], [3.0, 4.0]])
    ));
}

#[test]
fn segments_and_points_posing_as_triangles_are_what_they_are() {
    let segment = |p: [f64; 3], q: [f64; 3]| [p, q, p];
    let point = |p: [f64; 3]| [p, p, p];
    assert!(intersect(FLOOR, segment([1.0, 1.0, -1.0], [1.0, 1.0, 1.0])));
    assert!(!intersect(FLOOR, segment([1.0, 1.0, 0.5], [1.0, 1.0, 1.0])));
    assert!(!intersect(FLOOR, segment([3.0, 3.0, -1.0], [3.0, 3.0, 1.0])));
    assert!(intersect(FLOOR, segment([-1.0, 1.0, 0.0], [9.0, 1.0, 0.0])));
    assert!(!intersect(FLOOR, segment([-1.0, 5.0, 0.0], [9.0, 5.0, 0.0])));
    assert!(intersect(FLOOR, point([1.0, 1.0, 0.0])));
    assert!(!intersect(FLOOR, point([3.0, 3.0, 0.0])));
    assert!(!intersect(FLOOR, point([1.0, 1.0, 1e-300])));
    // A segment with its third vertex inside it.
    assert!(intersect(
        [[0.0; 3], [1.0, 1.0, 1.0], [4.0, 4.0, 4.0]],
        point([3.0, 3.0, 3.0])
    ));
    assert!(intersect(
        segment([0.0; 3], [2.0, 2.0, 2.0]),
        segment([2.0, 0.0, 0.0], [0.0, 2.0, 2.0])
    ));
    assert!(!intersect(
        segment([0.0; 3], [2.0, 2.0, 2.0]),
        segment([2.0, 0.0, 0.0], [0.0, 2.0, 2.5])
    ));
    assert!(intersect(
        segment([0.0; 3], [2.0, 0.0, 0.0]),
        segment([2.0, 0.0, 0.0], [3.0, 0.0, 0.0])
    ));
    assert!(!intersect(
        segment([0.0; 3], [2.0, 0.0, 0.0]),
        segment([2.5, 0.0, 0.0], [3.0, 0.0, 0.0])
    ));
    assert!(intersect(point([0.1, 0.2, 0.3]), point([0.1, 0.2, 0.3])));
    assert!(!intersect(point([0.1, 0.2, 0.3]), point([0.1, 0.2, 0.3f64.next_up()])));
}

#[test]
fn a_gap_of_one_ulp_is_a_gap() {
    let tip = |height: f64| [[1.0, 1.0, height], [1.0, 2.0, 7.0], [2.0, 1.0, 7.0]];
    let ceiling = |height: f64| FLOOR.map(|[x, y, _]| [x, y, height]);
    for height in [0.1, 1.0, 1e-9, 12345.678, 1e200] {
        assert!(intersect(ceiling(height), tip(height)));
        assert_eq!(intersect(ceiling(height), tip(height.next_up())), height > 7.0);
        assert_eq!(intersect(ceiling(height), tip(height.next_down())), height <= 7.0);
    }
    // Beside the slanted edge x + y = 4 of the floor, within its plane.
    assert!(intersect(FLOOR, flat([[1.5, 2.5], [3.0, 4.0], [4.0, 4.0]])));
    assert!(!intersect(
        FLOOR,
        flat([[1.5, 2.5f64.next_up()], [3.0, 4.0], [4.0, 4.0]])
    ));
}

#[test]
fn denormal_and_huge_coordinates_are_exact() {
    let tiny = f64::from_bits(1);
    let point = |p: [f64; 3]| [p, p, p];
    let small = FLOOR.map(|p| p.map(|coordinate| coordinate * tiny));
    assert!(intersect(small, point([tiny, tiny, 0.0])));
    assert!(intersect(small, point([2.0 * tiny, 2.0 * tiny, 0.0])));
    assert!(!intersect(small, point([3.0 * tiny, 2.0 * tiny, 0.0])));
    assert!(!intersect(small, point([tiny, tiny, tiny])));
    assert!(!intersect(FLOOR, point([1.0, 1.0, -tiny])));
    assert!(!intersect(FLOOR, point([1e308, 1.0, tiny])));
    let huge = FLOOR.map(|p| p.map(|coordinate| coordinate * 4e307));
    assert!(intersect(
        huge,
        [[1e307, 1e307, -tiny], [1e307, 1e307, tiny], [1e308, 1e308, tiny]]
    ));
    assert!(!intersect(
        huge,
        [[1e307, 1e307, tiny], [1e307, 1e307, 1e308], [1e308, 1e308, tiny]]
    ));
}

#[test]
fn what_is_not_finite_meets_nothing() {
    let a = triangle(FLOOR);
    assert!(!triangles_intersect(&a, &[a[0], a[1], DVec3::splat(f64::NAN)]));
    assert!(!triangles_intersect(&[a[0], a[1], DVec3::splat(f64::INFINITY)], &a));
}

#[test]
fn every_f64_is_its_mantissa_times_a_power_of_two() {
    for value in [
        1.0,
        -0.1,
        6.0,
        f64::MIN_POSITIVE,
        3e-310,
        f64::from_bits(1),
        f64::MAX,
        0.0,
    ] {
        let (mantissa, exponent) = mantissa_and_exponent(value);
        // In two steps, because 2^-1074 alone is a denormal; and 2^971 times a mantissa does not overflow.
        let half = exponent / 2;
        assert_eq!(mantissa as f64 * 2f64.powi(half) * 2f64.powi(exponent - half), value);
        assert!(mantissa % 2 != 0 || value == 0.0);
    }
}

/// A triangle on a small grid, so that degenerate, coplanar and touching cases are common.
fn grid_triangle(rng: &mut Pcg64Mcg, size: i32) -> [DVec3; 3] {
    from_fn(|_| DVec3::from_array(from_fn(|_| f64::from(rng.random_range(-size..=size)))))
}

#[test]
fn triangles_built_around_a_common_point_meet() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    for size in [1, 2, 5, 1000] {
        for _ in 0..50 {
            // All coordinates are multiples of 1/4 below 2^20, so every step here is exact.
            let a = grid_triangle(&mut rng, size);
            let mut b = grid_triangle(&mut rng, size);
            let common = (a[0] + a[1] + 2.0 * a[2]) / 4.0;
            b[2] = (4.0 * common - b[0] - b[1]) / 2.0;
            assert!(intersect_in_any_order(&a, &b), "{a:?} {b:?}");
        }
    }
}

#[test]
fn triangles_on_two_sides_of_a_slab_do_not_meet() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut tried = 0;
    while tried < 200 {
        let (a, b) = (grid_triangle(&mut rng, 3), grid_triangle(&mut rng, 3));
        let [normal, ..] = grid_triangle(&mut rng, 3);
        let highest = a.iter().map(|p| normal.dot(*p)).fold(f64::MIN, f64::max);
        if b.iter().all(|p| normal.dot(*p) > highest) {
            assert!(!intersect_in_any_order(&a, &b), "{a:?} {b:?}");
            tried += 1;
        }
    }
}

#[test]
fn turning_pairs_away_early_changes_no_answer() {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    let (mut meeting, mut apart) = (0, 0);
    for size in [1, 2, 3] {
        for _ in 0..400 {
            let (a, b) = to_integers(&grid_triangle(&mut rng, size), &grid_triangle(&mut rng, size));
            let (meet, turned_away) = (hulls_meet(&a, &b), separated(&a, &b));
            assert!(!(meet && turned_away), "{a:?} {b:?}");
            // For non-degenerate triangles these directions are all that can separate, so both methods must
            // agree.
            let proper = |t: &[Vector; 3]| !is_zero(&cross(&edges(t)[0], &edges(t)[1]));
            if proper(&a) && proper(&b) {
                assert_eq!(meet, !turned_away, "{a:?} {b:?}");
            }
            *if meet { &mut meeting } else { &mut apart } += 1;
        }
    }
    assert!(meeting > 100 && apart > 100, "{meeting} meeting, {apart} apart");
}
