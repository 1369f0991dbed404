//! Motions whose first time of contact can be computed by hand.

use morph_collision_testkit::motion::{PointMotion, Root, edge_edge, vertex_face};

const FACE: [[f64; 3]; 3] = [[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]];

fn still(position: [f64; 3]) -> PointMotion {
    [position; 2]
}

/// A vertex that moves from one place to another, and a face that stays.
fn against_face(start: [f64; 3], end: [f64; 3]) -> Option<Root> {
    let [a, b, c] = FACE.map(still);
    vertex_face([[start, end], a, b, c])
}

fn is_exactly(contact: Option<Root>, time: f64) -> bool {
    contact.is_some_and(|contact| contact.cmp_f64(time).is_eq())
}

/// Whether the contact is strictly between a number and the next one.
fn is_just_above(contact: Option<Root>, time: f64) -> bool {
    contact.is_some_and(|contact| contact.cmp_f64(time).is_gt() && contact.cmp_f64(time.next_up()).is_lt())
}

#[test]
fn a_vertex_that_falls_through_a_face_touches_it_when_it_is_level() {
    assert!(is_exactly(against_face([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]), 0.5));
    assert!(is_exactly(against_face([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]), 0.75));
    // A third is no f64. The nearest is less.
    assert!(is_just_above(
        against_face([0.0, 0.0, 1.0], [0.0, 0.0, -2.0]),
        1.0 / 3.0
    ));
    assert!(against_face([0.0, 0.0, 1.0], [0.0, 0.0, f64::from_bits(1)]).is_none());
    assert!(against_face([5.0, 0.0, 1.0], [5.0, 0.0, -1.0]).is_none());
}

#[test]
fn touching_at_either_end_of_the_time_counts() {
    assert!(is_exactly(against_face([0.0, 0.0, 0.0], [0.0, 0.0, -1.0]), 0.0));
    assert!(is_exactly(against_face([0.0, 0.0, 1.0], [0.0, 0.0, 0.0]), 1.0));
    assert!(is_exactly(against_face([3.0, -1.0, 1.0], [3.0, -1.0, 0.0]), 1.0));
    assert!(is_exactly(against_face([0.0; 3], [0.0; 3]), 0.0));
}

