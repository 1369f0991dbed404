//! Tests of pairs of triangles.

use glam::{DQuat, DVec2, DVec3, EulerRot};
use proptest::prelude::*;

use morph_collision_testkit::near_degenerate::Family;
use morph_collision_testkit::oracle;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::filter::facets_intersect;
use super::segment::segments_intersect;
use super::separation::certainly_apart;
use super::{Facet, Triangle, facets_intersect_counting, power_of_two, triangle_contact, triangles_intersect};

/// What the filter decides without exact predicates.
fn filtered(a: &Triangle, b: &Triangle) -> Option<bool> {
    facets_intersect(&Facet::new(*a), &Facet::new(*b))
}

const fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

const FLAT: Triangle = [v(0.0, 0.0, 0.0), v(4.0, 0.0, 0.0), v(0.0, 4.0, 0.0)];

#[test]
fn crossing_touching_and_apart() {
    let through = [v(1.0, 1.0, -1.0), v(1.0, 1.0, 1.0), v(2.0, 1.0, 1.0)];
    assert!(triangles_intersect(&FLAT, &through));
    let tip_on_face = [v(1.0, 1.0, 0.0), v(1.0, 1.0, 1.0), v(2.0, 1.0, 1.0)];
    assert!(triangles_intersect(&FLAT, &tip_on_face));
    let tip_above = tip_on_face.map(|p| p + v(0.0, 0.0, f64::MIN_POSITIVE));
    assert!(!triangles_intersect(&FLAT, &tip_above));
    let shared_vertex = [v(0.0, 0.0, 0.0), v(-1.0, 0.0, 1.0), v(0.0, -1.0, 1.0)];
    assert!(triangles_intersect(&FLAT, &shared_vertex));
    let edge_on_edge = [v(1.0, 0.0, 0.0), v(2.0, 0.0, 0.0), v(1.0, -1.0, 3.0)];
    assert!(triangles_intersect(&FLAT, &edge_on_edge));
    let beside = [v(3.0, 3.0, -1.0), v(3.0, 3.0, 1.0), v(4.0, 3.0, 1.0)];
    assert!(!triangles_intersect(&FLAT, &beside));
}

#[test]
fn coplanar_triangles() {
    let inside = [v(0.5, 0.5, 0.0), v(1.0, 0.5, 0.0), v(0.5, 1.0, 0.0)];
    assert!(triangles_intersect(&FLAT, &inside));
    let across = [v(-1.0, 1.0, 0.0), v(5.0, 1.0, 0.0), v(5.0, 1.5, 0.0)];
    assert!(triangles_intersect(&FLAT, &across));
    let touching_side = [v(2.0, 2.0, 0.0), v(4.0, 4.0, 0.0), v(4.0, 3.0, 0.0)];
    assert!(triangles_intersect(&FLAT, &touching_side));
    let apart = touching_side.map(|p| p + v(1e-12, 0.0, 0.0));
    assert!(!triangles_intersect(&FLAT, &apart));
}

#[test]
fn triangles_degenerate_to_segments_and_points() {
    let segment = [v(1.0, 1.0, -1.0), v(1.0, 1.0, 0.0), v(1.0, 1.0, 1.0)];
    assert!(triangles_intersect(&FLAT, &segment));
    assert!(!triangles_intersect(&FLAT, &segment.map(|p| p + v(3.0, 0.0, 0.0))));
    let point = [v(2.0, 2.0, 0.0); 3];
    assert!(triangles_intersect(&FLAT, &point));
    assert!(triangles_intersect(&point, &point));
    assert!(!triangles_intersect(&point, &[v(2.0, 2.0, 1e-300); 3]));
    assert!(triangles_intersect(&segment, &[v(1.0, 1.0, 0.5); 3]));
    assert!(!triangles_intersect(&segment, &[v(1.0, 1.0, 1.5); 3]));
    let crossing = [v(0.0, 1.0, 0.0), v(2.0, 1.0, 0.0), v(0.5, 1.0, 0.0)];
    assert!(triangles_intersect(&segment, &crossing));
    let collinear_gap = segment.map(|p| p + v(0.0, 0.0, 2.5));
    assert!(!triangles_intersect(&segment, &collinear_gap));
    assert!(triangles_intersect(&segment, &segment.map(|p| p + v(0.0, 0.0, 2.0))));
    // They cross between the second and the third corner of each.
    let along_x = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(4.0, 0.0, 0.0)];
    let along_y = [v(3.0, -3.0, 0.0), v(3.0, -2.0, 0.0), v(3.0, 1.0, 0.0)];
    assert!(triangles_intersect(&along_x, &along_y));
}

