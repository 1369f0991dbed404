//! Measures in exact arithmetic how close the errors of a joint's map come to their bounds: of the map itself, new or kept from slightly
//! different joints, and of the images of boxes under it.

use fearless_simd::Level;
use glam::{DVec3, Vec3};
use morph_collision_testkit::oracle::Dyadic;
use morph_collision_testkit::search::{Climb, is_as_known};
use rand::RngExt;

use super::{JointMap, MapFrame};
use crate::bounds::{Aabb, BoxLanes, ExactPoint, WorldFromModel, adjugate, exact_image, levels, with_simd};

/// How many numbers a matrix has.
const MATRIX: usize = 12;

fn columns(numbers: &[f32]) -> [DVec3; 4] {
    std::array::from_fn(|i| Vec3::from_slice(&numbers[3 * i..]).as_dvec3())
}

fn well_conditioned(frame: &[DVec3; 4]) -> Option<WorldFromModel> {
    let place = WorldFromModel::from_columns(*frame);
    (frame.iter().all(|column| column.is_finite()) && place.is_well_conditioned()).then_some(place)
}

fn update(map: &mut JointMap, place: &WorldFromModel, joint: &[DVec3; 4], reach: f64) -> bool {
    let (frame, joint) = (MapFrame::new(place), joint.map(|column| column.extend(0.0).to_array()));
    with_simd!(Level::new(), simd => map.update(simd, &frame, &joint, reach))
}

fn image_under(map: &JointMap, p: &ExactPoint) -> ExactPoint {
    std::array::from_fn(|i| {
        let products = (0..3).map(|column| Dyadic::from(map.columns[column][i]) * p[column].clone());
        products.sum::<Dyadic>() + Dyadic::from(map.columns[3][i])
    })
}

/// The distance between where the map and where the joint takes a point, as a fraction of the map's drift.
///
/// `numbers` are a point, which defines the reach, then the matrices of a frame and a joint, and then their earlier matrices. The map
/// is kept from the earlier ones if `is_kept`.
fn drift_used(numbers: &[f32], is_kept: bool) -> Option<f64> {
    let (point, matrices) = (Vec3::from_slice(&numbers[..3]), &numbers[3..]);
    let reach = f64::from(point.abs().max_element());
    let [frame, joint] = [0, MATRIX].map(|at| columns(&matrices[at..]));
    let place = well_conditioned(&frame)?;
    if !point.is_finite() || reach > 2e37 || joint.iter().any(|column| !column.is_finite()) {
        return None;
    }
    let mut map = JointMap::default();
    if is_kept {
        let [frame, joint] = [2 * MATRIX, 3 * MATRIX].map(|at| columns(&matrices[at..]));
        update(&mut map, &well_conditioned(&frame)?, &joint, reach);
    }
    if update(&mut map, &place, &joint, reach) == is_kept || !map.reach(reach as f32).is_finite() {
        return None;
    }
    let (rows, determinant) = adjugate(&frame);
    let p = point.to_array().map(Dyadic::from);
    let world = exact_image(&joint, &p);
    let mapped = image_under(&map, &p);
    let off = |row: usize| {
        let from_frame = |c: usize| world[c].clone() - Dyadic::from(frame[3][c]);
        let exact: Dyadic = (0..3).map(|c| rows[row][c].clone() * from_frame(c)).sum();
        let off = (exact - mapped[row].clone() * determinant.clone()).abs();
        off.ratio(&(Dyadic::from(map.drift) * determinant.clone()))
    };
    let used = off(0).max(off(1)).max(off(2));
    assert!(used <= 1.0, "{used} of the drift: {numbers:?}");
    Some(used)
}

/// The matrices of a frame and a joint, far from singular.
fn matrices(rng: &mut rand_pcg::Pcg64Mcg) -> Vec<f32> {
    let distance = 2_f32.powi(rng.random_range(-4..8));
    let mut numbers: Vec<f32> = (0..2 * MATRIX).map(|_| rng.random_range(-1.0..1.0)).collect();
    for matrix in numbers.chunks_exact_mut(MATRIX) {
        (0..3).for_each(|i| matrix[4 * i] += 2.0);
        matrix[9..].iter_mut().for_each(|t| *t *= distance);
    }
    numbers
}

