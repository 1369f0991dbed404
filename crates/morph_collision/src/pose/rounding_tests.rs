//! Measures, in exact arithmetic, how close the errors of blended boxes and of their vertices come to the widening.

use std::sync::Arc;

use fearless_simd::Simd;
use glam::Vec3;
use morph_collision_models::generated::random::random_blob;
use morph_collision_testkit::oracle::Dyadic;
use morph_collision_testkit::search::{Climb, is_as_known};
use rand::RngExt;

use super::blend::{blend_change, blend_group, evaluate, max_widening};
use super::{Pose, Posed};
use crate::bounds::{Aabb, BoxLanes, ExactPoint, holds, lack, with_simd};
use crate::model::MorphModel;
use crate::tree::{BuildOptions, MorphBvh};

const VERTICES: usize = 2;
/// Number of values per target.
const TARGET: usize = 1 + 3 * VERTICES;

/// How a box is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// Only from intervals: no weight is positive.
    Intervals,
    References,
    /// The first weight uses up the budget, so that the others use intervals.
    Rests,
}

/// The share of the root's widening that its vertices need, both rounded and exact.
///
/// `numbers` are the vertices' base coordinates, then the weight and displacements of each target.
fn ratio(form: Form, numbers: &[f32]) -> Option<f64> {
    let (base, targets) = numbers.split_at(3 * VERTICES);
    let vectors = |numbers: &[f32]| numbers.chunks_exact(3).map(Vec3::from_slice).collect::<Vec<_>>();
    let displacements: Vec<_> = targets.chunks_exact(TARGET).map(|t| vectors(&t[1..])).collect();
    let weights = targets.chunks_exact(TARGET).map(|t| t[0]);
    let weights: Vec<f32> = match form {
        Form::Intervals => weights.map(|weight| -weight.abs()).collect(),
        Form::References => weights.collect(),
        Form::Rests => weights.enumerate().map(|(i, w)| if i == 0 { 3.0 } else { w }).collect(),
    };
    let model = MorphModel::from_displacements(&vectors(base), &[[0, 1, 1]], &displacements).ok()?;
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    pose.set_weights(&weights).ok()?;
    let share = share(&pose.posed());
    assert!(
        share.is_some_and(|share| share <= 1.0),
        "{form:?} {share:?}: {numbers:?}"
    );
    share
}

/// Returns `None` if a vertex is outside.
fn share(posed: &Posed<'_>) -> Option<f64> {
    with_simd!(posed.level, simd => share_with(simd, posed))
}

fn share_with<S: Simd>(simd: S, posed: &Posed<'_>) -> Option<f64> {
    let tables = posed.tables.group(0);
    let (mut bare, mut widened) = (BoxLanes::default(), BoxLanes::default());
    blend_group(simd, tables, posed.weights, &mut widened);
    let (by, _) = evaluate(simd, tables, posed.weights, &mut bare);
    let mut share = f64::NEG_INFINITY;
    for vertex in 0..posed.model.vertex_count() as u32 {
        let rounded = posed
            .model
            .blend_vertex(vertex, posed.weights)
            .to_array()
            .map(Dyadic::from);
        for point in [rounded, exact_vertex(posed, vertex)] {
            if !holds(&widened.get(0), &point) {
                return None;
            }
            share = share.max(lack(&bare.get(0), &point) / f64::from(by));
        }
    }
    Some(share)
}

fn exact_vertex(posed: &Posed<'_>, vertex: u32) -> ExactPoint {
    let base = posed.model.base(vertex);
    std::array::from_fn(|axis| {
        let moved = posed.model.displacements(vertex).map(|d| {
            let weight = posed.weights.all()[usize::from(d.target)];
            Dyadic::from(weight) * Dyadic::from(d.delta[axis])
        });
        moved.sum::<Dyadic>() + Dyadic::from(base[axis])
    })
}

/// Searches for the largest share of each form, and compares it with the known result next to the form.
fn search(all: [(Form, f64); 3]) {
    for (form, known) in all {
        let mut highest = f64::NEG_INFINITY;
        for targets in [2, 12] {
            let climb = Climb {
                seed: 6,
                starts: 4,
                steps: 180,
            };
            let (found, _) = climb.highest(
                |i, rng| {
                    let scale = 2_f32.powi(rng.random_range(-40..40));
                    let mut numbers: Vec<f32> = (0..3 * VERTICES).map(|_| rng.random_range(-1.0..1.0)).collect();
                    // Products just above half a unit in the last place of the base: every sum rounds up.
                    let one_way = i % 2 == 0;
                    if one_way {
                        numbers.fill(1.0);
                    }
                    for _ in 0..targets {
                        numbers.push(rng.random_range(0.0..1.0));
                        numbers.extend((0..3 * VERTICES).map(|_| rng.random_range(-1.0..1.0)));
                        if one_way {
                            let target = numbers.len() - TARGET;
                            numbers[target..].fill(2_f32.powi(-24) * 1.01);
                            numbers[target] = 1.0;
                        }
                    }
                    for (i, x) in numbers.iter_mut().enumerate() {
                        if i < 3 * VERTICES || (i - 3 * VERTICES) % TARGET >= 1 {
                            *x *= scale;
                        }
                    }
                    numbers
                },
                |numbers| ratio(form, numbers),
            );
            highest = highest.max(found);
        }
        println!("{form:?}: {highest:.3} of the widening");
        assert!(
            is_as_known(highest, known),
            "{form:?}: {highest} of the widening, known is {known}"
        );
    }
}