#[test]
fn segments_that_touch_at_an_end_of_one_share_a_point() {
    let floor = [v(0.0, 0.0, 0.0), v(4.0, 0.0, 0.0)];
    for post in [
        [v(1.0, 0.0, 0.0), v(1.0, 3.0, 2.0)],
        [v(1.0, 3.0, 2.0), v(1.0, 0.0, 0.0)],
    ] {
        let beside = post.map(|p| p + v(4.0, 0.0, 0.0));
        for (s, t) in [(floor, post), (post, floor)] {
            assert!(segments_intersect(s, t), "{s:?} {t:?}");
        }
        assert!(!segments_intersect(floor, beside) && !segments_intersect(beside, floor));
    }
}

/// Corners on a coarse grid, so that coplanar, touching and degenerate pairs are common.
fn grid_triangles() -> impl Strategy<Value = Triangle> {
    prop::array::uniform3(prop::array::uniform3(-2_i8..3).prop_map(|c| DVec3::from_array(c.map(f64::from))))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_order_of_triangles_and_corners_does_not_matter(a in grid_triangles(), b in grid_triangles()) {
        let expected = triangles_intersect(&a, &b);
        prop_assert_eq!(triangles_intersect(&b, &a), expected);
        prop_assert_eq!(triangles_intersect(&[a[1], a[2], a[0]], &b), expected);
        prop_assert_eq!(triangles_intersect(&a, &[b[1], b[0], b[2]]), expected);
    }

    #[test]
    fn it_agrees_with_the_oracle(a in grid_triangles(), b in grid_triangles()) {
        let truth = oracle::triangles_intersect(&a, &b);
        prop_assert_eq!(triangles_intersect(&a, &b), truth);
    }
}

