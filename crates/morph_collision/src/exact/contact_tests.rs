//! Where triangles meet, for figures that can be drawn on squared paper.

use glam::DVec3;

use super::{Segment, Triangle, triangle_contact, unit_normal};

/// In the plane of the paper.
fn flat(corners: [[f64; 2]; 3]) -> Triangle {
    corners.map(|[x, y]| DVec3::new(x, y, 0.0))
}

/// The segment, in either order of the triangles.
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

/// Each has a corner in the other, nearer to the crossings than the other ends of the sides.
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
fn the_normal_of_a_triangle_of_any_size_has_length_one() {
    for size in [1e-300, 1e-200, 1.0, 1e200, 1e300] {
        let triangle = flat([[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]]).map(|corner| corner * size);
        assert_eq!(unit_normal(&triangle), DVec3::Z, "{size:e}");
    }
    assert_eq!(unit_normal(&[DVec3::ONE; 3]), DVec3::ZERO);
}
