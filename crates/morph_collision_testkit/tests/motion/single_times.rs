//! Exact tests of triangles that do not move, at times at which all positions are exact.

use glam::DVec3;
use morph_collision_testkit::motion::{ElementaryMotion, Family, MotionKind, first_contact};
use morph_collision_testkit::oracle::triangles_intersect;

/// Whether the features touch while the points are here. Edges and vertices are degenerate triangles.
fn touch([a, b, c, d]: [[f64; 3]; 4], kind: MotionKind) -> bool {
    let [a, b, c, d] = [a, b, c, d].map(DVec3::from_array);
    match kind {
        MotionKind::VertexFace => triangles_intersect(&[a; 3], &[b, c, d]),
        MotionKind::EdgeEdge => triangles_intersect(&[a, b, b], &[c, d, d]),
    }
}

/// Positions at a multiple of 1/16. Exact for small whole numbers.
fn at(motion: &ElementaryMotion, time: f64) -> [[f64; 3]; 4] {
    motion
        .points
        .map(|[start, end]| std::array::from_fn(|axis| start[axis] + time * (end[axis] - start[axis])))
}

#[test]
fn no_moment_before_the_first_contact_touches() {
    let mut at_contact = 0;
    for index in 0..600 {
        let motion = Family::Grid.motion(11, index);
        let first = first_contact(&motion);
        for step in 0..=16 {
            let time = f64::from(step) / 16.0;
            let touches = touch(at(&motion, time), motion.kind);
            match first.as_ref().map(|first| first.cmp_f64(time)) {
                None | Some(std::cmp::Ordering::Greater) => assert!(!touches, "grid {index} at {time}"),
                Some(std::cmp::Ordering::Equal) => {
                    assert!(touches, "grid {index} at {time}");
                    at_contact += 1;
                }
                Some(std::cmp::Ordering::Less) => {}
            }
        }
    }
    assert!(at_contact > 100, "{at_contact}");
}

#[test]
fn touching_at_the_start_is_the_first_contact_and_touching_at_the_end_is_a_contact() {
    let (mut starts, mut ends) = (0, 0);
    for family in Family::ALL {
        // The exact test of triangles that stay is not made for the whole range of exponents.
        if matches!(family, Family::Scaled | Family::MixedScales | Family::Extreme) {
            continue;
        }
        for index in 0..60 {
            let motion = family.motion(13, index);
            let [start, end] = [0, 1].map(|time| touch(motion.points.map(|point| point[time]), motion.kind));
            let first = first_contact(&motion);
            let at_start = first.as_ref().is_some_and(|first| first.cmp_f64(0.0).is_eq());
            assert_eq!(start, at_start, "{family} {index}");
            assert!(!end || first.is_some(), "{family} {index}");
            starts += usize::from(start);
            ends += usize::from(end);
        }
    }
    assert!(starts > 50 && ends > 50, "{starts} {ends}");
}