/// Three collinear corners in any order, so that shared corners need not be ends.
fn collinear_triangles() -> impl Strategy<Value = Triangle> {
    let vector = || prop::array::uniform3(-2_i8..3).prop_map(|c| DVec3::from_array(c.map(f64::from)));
    (vector(), vector(), prop::array::uniform3(-3_i8..4))
        .prop_map(|(start, along, places)| places.map(|place| start + along * f64::from(place)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn triangles_that_are_segments_agree_with_the_oracle(a in collinear_triangles(), b in collinear_triangles()) {
        let truth = oracle::triangles_intersect(&a, &b);
        prop_assert_eq!(triangles_intersect(&a, &b), truth);
        prop_assert_eq!(triangle_contact(&a, &b).is_some(), truth);
    }
}

/// Corners in general position; some are a few roundings from a plane or an edge of the other triangle.
fn close_triangles() -> impl Strategy<Value = [Triangle; 2]> {
    let point = || prop::array::uniform3(-1.0..1.0_f64).prop_map(DVec3::from_array);
    let nudge = || prop::array::uniform3(-4_i8..5).prop_map(|c| DVec3::from_array(c.map(f64::from)) * 1e-16);
    let triangle = || prop::array::uniform3(point());
    (triangle(), triangle(), point(), nudge(), 0_u8..3).prop_map(|(a, mut b, at, nudge, how)| {
        let on_a = a[0] + (a[1] - a[0]) * at.x + (a[2] - a[0]) * at.y;
        match how {
            0 => {}
            1 => b[0] = on_a + nudge,
            // An edge through a point of the other triangle's edge.
            _ => b[0] = b[1] + (a[0].lerp(a[1], at.z.abs()) + nudge - b[1]) * 2.0,
        }
        [a, b]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn the_filter_agrees_with_the_oracle_or_is_undecided([a, b] in close_triangles()) {
        let truth = oracle::triangles_intersect(&a, &b);
        prop_assert!(filtered(&a, &b).is_none_or(|decided| decided == truth));
        prop_assert_eq!(triangles_intersect(&a, &b), truth);
    }

    /// Near the ends of the range of `f64`, products underflow and overflow; the filter must leave such pairs undecided.
    #[test]
    fn the_filter_is_right_or_undecided_at_every_scale(
        [a, b] in close_triangles(), power in prop_oneof![-370_i32..-290, 290..345],
    ) {
        let scaled = |triangle: &Triangle| triangle.map(|p| p * 2.0_f64.powi(power));
        let (a, b) = (scaled(&a), scaled(&b));
        let truth = oracle::triangles_intersect(&a, &b);
        prop_assert!(filtered(&a, &b).is_none_or(|decided| decided == truth));
        prop_assert_eq!(triangles_intersect(&a, &b), truth);
    }

    #[test]
    fn nothing_changes_with_the_scale(a in grid_triangles(), b in grid_triangles(), power in -1074_i32..1020) {
        let scaled = |triangle: &Triangle| triangle.map(|p| p * 2.0_f64.powi(power / 2) * 2.0_f64.powi(power - power / 2));
        prop_assert_eq!(triangles_intersect(&scaled(&a), &scaled(&b)), triangles_intersect(&a, &b));
        let [far, near] = [triangle_contact(&scaled(&a), &scaled(&b)), triangle_contact(&a, &b)];
        prop_assert_eq!(far.is_some(), near.is_some());
        if let (Some(far), Some(near)) = (far, near) {
            let back = far.segment.map(|p| p / 2.0_f64.powi(power / 2) / 2.0_f64.powi(power - power / 2));
            let off = back[0].distance(near.segment[0]).max(back[1].distance(near.segment[1]));
            prop_assert!(power < -1000 || off < 1e-12, "{far:?} {near:?}");
        }
    }

    #[test]
    fn coordinates_of_all_sizes_in_one_pair_are_answered_exactly(
        a in prop::array::uniform3(prop::array::uniform3((-2_i8..3, -1070_i32..1000))),
        b in prop::array::uniform3(prop::array::uniform3((-2_i8..3, -1070_i32..1000))),
    ) {
        let number = |(digit, power): (i8, i32)| f64::from(digit) * 2.0_f64.powi(power / 2) * 2.0_f64.powi(power - power / 2);
        let [a, b] = [a, b].map(|corners| corners.map(|corner| DVec3::from_array(corner.map(number))));
        prop_assert_eq!(triangles_intersect(&a, &b), oracle::triangles_intersect(&a, &b));
    }
}

#[test]
fn the_filter_decides_triangles_in_general_position() {
    let through = [v(1.0, 1.0, -1.0), v(1.1, 1.0, 1.0), v(2.0, 1.2, 1.0)];
    assert_eq!(filtered(&FLAT, &through), Some(true));
    assert_eq!(filtered(&through, &FLAT), Some(true));
    let beside = through.map(|p| p + v(3.0, 3.0, 0.0));
    assert_eq!(filtered(&FLAT, &beside), Some(false));
    let above = through.map(|p| p + v(0.0, 0.0, 1.5));
    assert_eq!(filtered(&FLAT, &above), Some(false));
    assert_eq!(filtered(&FLAT, &FLAT), None);
    let inside = [v(0.5, 0.5, 0.0), v(1.0, 0.5, 0.0), v(0.5, 1.0, 0.0)];
    let mut undecided = 0;
    for other in [through, beside, FLAT, inside] {
        facets_intersect_counting(&Facet::new(FLAT), &Facet::new(other), &mut undecided);
    }
    assert_eq!(undecided, 1, "only the last one needs exact arithmetic");
}

/// Pairs for which rounded determinants are wrong, without the box test that queries do before the filter.
#[test]
fn the_filter_never_contradicts_the_oracle_on_nearly_degenerate_triangles() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    for family in Family::ALL {
        let mut undecided = 0;
        for _ in 0..4000 {
            let [a, b] = family.pair(&mut rng);
            let truth = oracle::triangles_intersect(&a, &b);
            for (a, b) in [(&a, &b), (&b, &a)] {
                let decided = filtered(a, b);
                assert!(decided.is_none_or(|decided| decided == truth), "{a:?} {b:?}");
                undecided += u32::from(decided.is_none());
            }
        }
        println!(
            "{}: {:.1} % left open by the filter",
            family.name(),
            f64::from(undecided) / 80.0
        );
    }
}

#[test]
fn triangles_that_are_certainly_apart_are_so_for_the_oracle() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    for family in Family::ALL {
        let mut undecided = 0;
        for case in 0..4000 {
            // Also where products underflow and overflow.
            let scale = [
                1.0,
                power_of_two(-332),
                power_of_two(-530),
                power_of_two(332),
                power_of_two(500),
            ][case % 5];
            let [a, b] = family
                .pair(&mut rng)
                .map(|triangle| triangle.map(|corner| corner * scale));
            let are_apart = !oracle::triangles_intersect(&a, &b);
            for (a, b) in [(&a, &b), (&b, &a)] {
                let certain = certainly_apart(a, b);
                assert!(are_apart || !certain, "{a:?} {b:?}");
                undecided += u32::from(are_apart && !certain);
            }
        }
        println!("{}: {undecided} of 8000 are apart and undecided", family.name());
    }
}

/// In a coordinate plane one term is 0, so a bound that leaves out either of the others is too small.
#[test]
fn corners_at_edges_in_a_coordinate_plane_are_certainly_apart_only_if_they_are_for_the_oracle() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    // Open, and certainly apart, at each of two scales. At the second one, products of two terms are far below their sums.
    let mut counts = [[0; 2]; 2];
    for case in 0..12_000 {
        let mut vector = || DVec2::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        let [from, to, tip] = std::array::from_fn(|_| vector());
        let [at, along] = [0, 1].map(|_| rng.random_range(0.0..1.0));
        // Corner and edge meet but for roundings. The corner's triangle is on the side of the edge on which the tip is not.
        let corner = from.lerp(to, at);
        let edge = to - from;
        let aside = -edge.perp() * edge.perp_dot(tip - from).signum();
        let flat = [
            [from, to, tip],
            [corner, corner + aside + edge * along, corner + aside - edge * along],
        ];
        let scale = [1.0, power_of_two(-30)][case % 2];
        let [a, b]: [Triangle; 2] = flat.map(|triangle| {
            triangle.map(|p| scale * DVec3::from_array([[0.0, p.x, p.y], [p.x, 0.0, p.y], [p.x, p.y, 0.0]][case % 3]))
        });
        let are_apart = !oracle::triangles_intersect(&a, &b);
        for (a, b) in [(&a, &b), (&b, &a)] {
            let is_certain = certainly_apart(a, b);
            assert!(are_apart || !is_certain, "{a:?} {b:?}");
            counts[case % 2][usize::from(is_certain)] += 1;
        }
    }
    assert!(counts.as_flattened().iter().all(|count| *count > 0), "{counts:?}");
}

/// Those that the filter leaves open would take microseconds each in exact arithmetic.
#[test]
fn slivers_of_bodies_that_collapsed_are_apart_without_exact_arithmetic() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut unit = || rng.random_range(-1.0..1.0);
    let (mut apart, mut decided) = (0, 0);
    for _ in 0..2000 {
        // Corners on a line, but for roundings.
        let [a, b]: [Triangle; 2] = std::array::from_fn(|_| {
            let [start, along] = [0, 1].map(|_| DVec3::new(unit(), unit(), unit()));
            std::array::from_fn(|_| start + along * unit())
        });
        if filtered(&a, &b).is_none() && !oracle::triangles_intersect(&a, &b) {
            apart += 1;
            decided += u32::from(certainly_apart(&a, &b));
        }
    }
    assert!(apart > 1000 && decided == apart, "{decided} of {apart}");
}

