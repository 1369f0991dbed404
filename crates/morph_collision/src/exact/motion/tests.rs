//! Cases with known answers.

use glam::DVec3;

use super::*;

type Line = [f64; 6];

fn moving([x, y, z, u, v, w]: Line) -> MovingPoint {
    MovingPoint::new(DVec3::new(x, y, z), DVec3::new(u, v, w))
}

fn resting([x, y, z]: [f64; 3]) -> MovingPoint {
    MovingPoint::resting(DVec3::new(x, y, z))
}

fn flat_face() -> [MovingPoint; 3] {
    [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]].map(resting)
}

/// Both answers about a vertex and a face, which must agree.
fn face_time(vertex: MovingPoint, face: [MovingPoint; 3]) -> Option<TimeOfImpact> {
    let time = vertex_face_impact(vertex, face, 0.0);
    assert_eq!(vertex_face_touch(vertex, face), time.is_some(), "{vertex:?} {face:?}");
    time.inspect(is_tight)
}

fn edge_time(a: [MovingPoint; 2], b: [MovingPoint; 2]) -> Option<TimeOfImpact> {
    let time = edge_edge_impact(a, b, 0.0);
    assert_eq!(edge_edge_touch(a, b), time.is_some(), "{a:?} {b:?}");
    time.inspect(is_tight)
}

fn is_tight(time: &TimeOfImpact) {
    assert!(
        time.latest == time.earliest || time.latest == time.earliest.next_up(),
        "{time:?}"
    );
}

fn at(time: f64) -> Option<TimeOfImpact> {
    Some(TimeOfImpact {
        earliest: time,
        latest: time,
    })
}

#[test]
fn a_falling_vertex_hits_the_face_and_its_boundary_but_not_beyond() {
    let fall = |x: f64, y: f64| moving([x, y, 1.0, x, y, -3.0]);
    for (x, y) in [(1.0, 1.0), (2.0, 2.0), (0.0, 1.0), (0.0, 0.0), (4.0, 0.0), (1.0, 3.0)] {
        assert_eq!(face_time(fall(x, y), flat_face()), at(0.25));
    }
    let tiny = f64::from_bits(1);
    for (x, y) in [
        (2.0, 2.0_f64.next_up()),
        (-tiny, 1.0),
        (1.0, -tiny),
        (4.0_f64.next_up(), 0.0),
        (-tiny, -tiny),
    ] {
        assert_eq!(face_time(fall(x, y), flat_face()), None);
    }
}

#[test]
fn the_ends_of_the_motion_count() {
    assert_eq!(face_time(moving([1.0, 1.0, 5.0, 1.0, 1.0, 0.0]), flat_face()), at(1.0));
    assert_eq!(face_time(moving([1.0, 1.0, 0.0, 1.0, 1.0, 5.0]), flat_face()), at(0.0));
    let tiny = f64::from_bits(1);
    assert_eq!(face_time(moving([1.0, 1.0, 5.0, 1.0, 1.0, tiny]), flat_face()), None);
    assert_eq!(face_time(moving([1.0, 1.0, tiny, 1.0, 1.0, 5.0]), flat_face()), None);
}

#[test]
fn features_at_rest_touch_at_the_start_or_never() {
    assert_eq!(face_time(resting([1.0, 1.0, 0.0]), flat_face()), at(0.0));
    assert_eq!(face_time(resting([3.0, 3.0, 0.0]), flat_face()), None);
    assert_eq!(face_time(resting([1.0, 1.0, 1e-300]), flat_face()), None);
    let [a, b, c] = flat_face();
    assert_eq!(edge_time([a, b], [a, c]), at(0.0));
    assert_eq!(edge_time([a, b], [resting([1.0, 1e-300, 0.0]), c]), None);
}

#[test]
fn motion_in_one_plane_enters_through_the_boundary() {
    assert_eq!(
        face_time(moving([-1.0, 1.0, 0.0, 7.0, 1.0, 0.0]), flat_face()),
        at(0.125)
    );
    assert_eq!(
        face_time(moving([-1.0, 0.0, 0.0, 7.0, 0.0, 0.0]), flat_face()),
        at(0.125)
    );
    // Past a corner, and through it.
    assert_eq!(face_time(moving([5.0, -1.0, 0.0, 3.0, 1.0, 0.0]), flat_face()), at(0.5));
    assert_eq!(
        face_time(
            moving([5.0_f64.next_up(), -1.0, 0.0, 3.0_f64.next_up(), 1.0, 0.0]),
            flat_face()
        ),
        None
    );
    // Inside from the start.
    assert_eq!(face_time(moving([1.0, 1.0, 0.0, 9.0, 1.0, 0.0]), flat_face()), at(0.0));
    // The plane itself turns and moves: all points are in z = t x.
    let turned = [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0, 4.0, 0.0, 4.0],
        [0.0, 4.0, 0.0, 0.0, 4.0, 0.0],
    ];
    assert_eq!(
        face_time(moving([1.0, -1.0, 0.0, 1.0, 1.0, 1.0]), turned.map(moving)),
        at(0.5)
    );
}

