//! Measures in exact arithmetic how close the errors of placed vertices, and of boxes in another body's space, come to their bounds.

use glam::{Affine3A, DVec3, Vec3};
use morph_collision_testkit::oracle::Dyadic;
use morph_collision_testkit::search::{Climb, is_as_known};
use rand::RngExt;

use super::frame::{Frame, PlacedBounds, relative};
use super::probe::{ExactPoint, Image, adjugate, box_at, exact_image, slack_used};
use super::{BoxMap, WorldFromModel, up};

/// `3 v (|M| |p| + |t|) (1 + 3 v)` per coordinate.
fn placement_bound(place: &Affine3A, magnitude: [Dyadic; 3]) -> ExactPoint {
    let three_v = || Dyadic::from(3.0_f64) * Dyadic::power_of_two(-53);
    std::array::from_fn(|row| {
        let products = (0..3).map(|c| Dyadic::from(place.matrix3.col(c)[row].abs()) * magnitude[c].clone());
        let reach = products.sum::<Dyadic>() + Dyadic::from(place.translation[row].abs());
        three_v() * reach * (Dyadic::from(1.0_f64) + three_v())
    })
}

fn columns(place: &Affine3A) -> [DVec3; 4] {
    place
        .to_cols_array_2d()
        .map(|column| Vec3::from_array(column).as_dvec3())
}

fn place_of(numbers: &[f32]) -> Affine3A {
    let mut columns = [0.0; 12];
    columns.copy_from_slice(&numbers[..12]);
    Affine3A::from_cols_array(&columns)
}

/// The error of one placed point, divided by its bound.
fn placement_ratio(numbers: &[f32]) -> Option<f64> {
    let place = place_of(numbers);
    let checked = WorldFromModel::new(place).ok()?;
    let p = Vec3::from_slice(&numbers[12..15]);
    if !p.is_finite() || p.abs().max_element() > 2e37 {
        return None;
    }
    let placed = checked.transform_point(p);
    let point = p.to_array().map(Dyadic::from);
    let bound = placement_bound(&place, point.clone().map(Dyadic::abs));
    let exact = exact_image(&columns(&place), &point);
    let ratio = |i: usize| {
        let error = (Dyadic::from(placed[i]) - exact[i].clone()).abs();
        assert!(error <= bound[i], "{numbers:?}, coordinate {i}");
        error.ratio(&bound[i])
    };
    Some(ratio(0).max(ratio(1)).max(ratio(2)))
}

#[test]
fn a_placed_vertex_is_off_by_nearly_its_bound_and_never_by_more() {
    let climb = Climb {
        seed: 1,
        starts: 12,
        steps: 400,
    };
    let (ratio, _) = climb.highest(
        |i, rng| {
            let scale = 2_f32.powi(rng.random_range(-60..60));
            let mut numbers: Vec<f32> = (0..15).map(|_| rng.random_range(-1.0..1.0) * scale).collect();
            if i % 2 == 0 {
                // One product is near 1; each term added to it is just above half a unit in its last place.
                let tiny = 2_f32.powi(-53) * 1.01;
                numbers = vec![1.01; 15];
                numbers[3..6].fill(tiny);
                numbers[6..9].fill(tiny);
                numbers[9..12].fill(tiny);
            }
            numbers
        },
        placement_ratio,
    );
    println!("placed vertex: {ratio:.3} of the bound");
    assert!(is_as_known(ratio, 0.987), "{ratio} of the bound, known is 0.987");
}

/// The fraction of its slack that the map to A's space needs for a point of B.
fn map_ratio(numbers: &[f32]) -> Option<f64> {
    let (place_a, place_b) = (place_of(numbers), place_of(&numbers[12..]));
    let [world_from_a, world_from_b] = [WorldFromModel::new(place_a).ok()?, WorldFromModel::new(place_b).ok()?];
    // Few bits, so that the box of the point is exact.
    let q = Vec3::from_slice(&numbers[24..27]).clamp(Vec3::NEG_ONE, Vec3::ONE);
    let q = (q * 4096.0).round() / 4096.0;
    let (rows, determinant) = adjugate(&columns(&place_a));
    if determinant == Dyadic::zero() {
        return None;
    }
    let exact_q = q.to_array().map(Dyadic::from);
    let world_q = exact_image(&columns(&place_b), &exact_q);
    let scaled: ExactPoint = std::array::from_fn(|row| {
        (0..3)
            .map(|c| rows[row][c].clone() * (world_q[c].clone() - Dyadic::from(place_a.translation[c])))
            .sum()
    });
    let reach_a = scaled.clone().map(|x| x.abs().ratio(&determinant) * (1.0 + 1e-6));
    if reach_a.iter().any(|x| !(0.0..1e30).contains(x)) {
        return None;
    }
    let magnitude_a = Vec3::from_array(reach_a.map(up)).as_dvec3();
    let placed_a = PlacedBounds::new(&world_from_a, magnitude_a);
    let placed_b = PlacedBounds::new(&world_from_b, q.abs().as_dvec3());
    let mut frame = Frame::default();
    if !relative(&placed_a, &placed_b, &mut frame) {
        return None;
    }
    let map = BoxMap::new(&frame)?;
    let error_a = placement_bound(&place_a, reach_a.map(Dyadic::from));
    let error_b = placement_bound(&place_b, exact_q.map(Dyadic::abs));
    let image = Image {
        determinant,
        scaled,
        scaled_offset: (rows, std::array::from_fn(|i| error_a[i].clone() + error_b[i].clone())),
    };
    let used = slack_used(&map, &box_at(q), &image);
    assert!(used <= 1.0, "{used} of the slack: {numbers:?}");
    Some(used)
}

/// `known` has the fractions of the slack needed near the origin, where `f32` causes most of the error, and far from it, where
/// the placements do.
fn search_map(known: [f64; 2]) {
    for (where_, range, known) in [("near", -8..3, known[0]), ("far", 36..60, known[1])] {
        let climb = Climb {
            seed: 2,
            starts: 6,
            steps: 250,
        };
        let (ratio, _) = climb.highest(
            |_, rng| {
                let distance = 2_f32.powi(rng.random_range(range.clone()));
                let mut numbers: Vec<f32> = (0..27).map(|_| rng.random_range(-1.0..1.0)).collect();
                for body in [0, 12] {
                    // Far from singular.
                    (0..3).for_each(|i| numbers[body + 4 * i] += 2.0);
                    numbers[body + 9..body + 12].iter_mut().for_each(|t| *t *= distance);
                }
                // Nearly the same translation, so that the bodies may touch.
                for i in 9..12 {
                    numbers[12 + i] = numbers[i];
                }
                numbers
            },
            map_ratio,
        );
        println!("box in another body's space, {where_}: {ratio:.3} of the slack");
        assert!(
            is_as_known(ratio, known),
            "{where_}: {ratio} of the slack, known is {known}"
        );
    }
}

#[test]
fn boxes_need_much_of_their_slack_in_another_space_and_never_more() {
    search_map([0.191, 0.750]);
}