/// Of the directions, only the perpendicular from the segment to the point is not 0: neither triangle has a normal.
#[test]
fn points_beside_segments_are_apart_without_exact_arithmetic() {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    for _ in 0..2000 {
        let mut vector = || DVec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
        let [from, to, other] = std::array::from_fn(|_| vector());
        let along = to - from;
        let beside = from + along * rng.random_range(0.2..0.8) + 1e-3 * along.cross(other);
        let [segment, point] = [[from, to, to], [beside; 3]];
        for (a, b) in [(&segment, &point), (&point, &segment)] {
            assert_eq!(filtered(a, b), None);
            assert!(certainly_apart(a, b), "{a:?} {b:?}");
        }
    }
}

/// Without any one kind of direction, one of these pairs is left to exact arithmetic.
#[test]
fn what_is_apart_beside_an_edge_needs_no_exact_arithmetic() {
    // Tilted, so that no coordinate is exact.
    let tilted = DQuat::from_euler(EulerRot::XYZ, 0.3, 0.7, -1.1);
    let at = |x: f64, y: f64, z: f64| tilted * v(x, y, z);
    let segment = [at(0.0, 0.0, 0.0), at(3.0, 0.0, 0.0), at(1.0, 0.0, 0.0)];
    let coplanar = [at(0.0, 0.0, 0.0), at(4.0, 0.0, 0.0), at(1.0, 3.0, 0.0)];
    for (name, a, b) in [
        (
            "skew",
            segment,
            [at(1.0, -1.0, 0.1), at(1.1, 2.0, 0.1), at(1.05, 0.5, 0.1)],
        ),
        (
            "parallel",
            segment,
            [at(0.5, 0.1, 0.2), at(2.5, 0.1, 0.2), at(1.0, 0.1, 0.2)],
        ),
        ("a point beside a segment", segment, [at(1.5, 0.1, 0.2); 3]),
        ("points", [at(0.0, 0.0, 0.0); 3], [at(1e-9, 1e-9, 0.0); 3]),
        (
            "beside an edge",
            coplanar,
            [at(0.5, -0.1, 0.0), at(3.0, -0.2, 0.0), at(2.0, -3.0, 0.0)],
        ),
        (
            "beyond a corner",
            coplanar,
            [at(4.1, -1.0, 0.0), at(4.2, 4.0, 0.0), at(9.0, 1.0, 0.0)],
        ),
    ] {
        for (a, b) in [(&a, &b), (&b, &a)] {
            let mut undecided = 0;
            assert_eq!(filtered(a, b), None, "{name}");
            assert!(!facets_intersect_counting(
                &Facet::new(*a),
                &Facet::new(*b),
                &mut undecided
            ));
            assert_eq!(undecided, 0, "{name}");
        }
    }
}

#[test]
fn triangles_that_are_not_finite_meet_nothing() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut broken = FLAT;
            broken[1][axis] = value;
            for (a, b) in [(&broken, &FLAT), (&FLAT, &broken), (&broken, &broken)] {
                assert!(!triangles_intersect(a, b), "{a:?} {b:?}");
                assert!(triangle_contact(a, b).is_none());
            }
        }
    }
}
