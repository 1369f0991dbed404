//! The stages agree, and the exact one agrees with symmetries and with tests at single times.

use glam::DVec3;
use proptest::prelude::*;

use super::answer::Answer;
use super::ends::decide_at_ends;
use super::features::{FeaturePair, Kind};
use super::filter::{filtered, separated};
use super::touch::{edge_edge, vertex_face};
use super::*;
use crate::exact::{Triangle, triangles_intersect};

type Corners = [MovingPoint; 4];

/// Whole numbers up to `reach`. Contact, coplanarity and collapse are frequent.
fn grid(reach: i32) -> impl Strategy<Value = Corners> {
    let coordinate = (-reach..=reach).prop_map(f64::from);
    prop::array::uniform24(coordinate).prop_map(corners)
}

/// All corners in the plane `z = 0` all the time, or on the x axis.
fn flat() -> impl Strategy<Value = Corners> {
    (grid(3), 1..3_usize).prop_map(|(corners, axes)| {
        let keep = |p: DVec3| DVec3::new(p.x, if axes > 1 { p.y } else { 0.0 }, 0.0);
        corners.map(|c| MovingPoint::new(keep(c.start), keep(c.end)))
    })
}

/// Any numbers, some of them nearly equal.
fn doubles() -> impl Strategy<Value = Corners> {
    let coordinate = prop_oneof![
        -1.0..1.0,
        (-2_i32..3, -4_i64..5).prop_map(|(n, ulps)| {
            let value = f64::from(n) * 0.3;
            f64::from_bits((value.to_bits() as i64 + if n == 0 { 0 } else { ulps }) as u64)
        })
    ];
    prop::array::uniform24(coordinate).prop_map(corners)
}

fn any_corners() -> impl Strategy<Value = Corners> {
    prop_oneof![grid(1), grid(2), grid(4), flat(), doubles(), degenerate_at_ends()]
}

/// Motions that start, end, or both, in one plane, on one line, or in one point.
fn degenerate_at_ends() -> impl Strategy<Value = Corners> {
    (doubles(), grid(2), [0..4_usize, 0..4_usize], -1.0..1.0).prop_map(|(corners, coarse, axes, x)| {
        let keep = |p: DVec3, axes: usize| DVec3::from_array(std::array::from_fn(|i| if i < axes { p[i] } else { x }));
        std::array::from_fn(|i| MovingPoint::new(keep(corners[i].start, axes[0]), keep(coarse[i].end, axes[1])))
    })
}

fn any_kind() -> impl Strategy<Value = Kind> {
    prop_oneof![Just(Kind::VertexFace), Just(Kind::EdgeEdge)]
}

fn corners(c: [f64; 24]) -> Corners {
    std::array::from_fn(|i| {
        let [x, y, z, u, v, w] = std::array::from_fn(|j| c[6 * i + j]);
        MovingPoint::new(DVec3::new(x, y, z), DVec3::new(u, v, w))
    })
}

fn touch(kind: Kind, [a, b, c, d]: Corners) -> bool {
    match kind {
        Kind::VertexFace => vertex_face_touch(a, [b, c, d]),
        Kind::EdgeEdge => edge_edge_touch([a, b], [c, d]),
    }
}

fn impact(kind: Kind, [a, b, c, d]: Corners, tolerance: f64) -> Option<TimeOfImpact> {
    match kind {
        Kind::VertexFace => vertex_face_impact(a, [b, c, d], tolerance),
        Kind::EdgeEdge => edge_edge_impact([a, b], [c, d], tolerance),
    }
}

/// The features at one time, as triangles. Exact if the coordinates are small whole numbers and the time has few bits.
fn touch_at(kind: Kind, corners: &Corners, time: f64) -> bool {
    let [a, b, c, d] = corners.map(|corner| corner.start + (corner.end - corner.start) * time);
    let pair: [Triangle; 2] = match kind {
        Kind::VertexFace => [[a; 3], [b, c, d]],
        Kind::EdgeEdge => [[a, b, b], [c, d, d]],
    };
    triangles_intersect(&pair[0], &pair[1])
}