#[test]
fn a_vertex_in_the_plane_of_a_face_touches_its_boundary_first() {
    // From x = -3 to x = 1 past the edge at x = -1.
    assert!(is_exactly(against_face([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), 0.5));
    // Past the longest edge at x = 2.
    assert!(is_exactly(against_face([5.0, 0.0, 0.0], [-1.0, 0.0, 0.0]), 0.5));
    assert!(is_just_above(against_face([3.0, 0.0, 0.0], [0.0, 0.0, 0.0]), 1.0 / 3.0));
    // Only the corner at (3, -1).
    assert!(is_exactly(against_face([2.0, -2.0, 0.0], [4.0, 0.0, 0.0]), 0.5));
    assert!(against_face([2.5, -2.0, 0.0], [4.5, 0.0, 0.0]).is_none());
}

#[test]
fn irrational_times_are_exact() {
    // Across the x axis the edge is from (2t, 1) to (-1, -t), and 2t^2 = 1 when the axis is on it.
    let turning = [
        [[0.0, 0.0, 1.0], [0.0, 2.0, 1.0]],
        [[0.0, -1.0, 0.0], [0.0, -1.0, -1.0]],
    ];
    let axis = [still([-1.0, 0.0, 0.0]), still([1.0, 0.0, 0.0])];
    let edges = edge_edge([turning[0], turning[1], axis[0], axis[1]]).unwrap();
    let near = std::f64::consts::FRAC_1_SQRT_2;
    assert!(edges.is_within(near.next_down(), near.next_up()));
    assert!(edges.cmp_f64(near).is_ne());
    assert!((edges.to_f64() - near).abs() < 3e-16);
    // The same for the origin and a face with that section, and with the edge moved out of the way.
    let beside = |x: f64| turning[0].map(|[_, y, z]| [x, y, z]);
    let face = vertex_face([still([0.0; 3]), beside(-1.0), beside(1.0), turning[1]]).unwrap();
    assert_eq!(face, edges);
    assert!(vertex_face([still([0.0; 3]), beside(1.0), beside(2.0), turning[1]]).is_none());
}

#[test]
fn contacts_without_crossing_are_found() {
    // Across the x axis: from (2t - 1, 1) to (0, 1 - 2t). The end touches the axis at 1/2, but never crosses it.
    let moving = [[[0.0, -1.0, 1.0], [0.0, 1.0, 1.0]], [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]];
    let axis = [still([-1.0, 0.0, 0.0]), still([1.0, 0.0, 0.0])];
    assert!(is_exactly(edge_edge([moving[0], moving[1], axis[0], axis[1]]), 0.5));
    // A face in the plane z = (2t - 1) y, and a vertex at y = 2t - 1 at some height.
    let corner = |x: f64, y: f64| [[x, y, -y], [x, y, y]];
    let at_height = |z: f64| {
        let vertex = [[0.0, -1.0, z], [0.0, 1.0, z]];
        vertex_face([vertex, corner(-8.0, -4.0), corner(8.0, -4.0), corner(0.0, 4.0)])
    };
    assert!(is_exactly(at_height(0.0), 0.5));
    assert!(is_exactly(at_height(0.25), 0.25));
    assert!(at_height(-f64::from_bits(1)).is_none());
    assert!(
        at_height(f64::from_bits(1))
            .is_some_and(|first| first.cmp_f64(0.5).is_lt() && first.cmp_f64(0.5_f64.next_down()).is_gt())
    );
}

#[test]
fn degenerate_features_touch_as_the_segments_and_points_they_are() {
    let point = still([1.0, 0.0, 0.0]);
    let passing = [[0.0, 1.0, 0.0], [2.0, -1.0, 0.0]];
    assert!(is_exactly(vertex_face([passing, point, point, point]), 0.5));
    assert!(is_exactly(edge_edge([passing, passing, point, point]), 0.5));
    let far = still([1.0, 0.0, 5.0]);
    assert!(is_exactly(vertex_face([passing, point, far, point]), 0.5));
    assert!(is_exactly(edge_edge([passing, passing, far, point]), 0.5));
    let (near, beyond) = (still([1.0, 0.0, 1.0]), still([1.0, 0.0, 2.0]));
    assert!(vertex_face([passing, near, far, beyond]).is_none());
    assert!(edge_edge([passing, passing, near, far]).is_none());
    // A face that collapses to the origin as it moves past: the corners meet the vertex at 1/4 and part again.
    let through = |x: f64, y: f64, z: f64| [[x, y, z], [-3.0 * x, -3.0 * y, -3.0 * z]];
    let corners = [through(1.0, 0.0, 0.5), through(0.0, 1.0, 0.25), through(1.0, 1.0, 1.0)];
    assert!(is_exactly(
        vertex_face([still([0.0; 3]), corners[0], corners[1], corners[2]]),
        0.25
    ));
}

#[test]
fn parallel_edges_touch_when_they_overlap() {
    let fixed = [still([0.0, 0.0, 0.0]), still([1.0, 0.0, 0.0])];
    // On the same line, end to end at 1/3.
    let sliding = [[[2.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], [[3.0, 0.0, 0.0], [0.0, 0.0, 0.0]]];
    assert!(is_just_above(
        edge_edge([fixed[0], fixed[1], sliding[0], sliding[1]]),
        1.0 / 3.0
    ));
    // From the side, everywhere at once at 1/2; and beside each other on parallel lines.
    let falling = |x: f64, z: f64| [[x, 0.0, z], [x, 0.0, -z]];
    assert!(is_exactly(
        edge_edge([fixed[0], fixed[1], falling(0.25, 1.0), falling(0.75, 1.0)]),
        0.5
    ));
    assert!(is_exactly(
        edge_edge([fixed[0], fixed[1], falling(1.0, 1.0), falling(9.0, 1.0)]),
        0.5
    ));
    let after = 1.0_f64.next_up();
    assert!(edge_edge([fixed[0], fixed[1], falling(after, 1.0), falling(9.0, 1.0)]).is_none());
}

#[test]
fn one_unit_in_the_last_place_decides() {
    let falling = |x: f64| against_face([x, 0.0, 1.0], [x, 0.0, -1.0]);
    assert!(is_exactly(falling(-1.0), 0.5) && is_exactly(falling(2.0), 0.5));
    assert!(falling((-1.0_f64).next_down()).is_none() && falling(2.0_f64.next_up()).is_none());
    assert!(falling((-1.0_f64).next_up()).is_some() && falling(2.0_f64.next_down()).is_some());
}