fn search_drift(is_kept: bool, known: f64) {
    let climb = Climb {
        seed: 3,
        starts: 8,
        steps: 500,
    };
    let (found, _) = climb.highest(
        |_, rng| {
            let scale = 2_f32.powi(rng.random_range(-20..20));
            let mut numbers: Vec<f32> = (0..3).map(|_| rng.random_range(-1.0..1.0)).collect();
            numbers.extend(matrices(rng));
            numbers.iter_mut().take(3).for_each(|x| *x *= scale);
            for matrix in [3, 3 + MATRIX] {
                numbers[matrix + 9..matrix + MATRIX]
                    .iter_mut()
                    .for_each(|t| *t *= scale);
            }
            numbers.extend_from_within(3..);
            numbers
        },
        |numbers| drift_used(numbers, is_kept),
    );
    println!("joint map, kept: {is_kept}: {found:.3} of the drift");
    assert!(
        is_as_known(found, known),
        "kept: {is_kept}: {found} of the drift, known is {known}"
    );
}

#[test]
fn a_new_map_is_off_by_a_quarter_of_its_drift_at_most() {
    search_drift(false, 0.22);
}

#[test]
fn a_kept_map_is_off_by_its_drift_at_most() {
    search_drift(true, 0.991);
}

/// The largest error of the ends of a box's image, as a fraction of ten roundings of the map's reach, over all instruction sets.
fn image_error(numbers: &[f32]) -> Option<f64> {
    let (ends, matrices) = numbers.split_at(6);
    let [a, b] = [0, 3].map(|at| Vec3::from_slice(&ends[at..]));
    let bounds = Aabb {
        min: a.min(b),
        max: a.max(b),
    };
    let [frame, joint] = [0, MATRIX].map(|at| columns(&matrices[at..]));
    let place = well_conditioned(&frame)?;
    if !(a.is_finite() && b.is_finite()) || joint.iter().any(|column| !column.is_finite()) {
        return None;
    }
    let reach = a.abs().max(b.abs()).max_element();
    let mut map = JointMap::default();
    update(&mut map, &place, &joint, f64::from(reach));
    let farthest = map.reach(reach);
    if !(f32::MIN_POSITIVE * 1e9..1e36).contains(&farthest) {
        return None;
    }
    let allowed = Dyadic::from(10.0 * super::U) * Dyadic::from(farthest);
    let mut worst = 0.0_f64;
    for &level in levels() {
        let [low, high] = with_simd!(level, simd => image_with(simd, &map, &bounds));
        for axis in 0..3 {
            let end = |is_high: bool| {
                let term = |column: usize| {
                    let entry = map.columns[column][axis];
                    let at = if (entry >= 0.0) == is_high {
                        bounds.max
                    } else {
                        bounds.min
                    };
                    Dyadic::from(entry) * Dyadic::from(at[column])
                };
                (0..3).map(term).sum::<Dyadic>() + Dyadic::from(map.columns[3][axis])
            };
            for (found, is_high) in [(low[axis], false), (high[axis], true)] {
                worst = worst.max((Dyadic::from(found) - end(is_high)).abs().ratio(&allowed));
            }
        }
    }
    assert!(worst <= 1.0, "{worst} of ten roundings: {numbers:?}");
    Some(worst)
}

/// The ends of a box's image, computed like the kernel for boxes under joints does.
fn image_with<S: fearless_simd::Simd>(simd: S, map: &JointMap, bounds: &Aabb) -> [Vec3; 2] {
    let center = (bounds.min + bounds.max) * 0.5;
    let half = (bounds.max - bounds.min) * 0.5;
    let all = |v: Vec3| v.to_array().map(|x| fearless_simd::f32x8::splat(simd, x));
    use fearless_simd::prelude::*;
    let [low, high] = map.image(simd, &[all(center), all(half)]);
    let mut boxes = BoxLanes::default();
    boxes.store(low, high);
    let Aabb { min, max } = boxes.get(0);
    [min, max]
}

#[test]
fn images_of_boxes_are_off_by_much_of_what_is_allowed_and_never_by_more() {
    let climb = Climb {
        seed: 4,
        starts: 8,
        steps: 2000,
    };
    let (found, _) = climb.highest(
        |i, rng| {
            let mut numbers: Vec<f32> = (0..6).map(|_| rng.random_range(-1.0..1.0)).collect();
            numbers.extend(matrices(rng));
            if i.is_multiple_of(2) {
                // A box without extent. Its products all round the same way: each is just above half a unit in the last place of the sum.
                numbers[..6].fill(1.0);
                let joint = 6 + MATRIX;
                numbers[6..].fill(0.0);
                (0..3).for_each(|i| numbers[6 + 4 * i] = 1.0);
                numbers[joint..].fill(f32::EPSILON * 0.505);
                numbers[joint..joint + 3].fill(1.0);
            }
            numbers
        },
        image_error,
    );
    println!("image of a box: {found:.3} of ten roundings");
    assert!(is_as_known(found, 0.581), "{found} of ten roundings, known is 0.581");
}