#[test]
fn boxes_need_much_of_their_widening_and_never_more() {
    search([
        (Form::Intervals, 0.261),
        (Form::References, 0.262),
        (Form::Rests, 0.262),
    ]);
}

/// Collapsed bodies use the bound for all groups; ordinary bodies skip it.
#[test]
fn no_group_is_widened_by_more_than_the_bound_for_all() {
    let mesh = random_blob(3, 2, 12, 0.5);
    let model = MorphModel::from_displacements(&mesh.positions, &mesh.triangles, &mesh.targets).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    for weight in [-1.0, 0.3, 40.0] {
        pose.set_weights(&[weight; 12]).unwrap();
        let posed = pose.posed();
        let most = max_widening(posed.model, posed.weights);
        for group in 0..posed.topology.group_count() {
            let (tables, mut boxes) = (posed.tables.group(group), BoxLanes::default());
            let (by, _) = with_simd!(posed.level, simd => evaluate(simd, tables, posed.weights, &mut boxes));
            assert!(by <= most, "{by}, {most} for all");
            if group == 0 {
                // Each target counts as three products, not one.
                assert!((1.8..2.5).contains(&(most / by)), "{by}, {most} for all");
            }
        }
        assert_eq!(posed.rounding(posed.model.base_reach()), 0.0);
        assert_eq!(posed.rounding(0.0), most);
    }
}

/// Two vertices at `size` and opposite to it, and targets that move both by `by`, with these weights.
fn pair(size: f32, by: f32, weights: &[f32]) -> Pose {
    let base = [Vec3::splat(size), Vec3::splat(-size)];
    let targets = vec![[Vec3::splat(by); 2]; weights.len()];
    let model = MorphModel::from_displacements(&base, &[[0, 1, 1]], &targets).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    pose.set_weights(weights).unwrap();
    pose
}

/// The root's box, how much it is widened, and the bound on its coordinates.
fn root(posed: &Posed<'_>) -> (Aabb, f32, f32) {
    let (tables, mut boxes) = (posed.tables.group(0), BoxLanes::default());
    let (by, _) = with_simd!(posed.level, simd => evaluate(simd, tables, posed.weights, &mut boxes));
    let reach = with_simd!(posed.level, simd => blend_group(simd, tables, posed.weights, &mut boxes));
    (boxes.get(0), by, reach)
}

#[test]
fn a_box_reaches_no_farther_than_its_bound_at_any_size() {
    for size in [1e-30, 1.0, 1e8, 1e30] {
        let (bounds, _, reach) = root(&pair(size, 0.1 * size, &[1.0, 0.5]).posed());
        let farthest = bounds.magnitude().max_element();
        assert!(farthest <= reach && reach < 1.05 * farthest, "{farthest}, {reach}");
    }
}

/// Targets that move one vertex towards the other, so that a reference is tighter than an interval.
#[test]
fn references_and_intervals_round_equally_often() {
    let targets = vec![[Vec3::splat(-0.1), Vec3::ZERO]; 12];
    let model = MorphModel::from_displacements(&[Vec3::ONE, Vec3::NEG_ONE], &[[0, 1, 1]], &targets).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    assert_eq!(pose.posed().tables.group(0).reference_count, 12);
    let by = [0.01, -0.01].map(|weight| {
        pose.set_weights(&[weight; 12]).unwrap();
        root(&pose.posed()).1
    });
    assert_eq!(by[0], by[1]);
}

/// Half of the smallest number is a vertex that no `f32` is.
#[test]
fn boxes_hold_vertices_whose_products_underflow() {
    let smallest = f32::from_bits(1);
    for weights in [[0.5, 0.5], [-0.5, -0.5], [0.5, -0.25]] {
        let share = share(&pair(smallest, smallest, &weights).posed());
        assert!(share.is_some_and(|share| share <= 1.0), "{weights:?}: {share:?}");
    }
}

#[test]
fn changes_are_widened_by_the_roundings_of_both_poses() {
    let change = |weights: [&[f32]; 2]| {
        // A power of two, which intervals store without rounding.
        let mut pose = pair(1.0, 2.0_f32.powi(-10), weights[0]);
        let (posed, mut moved) = (pose.posed(), BoxLanes::default());
        let tables = posed.tables.group(0);
        with_simd!(posed.level, simd => blend_change(simd, tables, weights, &mut moved));
        moved.get(0)
    };
    let mut weights = [0.5; 14];
    weights[10..].fill(0.0);
    let before = weights;
    weights[..3].fill(0.25);
    let moved = change([&before, &weights]);
    // Ten active targets, of which three change, and eight roundings more, for coordinates of up to 1.005.
    let expected = (2.0 * 10.0 + 2.0 * 2.0 * 3.0 + 8.0) * (f32::EPSILON / 2.0) * 1.005;
    let by = 0.5 * moved.size().max_element();
    assert!((1.0..1.1).contains(&(by / expected)), "{by}, {expected}");
    // Alike roundings do not matter where nothing changes.
    assert_eq!(change([&before, &before]).size(), Vec3::ZERO);
}