#[test]
fn degenerate_faces_are_segments_and_points() {
    let segment = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 0.0, 0.0]].map(resting);
    assert_eq!(face_time(moving([3.0, -1.0, -1.0, 3.0, 1.0, 1.0]), segment), at(0.5));
    assert_eq!(face_time(moving([5.0, -1.0, -1.0, 5.0, 1.0, 1.0]), segment), None);
    assert_eq!(face_time(moving([3.0, -1.0, -1.0, 3.0, 1.0, 2.0]), segment), None);
    assert_eq!(face_time(moving([-2.0, 0.0, 0.0, 6.0, 0.0, 0.0]), segment), at(0.25));
    let point = [resting([0.0, 0.0, 0.0]); 3];
    assert_eq!(face_time(moving([-1.0, -1.0, -1.0, 3.0, 3.0, 3.0]), point), at(0.25));
    assert_eq!(face_time(moving([-1.0, -1.0, -1.0, 3.0, 3.0, 4.0]), point), None);
}

#[test]
fn a_face_that_collapses_is_hit_while_it_is_a_segment_or_point() {
    // At time 1/2 the face is the segment from the origin to (4, 0, 0), and coplanar with every point of the line.
    let folding = [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0, 4.0, 0.0, 0.0],
        [0.0, 4.0, 0.0, 0.0, -4.0, 0.0],
    ];
    let through = |x: f64, y: f64| moving([x, y, -1.0, x, y, 1.0]);
    assert_eq!(face_time(through(1.0, 0.0), folding.map(moving)), at(0.5));
    assert_eq!(face_time(through(4.0, 0.0), folding.map(moving)), at(0.5));
    assert_eq!(face_time(through(4.5, 0.0), folding.map(moving)), None);
    assert_eq!(face_time(through(1.0, f64::from_bits(1)), folding.map(moving)), None);
    // At time 1/2 the face is the origin.
    let shrinking = [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [-4.0, -4.0, 0.0]];
    let shrinking = shrinking.map(|[x, y, z]| moving([x, y, z, -x, -y, -z]));
    assert_eq!(face_time(through(0.0, 0.0), shrinking), at(0.5));
    assert_eq!(face_time(through(1e-9, 0.0), shrinking), None);
}

#[test]
fn edges_cross_at_inner_points_and_ends() {
    let x_axis = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]].map(resting);
    let falling = |x: f64, y: f64| [moving([x, y, 1.0, x, y, -1.0]), moving([x, 2.0, 1.0, x, 2.0, -1.0])];
    assert_eq!(edge_time(x_axis, falling(0.5, -2.0)), at(0.5));
    assert_eq!(edge_time(x_axis, falling(1.0, 0.0)), at(0.5));
    assert_eq!(edge_time(x_axis, falling(1.0_f64.next_up(), -2.0)), None);
    assert_eq!(edge_time(x_axis, falling(0.5, f64::from_bits(1))), None);
}

#[test]
fn parallel_edges_touch_if_an_end_is_on_the_other() {
    let x_axis = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]].map(resting);
    let along = |from: Line, length: f64| {
        let [x, y, z, u, v, w] = from;
        [moving(from), moving([x + length, y, z, u + length, v, w])]
    };
    assert_eq!(edge_time(x_axis, along([3.0, 0.0, 1.0, 3.0, 0.0, -3.0], 2.0)), at(0.25));
    assert_eq!(edge_time(x_axis, along([1.0, 0.0, 1.0, 1.0, 0.0, -3.0], 2.0)), at(0.25));
    assert_eq!(edge_time(x_axis, along([4.5, 0.0, 1.0, 4.5, 0.0, -3.0], 2.0)), None);
    // On the same line all the time.
    assert_eq!(edge_time(x_axis, along([6.0, 0.0, 0.0, -2.0, 0.0, 0.0], 2.0)), at(0.25));
    assert_eq!(
        edge_time(x_axis, along([6.0, 0.0, 0.0, 4.0_f64.next_up(), 0.0, 0.0], 2.0)),
        None
    );
    // In the same plane, never on the same line.
    assert_eq!(edge_time(x_axis, along([6.0, 1.0, 0.0, -2.0, 1.0, 0.0], 2.0)), None);
    // Points.
    let point = [moving([1.0, 1.0, 1.0, 1.0, -1.0, -1.0]); 2];
    assert_eq!(edge_time(x_axis, point), at(0.5));
    assert_eq!(edge_time([resting([1.0, 0.0, 0.0]); 2], point), at(0.5));
    assert_eq!(edge_time([resting([1.5, 0.0, 0.0]); 2], point), None);
}

