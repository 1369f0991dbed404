//! The answer does not depend on the order of points, and reversed motions touch as well.

use morph_collision_testkit::motion::{ElementaryMotion, Family, MotionKind, first_contact};

const MOTIONS: u64 = 40;

fn motions() -> impl Iterator<Item = (Family, u64, ElementaryMotion)> {
    let of_family = |family: Family| (0..MOTIONS).map(move |index| (family, index, family.motion(3, index)));
    Family::ALL
        .into_iter()
        .filter(|&family| family != Family::Extreme)
        .flat_map(of_family)
}

#[test]
fn the_order_of_points_does_not_matter() {
    for (family, index, motion) in motions() {
        let first = first_contact(&motion);
        for other in motion.reordered().into_iter().skip(1).step_by(2) {
            assert_eq!(first, first_contact(&other), "{family} {index}");
        }
    }
}

#[test]
fn reversed_motions_touch_exactly_if_the_motions_do() {
    for (family, index, motion) in motions() {
        let (first, reversed) = (first_contact(&motion), first_contact(&motion.reversed()));
        assert_eq!(first.is_some(), reversed.is_some(), "{family} {index}");
        // The last contact is not before the first. 1 - t is rounded, so it is compared with some slack.
        if let (Some(first), Some(reversed)) = (first, reversed) {
            assert!(first.to_f64() <= 1.0 - reversed.to_f64() + 1e-15, "{family} {index}");
        }
    }
}

#[test]
fn moving_scaling_and_swapping_axes_exactly_changes_nothing() {
    for (family, index, motion) in motions() {
        let mut other = motion;
        for position in other.points.as_flattened_mut() {
            position.rotate_left(1);
            *position = position.map(|x| -4.0 * x);
        }
        let exact = other
            .points
            .as_flattened()
            .as_flattened()
            .iter()
            .all(|x| x.is_normal() || *x == 0.0);
        if exact {
            assert_eq!(first_contact(&motion), first_contact(&other), "{family} {index}");
        }
    }
}

#[test]
fn families_draw_finite_motions_of_both_kinds_some_that_touch_and_some_that_do_not() {
    for family in Family::ALL {
        let (mut kinds, mut answers) = ([false; 2], [false; 2]);
        for index in 0..MOTIONS {
            let motion = family.motion(5, index);
            assert!(motion.is_finite(), "{family} {index}");
            assert_eq!(motion, family.motion(5, index), "{family} {index}");
            kinds[usize::from(motion.kind == MotionKind::EdgeEdge)] = true;
            answers[usize::from(first_contact(&motion).is_some())] = true;
        }
        assert_eq!((kinds, answers), ([true; 2], [true; 2]), "{family}");
    }
}