fn features(kind: Kind, [a, b, c, d]: Corners) -> FeaturePair {
    match kind {
        Kind::VertexFace => vertex_face(a, [b, c, d]),
        Kind::EdgeEdge => edge_edge([a, b], [c, d]),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn certain_answers_of_the_filter_are_exact(kind in any_kind(), corners in any_corners(), power in 30..42) {
        let features = features(kind, corners);
        let truth = solve::touch(&features);
        prop_assert!(!(separated(&features) && truth));
        match filtered(&features, None) {
            Answer::Apart => prop_assert!(!truth),
            Answer::Contact(_) => prop_assert!(truth),
            Answer::Open => {}
        }
        let tolerance = 0.5_f64.powi(power);
        let exact = solve::impact(&features, 0.0);
        prop_assert_eq!(exact.is_some(), truth);
        match (filtered(&features, Some(tolerance)), exact) {
            (Answer::Apart, exact) => prop_assert_eq!(exact, None),
            (Answer::Contact(time), Some(exact)) => {
                prop_assert!(time.earliest <= exact.earliest && exact.latest <= time.latest, "{time:?} {exact:?}");
                prop_assert_eq!(Some(time), solve::impact(&features, tolerance));
            }
            (Answer::Contact(time), None) => prop_assert!(false, "{time:?}"),
            (Answer::Open, _) => {}
        }
    }

    #[test]
    fn what_the_ends_decide_is_exact(kind in any_kind(), corners in any_corners(), power in 30..42) {
        let features = features(kind, corners);
        let tolerance = 0.5_f64.powi(power);
        match decide_at_ends(&features, Some(tolerance)) {
            Answer::Contact(time) => prop_assert_eq!(Some(time), solve::impact(&features, tolerance)),
            Answer::Apart => prop_assert!(!solve::touch(&features)),
            Answer::Open => {}
        }
        match decide_at_ends(&features, None) {
            Answer::Contact(_) => prop_assert!(solve::touch(&features)),
            Answer::Apart => prop_assert!(!solve::touch(&features)),
            Answer::Open => {}
        }
    }

    #[test]
    fn time_may_run_backwards(kind in any_kind(), corners in any_corners()) {
        let back = corners.map(|c| MovingPoint::new(c.end, c.start));
        prop_assert_eq!(touch(kind, corners), touch(kind, back));
    }

    #[test]
    fn the_order_of_corners_does_not_matter(kind in any_kind(), corners in any_corners(), tolerance in prop_oneof![Just(0.0), Just(1e-3)]) {
        let [a, b, c, d] = corners;
        let orders = match kind {
            Kind::VertexFace => [[a, c, d, b], [a, d, b, c], [a, c, b, d]],
            Kind::EdgeEdge => [[b, a, c, d], [a, b, d, c], [c, d, a, b]],
        };
        let (touches, time) = (touch(kind, corners), impact(kind, corners, tolerance));
        prop_assert_eq!(touches, time.is_some());
        for order in orders {
            prop_assert_eq!(touch(kind, order), touches);
            prop_assert_eq!(time, impact(kind, order, tolerance));
        }
    }

    #[test]
    fn scaling_by_powers_of_two_changes_nothing(kind in any_kind(), corners in any_corners(), power in -900_i32..900) {
        let scale = 2.0_f64.powi(power);
        let scaled = corners.map(|c| MovingPoint::new(c.start * scale, c.end * scale));
        prop_assert_eq!(touch(kind, corners), touch(kind, scaled));
        prop_assert_eq!(solve::impact(&features(kind, corners), 0.0), impact(kind, scaled, 0.0));
    }

    #[test]
    fn contact_at_single_times_is_found_and_times_of_contact_have_contact(
        kind in any_kind(), corners in prop_oneof![grid(1), grid(2), grid(5), flat()],
    ) {
        let touching = (0..=64).map(|i| f64::from(i) / 64.0).find(|time| touch_at(kind, &corners, *time));
        let time = impact(kind, corners, 0.0);
        if let Some(sampled) = touching {
            prop_assert!(time.is_some_and(|time| time.earliest <= sampled), "{sampled} {time:?}");
        }
        if let Some(time) = time {
            prop_assert!(time.latest == time.earliest || time.latest == time.earliest.next_up());
            // A time with few bits is exact, and so are the positions then.
            if time.latest == time.earliest && (time.earliest * 1_048_576.0).fract() == 0.0 {
                prop_assert!(touch_at(kind, &corners, time.earliest), "{time:?}");
            }
        }
    }
}

#[test]
fn each_stage_decides_what_it_is_for() {
    let at = |x, y, z| MovingPoint::resting(DVec3::new(x, y, z));
    let face = [at(0.0, 0.0, 0.0), at(4.0, 0.0, 0.0), at(0.0, 4.0, 0.0)];
    let fall = |x, y, from, to| MovingPoint::new(DVec3::new(x, y, from), DVec3::new(x, y, to));
    let counts = |vertex| {
        let mut stages = StageCounts::default();
        let touches = vertex_face_touch_counting(vertex, face, &mut stages);
        assert_eq!(stages.total(), 1);
        (
            touches,
            [stages.separated, stages.filtered, stages.at_ends, stages.exact],
        )
    };
    assert_eq!(counts(fall(1.0, 1.0, 3.0, 1.0)), (false, [1, 0, 0, 0]));
    assert_eq!(counts(fall(1.0, 1.0, 3.0, -1.5)), (true, [0, 1, 0, 0]));
    assert_eq!(counts(fall(2.1, 2.1, 3.0, -1.5)), (false, [0, 1, 0, 0]));
    assert_eq!(counts(fall(1.0, 3.0, 3.0, -1.5)), (true, [0, 0, 0, 1]));
    assert_eq!(counts(at(1.0, 1.0, 0.0)), (true, [0, 0, 1, 0]));
    // Into the plane of the face.
    let open = |face: [MovingPoint; 3]| face.map(|c| MovingPoint::new(c.start + DVec3::Z * c.start.x, c.start));
    let ends = |vertex: MovingPoint, face| {
        let mut stages = StageCounts::default();
        let time = vertex_face_impact_counting(vertex, face, 1e-3, &mut stages);
        (time.map(|time| time.earliest), stages.at_ends, stages.exact)
    };
    assert_eq!(ends(fall(1.0, 1.0, 3.0, 0.0), open(face)), (Some(1.0), 1, 0));
    // All of it into one point.
    let point = DVec3::new(0.3, 0.2, 0.7);
    let shrink = face.map(|corner| MovingPoint::new(corner.start, point));
    let above = MovingPoint::new(DVec3::new(1.0, 1.0, 0.5), point);
    assert_eq!(ends(above, shrink), (Some(1.0), 1, 0));
}