#[test]
fn points_on_one_line_meet_where_they_meet() {
    let both = |a: Line, b: Line| edge_time([moving(a); 2], [moving(b); 2]);
    assert_eq!(
        both([0.0, 0.0, 0.0, 2.0, 0.0, 0.0], [1.0, 0.0, 0.0, 1.0, 0.0, 0.0]),
        at(0.5)
    );
    let third = both([0.0, 0.0, 0.0, 2.0, 2.0, 2.0], [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    assert!(third.is_some_and(|time| time.earliest == 1.0 / 3.0 && time.latest > time.earliest));
}

#[test]
fn irrational_times_lie_between_neighbours() {
    // Two corners of the face move so that the plane meets the vertex where 2 t^2 = 1.
    let face = [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0, 1.0, 0.0, 1.0],
        [0.0, 1.0, 0.0, 0.0, 1.0, 0.0],
    ];
    // The plane is z = t x; the vertex is at x = t, z = 1/2.
    let vertex = moving([0.0, 0.0, 0.5, 1.0, 0.0, 0.5]);
    let time = face_time(vertex, face.map(moving)).unwrap();
    let truth = std::f64::consts::FRAC_1_SQRT_2;
    assert!(
        (time.earliest - truth).abs() <= f64::EPSILON && time.latest == time.earliest.next_up(),
        "{time:?}"
    );
    assert!(time.earliest * time.earliest <= 0.5 && time.latest * time.latest >= 0.5);
}

#[test]
fn tolerances_bound_the_width() {
    let fall = moving([1.0, 1.0, 1.0, 1.0, 1.0, -2.0]);
    for tolerance in [1.0, 0.3, 1e-3, 1e-9, 1e-13, 1e-20, 0.0, -1.0, f64::NAN] {
        let time = vertex_face_impact(fall, flat_face(), tolerance).unwrap();
        let least = if tolerance > f64::EPSILON {
            tolerance
        } else {
            f64::EPSILON
        };
        assert!(time.latest - time.earliest <= least, "{tolerance} {time:?}");
        assert!(
            time.earliest <= 1.0 / 3.0 && time.latest > 1.0 / 3.0,
            "{tolerance} {time:?}"
        );
    }
}

#[test]
fn the_first_of_several_contacts_counts() {
    // The height of the vertex over the face is proportional to (4 t - 1) (4 t - 3), and both times it is over the inside.
    let face = [
        [0.0; 6],
        [8.0, 0.0, 0.0, 8.0, 0.0, -8.0],
        [0.0, 8.0, 0.0, 0.0, 8.0, 0.0],
    ]
    .map(moving);
    let vertex = moving([1.0, 1.0, 0.1875, 2.0, 1.0, -1.8125]);
    assert_eq!(face_time(vertex, face), at(0.25));
    let back = |point: MovingPoint| MovingPoint::new(point.end, point.start);
    assert_eq!(face_time(back(vertex), face.map(back)), at(0.25));
    let time = vertex_face_impact(vertex, face, 1e-3).unwrap();
    assert!(time.earliest <= 0.25 && time.latest >= 0.25, "{time:?}");
}

#[test]
fn coordinates_of_every_magnitude_are_decided() {
    for scale in [1e-300, 1e-160, 1e150, 1e300] {
        let scaled = |line: Line| moving(line.map(|c| c * scale));
        let face = [[0.0; 6], [4.0, 0.0, 0.0, 4.0, 0.0, 0.0], [0.0, 4.0, 0.0, 0.0, 4.0, 0.0]].map(scaled);
        assert_eq!(face_time(scaled([1.0, 1.0, 1.0, 1.0, 1.0, -1.0]), face), at(0.5));
        assert_eq!(face_time(scaled([3.0, 3.0, 1.0, 3.0, 3.0, -1.0]), face), None);
    }
    let (huge, tiny) = (f64::MAX, f64::from_bits(1));
    let face = [
        [0.0; 6],
        [huge, 0.0, 0.0, huge, 0.0, 0.0],
        [0.0, huge, 0.0, 0.0, huge, 0.0],
    ]
    .map(moving);
    assert_eq!(face_time(moving([tiny, tiny, huge, tiny, tiny, -huge]), face), at(0.5));
    assert_eq!(face_time(moving([-tiny, tiny, huge, tiny, tiny, -huge]), face), at(0.5));
    assert_eq!(face_time(moving([-tiny, tiny, huge, -tiny, tiny, -huge]), face), None);
    assert!(face_time(moving([-tiny, tiny, huge, 0.5 * huge, tiny, -tiny]), face).is_some());
}

#[test]
fn what_is_not_finite_touches_nothing() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let [a, b, c] = flat_face();
        for vertex in [
            moving([1.0, 1.0, bad, 1.0, 1.0, 0.0]),
            moving([1.0, 1.0, 1.0, 1.0, bad, -1.0]),
        ] {
            assert_eq!(face_time(vertex, [a, b, c]), None);
            assert_eq!(face_time(a, [vertex, b, c]), None);
            assert_eq!(edge_time([a, b], [vertex, c]), None);
        }
    }
}
