//! Where triangles meet, for figures that you can draw on squared paper.

use glam::DVec3;
use morph_collision_testkit::near_degenerate::Family;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use super::number::power_of_two;
use super::{Segment, Triangle, closest_on_triangle, common_segment, triangle_contact, unit_normal};

/// A triangle in the xy plane.
fn flat(corners: [[f64; 2]; 3]) -> Triangle {
    corners.map(|[x, y]| DVec3::new(x, y, 0.0))
}

/// The contact segment. Checks that it is the same in either order of the triangles.
fn segment(a: &Triangle, b: &Triangle) -> Segment {
    let contact = triangle_contact(a, b).unwrap();
    assert_eq!(triangle_contact(b, a).unwrap().segment, contact.segment);
    contact.segment
}

fn assert_near(segment: Segment, expected: [[f64; 3]; 2]) {
    for (end, expected) in segment.into_iter().zip(expected) {
        assert!(end.abs_diff_eq(expected.into(), 1e-14), "{segment:?}");
    }
}

#[test]
fn a_wall_stands_in_a_floor_along_a_segment() {
    let floor = flat([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]]);
    let wall = [[1.0, 1.0, -1.0], [2.0, 1.0, -1.0], [1.0, 1.0, 1.0]].map(DVec3::from_array);
    assert_eq!(
        segment(&wall, &floor),
        [DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.5, 1.0, 0.0)]
    );
    let contact = triangle_contact(&wall, &floor).unwrap();
    assert_eq!(contact.point(), DVec3::new(1.25, 1.0, 0.0));
    assert_eq!(contact.length(), 0.5);
    // The wall faces down the y axis.
    assert!(contact.normal.abs_diff_eq(DVec3::new(0.0, 0.5, 0.5).normalize(), 1e-15));
}

#[test]
fn a_hexagon_common_to_coplanar_triangles_has_its_longest_diagonal() {
    let a = flat([[0.0, 0.0], [6.0, 0.0], [0.0, 6.0]]);
    let b = flat([[4.0, 4.0], [-2.0, 4.0], [4.0, -2.0]]);
    assert_near(segment(&a, &b), [[0.0, 4.0, 0.0], [4.0, 0.0, 0.0]]);
}

/// Each triangle has a corner in the other. It is nearer to the crossings than the other ends of its sides.
#[test]
fn a_diamond_common_to_coplanar_triangles_has_its_longest_diagonal() {
    let up = flat([[0.0, 1.0], [-16.0, -7.0], [16.0, -7.0]]);
    let down = flat([[0.0, -1.0], [16.0, 7.0], [-16.0, 7.0]]);
    assert_near(segment(&up, &down), [[-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
}

#[test]
fn triangles_that_are_segments_on_one_line_share_where_both_are() {
    let first = flat([[0.0, 0.0], [4.0, 2.0], [2.0, 1.0]]);
    let second = flat([[8.0, 4.0], [6.0, 3.0], [2.0, 1.0]]);
    let expected = [[2.0, 1.0, 0.0], [4.0, 2.0, 0.0]].map(DVec3::from_array);
    assert_eq!(segment(&first, &second), expected);
}

#[test]
fn a_triangle_with_two_equal_corners_is_a_segment() {
    let floor = flat([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]]);
    let ends = [DVec3::new(1.0, 1.0, 0.0), DVec3::new(2.0, 1.0, 0.0)];
    for corners in [[0, 0, 1], [0, 1, 0], [1, 0, 0]] {
        assert_eq!(segment(&corners.map(|end| ends[end]), &floor), ends);
    }
}

#[test]
fn triangles_that_are_crossing_segments_have_the_crossing_in_common() {
    let first = flat([[0.0, 0.0], [4.0, 4.0], [1.0, 1.0]]);
    let second = flat([[0.0, 4.0], [4.0, 0.0], [3.0, 1.0]]);
    assert_eq!(common_segment(&first, &second), Some([DVec3::new(2.0, 2.0, 0.0); 2]));
}

/// Triangles at small angles. Some of their crossings need exact arithmetic.
#[test]
fn contacts_grow_with_their_triangles() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    for family in [Family::CornerOnFace, Family::EdgeThroughEdge, Family::Slivers] {
        for _ in 0..200 {
            let [a, b] = family.pair(&mut rng);
            let contact = triangle_contact(&a, &b);
            for size in [-60, 60].map(power_of_two) {
                let grown = |triangle: &Triangle| triangle.map(|corner| corner * size);
                let segment = triangle_contact(&grown(&a), &grown(&b)).map(|contact| contact.segment);
                assert_eq!(segment, contact.map(|contact| contact.segment.map(|end| end * size)));
            }
        }
    }
}

/// Heights of edges nearly in a plane are mostly rounding, and so is the crossing that they give.
#[test]
fn contacts_at_small_angles_lie_on_both_triangles() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    for family in [Family::CornerOnFace, Family::EdgeThroughEdge, Family::Slivers] {
        for _ in 0..300 {
            let [a, b] = family.pair(&mut rng);
            let Some(contact) = triangle_contact(&a, &b) else {
                continue;
            };
            let size = a.iter().chain(&b).map(|corner| corner.length()).fold(0.0, f64::max);
            for (end, triangle) in contact.segment.iter().flat_map(|&end| [(end, &a), (end, &b)]) {
                let off = closest_on_triangle(end, triangle).squared.sqrt();
                assert!(off <= 1e-13 * size, "{off} of {size}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn the_normal_of_a_triangle_of_any_size_has_length_one() {
    for size in [1e-300, 1e-200, 1.0, 1e200, 1e300] {
        let triangle = flat([[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]]).map(|corner| corner * size);
        assert_eq!(unit_normal(&triangle), DVec3::Z, "{size:e}");
    }
    assert_eq!(unit_normal(&[DVec3::ONE; 3]), DVec3::ZERO);
}
