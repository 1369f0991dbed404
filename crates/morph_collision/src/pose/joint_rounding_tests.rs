//! Measures, in exact arithmetic, how close vertices under joints come to the ends of the boxes around them.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};
use morph_collision_testkit::oracle::Dyadic;
use morph_collision_testkit::search::{Climb, is_as_known};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::Pose;
use crate::bounds::{Aabb, ExactPoint, WorldFromModel, adjugate, exact_image};
use crate::joints::JointMatrices;
use crate::model::{Influences, MorphModel};
use crate::tree::{BuildOptions, MorphBvh};

/// Just above half a unit in the last place of 1.
const TINY: f32 = f32::EPSILON * 0.505;
const JOINTS: usize = 3;
const VERTICES: usize = 4;
/// Number of values per joint: the columns of its matrix.
const MATRIX: usize = 12;
/// Number of values per vertex: its base position, its displacement, and the weights of the joints.
const VERTEX: usize = 6 + JOINTS;

/// The kind of joint weights, and what the boxes contain.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// One joint per vertex.
    Rigid,
    /// Weights that sum to exactly 1.
    Smooth,
    /// Weights whose sum differs from 1 by rounding.
    Rounded,
    /// Any weights. The difference of their sum to 1 counts as a joint.
    Free,
    /// Boxes computed with slightly different joints.
    Kept,
    /// Boxes around two vertices each, which differ in their weights for two joints.
    Spans,
}

/// A pose, and its joints before and now.
struct Case {
    form: Form,
    pose: Pose,
    joints: [JointMatrices; 2],
}

/// `numbers` are the weight of the only target, the joints' matrices now, their matrices before, and the vertices.
fn case(form: Form, numbers: &[f32]) -> Option<Case> {
    let (weight, rest) = numbers.split_first()?;
    let (joints, rest) = rest.split_at(JOINTS * MATRIX);
    let (before, vertices) = rest.split_at(JOINTS * MATRIX);
    let matrices = |numbers: &[f32]| {
        let matrix = |m: &[f32]| Affine3A::from_cols_array(&std::array::from_fn(|i| m[i]));
        JointMatrices::new(&numbers.chunks_exact(MATRIX).map(matrix).collect::<Vec<_>>()).ok()
    };
    let joints = [
        matrices(if form == Form::Kept { before } else { joints })?,
        matrices(joints)?,
    ];
    let (mut base, mut displacements, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    for (i, vertex) in vertices.chunks_exact(VERTEX).enumerate() {
        let moves = if form == Form::Spans {
            &vertices[i / 2 * 2 * VERTEX..]
        } else {
            vertex
        };
        base.push(Vec3::from_slice(moves));
        // As intervals store it, so that only roundings add to a box.
        displacements.push(Aabb::from_points([Vec3::from_slice(&moves[3..])]).coarse().min);
        let [x, y, z] = std::array::from_fn(|joint| vertex[6 + joint].abs().min(1.5));
        let few_bits = |weight: f32| (weight * 4096.0).round() / 4096.0;
        let whole = x + y + z;
        let [x, y, z] = match form {
            Form::Rigid | Form::Kept => std::array::from_fn(|joint| f32::from(u8::from(joint == i % JOINTS))),
            // All vertices are in the same cluster.
            Form::Spans => {
                let x = 0.55 + 0.35 * x / (x + y);
                [few_bits(x), 1.0 - few_bits(x), 0.0]
            }
            Form::Smooth => {
                let (x, y) = (few_bits(x / whole), few_bits(y / whole));
                [x, y, (1.0 - x - y).max(0.0)]
            }
            Form::Rounded => [x / whole, y / whole, z / whole],
            Form::Free => [x, y, z],
        };
        weights.push([x, y, z, 0.0]);
    }
    let triangles: Vec<[u32; 3]> = match form {
        Form::Spans => (0..VERTICES as u32 / 2)
            .map(|i| [2 * i, 2 * i + 1, 2 * i + 1])
            .collect(),
        _ => (0..VERTICES as u32).map(|i| [i; 3]).collect(),
    };
    let influences = Influences {
        joints: &[[0, 1, 2, 0]; VERTICES],
        weights: &weights,
    };
    let model = MorphModel::skinned(&base, &triangles, &[displacements], JOINTS, &[influences]).ok()?;
    let options = BuildOptions::default().with_leaf_size(1).ok()?;
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &options)));
    pose.set_weights(&[*weight]).ok()?;
    Some(Case { form, pose, joints })
}

/// The columns of a box's frame, which must be the space of a joint.
fn frame_columns(place: &WorldFromModel) -> [DVec3; 4] {
    let linear = place.linear();
    [linear.x_axis, linear.y_axis, linear.z_axis, place.translation()]
}

impl Case {
    /// The largest share of its slack that a box needs to contain its vertices, both rounded and exact.
    ///
    /// Without rounding, a box would fit its vertices tightly. Its slack is by how much it is larger than that.
    fn share(mut self) -> Option<f64> {
        let mut share = f64::NEG_INFINITY;
        for (bounds, place, triangle) in self.boxes()? {
            if !bounds.min.is_finite() || !bounds.max.is_finite() {
                return None;
            }
            let columns = frame_columns(&place);
            // All values are multiplied by the determinant.
            let (rows, determinant) = adjugate(&columns);
            let corners = self.pose.posed().model.corners(triangle);
            let points: Vec<ExactPoint> = corners.iter().flat_map(|&corner| self.world_points(corner)).collect();
            for axis in 0..3 {
                let along = |point: &ExactPoint| {
                    let offset = |c: usize| point[c].clone() - Dyadic::from(columns[3][c]);
                    (0..3).map(|c| rows[axis][c].clone() * offset(c)).sum::<Dyadic>()
                };
                let [least, most] = [points.iter().map(along).min()?, points.iter().map(along).max()?];
                let [low, high] = [bounds.min, bounds.max].map(|end| Dyadic::from(end[axis]) * determinant.clone());
                let slack = (high.clone() - low.clone()) - (most.clone() - least.clone());
                let room = (least - low).min(high - most);
                share = share.max(1.0 - 2.0 * room.ratio(&slack));
            }
        }
        Some(share)
    }

    /// For each leaf, its box, the box's frame, and its triangle.
    fn boxes(&mut self) -> Option<Vec<(Aabb, WorldFromModel, u32)>> {
        self.pose.set_joints(&self.joints[0]).ok()?;
        self.pose.visit_nodes(|_| true);
        let blended = self.pose.posed().blended().volumes;
        self.pose.set_joints(&self.joints[1]).ok()?;
        let mut boxes = Vec::new();
        self.pose.visit_nodes(|node| {
            if let (true, [triangle], Some(place)) = (node.is_leaf, node.triangles, node.world_from_bounds) {
                boxes.push((node.bounds, place, *triangle));
            }
            true
        });
        let was_kept = self.pose.posed().blended().volumes == blended;
        let posed = self.pose.posed();
        let is_a_joints = posed.world_from_model.is_well_conditioned();
        (is_a_joints && boxes.len() > 1 && (was_kept || self.form != Form::Kept)).then_some(boxes)
    }

    /// The exact images of a vertex: one with its morphed position rounded, one without rounding.
    fn world_points(&mut self, vertex: u32) -> [ExactPoint; 2] {
        let posed = self.pose.posed();
        let rounded = posed
            .model
            .blend_vertex(vertex, posed.weights)
            .to_array()
            .map(Dyadic::from);
        let base = posed.model.base(vertex);
        let exact: ExactPoint = std::array::from_fn(|axis| {
            let moved = posed.model.displacements(vertex).map(|d| {
                let weight = posed.weights.all()[usize::from(d.target)];
                Dyadic::from(weight) * Dyadic::from(d.delta[axis])
            });
            moved.sum::<Dyadic>() + Dyadic::from(base[axis])
        });
        [rounded, exact].map(|p| {
            let mut sum: ExactPoint = std::array::from_fn(|_| Dyadic::zero());
            for influence in posed.model.skin().into_iter().flat_map(|skin| skin.influences(vertex)) {
                let image = exact_image(&self.joints[1].columns(influence.joint), &p);
                for (sum, image) in sum.iter_mut().zip(image) {
                    *sum = sum.clone() + Dyadic::from(influence.weight) * image;
                }
            }
            sum
        })
    }
}

/// Whether the boxes of whole bodies, as spaces see them, contain the exact preimages of all vertices.
#[test]
fn boxes_in_other_spaces_hold_exact_preimages() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let (mut checked, mut closest) = (0, f64::INFINITY);
    for form in [Form::Rigid, Form::Smooth, Form::Rounded, Form::Free] {
        for i in 0..60 {
            let numbers = start(i, &mut rng);
            let Some(mut case) = case(form, &numbers) else {
                continue;
            };
            case.pose.set_joints(&case.joints[1]).unwrap();
            // Coordinates of the mesh, and some far larger than that.
            let reach = numbers[numbers.len() - VERTEX].abs() * [1.0, 1e3][i % 2] + f32::MIN_POSITIVE;
            let mut space: [f32; MATRIX] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
            (0..3).for_each(|i| space[4 * i] += 1.5);
            space[9..].iter_mut().for_each(|t| *t *= reach);
            let Ok(place) = WorldFromModel::new(Affine3A::from_cols_array(&space)) else {
                continue;
            };
            let bounds = case.pose.local_bounds(&place);
            let columns = frame_columns(&place);
            let (rows, determinant) = adjugate(&columns);
            for vertex in 0..VERTICES as u32 {
                for point in case.world_points(vertex) {
                    for axis in 0..3 {
                        let offset = |c: usize| point[c].clone() - Dyadic::from(columns[3][c]);
                        let along = (0..3).map(|c| rows[axis][c].clone() * offset(c)).sum::<Dyadic>();
                        let [low, high] =
                            [bounds.min, bounds.max].map(|end| Dyadic::from(end[axis]) * determinant.clone());
                        let room = (along.clone() - low).min(high - along);
                        assert!(
                            !room.is_negative(),
                            "{form:?} {i}: {bounds:?} of {numbers:?} in {space:?}"
                        );
                        let size = Dyadic::from(bounds.size().max_element()) * determinant.clone();
                        closest = closest.min(room.ratio(&size));
                        checked += 1;
                    }
                }
            }
        }
    }
    println!("{checked} checked, closest at {closest:e} of the size");
    assert!(checked > 3000 && closest < 1e-5, "{checked} {closest}");
}

fn start(i: usize, rng: &mut Pcg64Mcg) -> Vec<f32> {
    let scale = 2_f32.powi(rng.random_range(-20..20));
    let distance = 2_f32.powi(rng.random_range(-3..6));
    let mut joints: Vec<f32> = (0..JOINTS * MATRIX).map(|_| rng.random_range(-1.0..1.0)).collect();
    for matrix in joints.chunks_exact_mut(MATRIX) {
        // Well away from singular.
        (0..3).for_each(|i| matrix[4 * i] += 2.0);
        matrix[9..].iter_mut().for_each(|t| *t *= distance * scale);
    }
    let one_way = i.is_multiple_of(3);
    if one_way {
        // The frame is the mesh's space, and the values added to a product are just above half a unit in its last place.
        for (joint, matrix) in joints.chunks_exact_mut(MATRIX).enumerate() {
            matrix.fill(if joint == 0 { 0.0 } else { TINY });
            (0..3).for_each(|row| matrix[if joint == 0 { 4 * row } else { row }] = 1.0 + 0.01 * joint as f32);
        }
    }
    let mut numbers = vec![rng.random_range(-1.0..1.0)];
    numbers.extend(&joints);
    numbers.extend(&joints);
    let at: [f32; 3] = std::array::from_fn(|_| {
        if one_way {
            1.0
        } else {
            rng.random_range(-1.0..1.0) * scale
        }
    });
    for vertex in 0..VERTICES {
        // In every other start the vertices are nearly equal, so that none of them adds to another's slack.
        let spread = if i.is_multiple_of(2) { 1.0 } else { 1e-3 };
        numbers.extend(at.map(|x| x + x * spread * vertex as f32));
        numbers.extend((0..3).map(|_| rng.random_range(-0.1..0.1) * scale));
        numbers.extend((0..JOINTS).map(|_| rng.random_range(0.0..1.0)));
    }
    numbers
}

fn search(form: Form, known: f64) {
    let climb = Climb {
        seed: 7,
        starts: 9,
        steps: 400,
    };
    let share = |numbers: &[f32]| {
        let share = case(form, numbers)?.share()?;
        assert!(share <= 1.0, "{form:?} {share}: {numbers:?}");
        Some(share)
    };
    let (found, _) = climb.highest(start, share);
    println!("{form:?}: {found:.3} of the slack");
    assert!(
        is_as_known(found, known),
        "{form:?}: {found} of the slack, known is {known}"
    );
}

#[test]
fn boxes_under_joints_need_much_of_their_slack_and_never_more() {
    for (form, known) in [
        (Form::Rigid, 0.192),
        (Form::Smooth, 0.092),
        (Form::Rounded, 0.118),
        (Form::Free, 0.062),
        (Form::Spans, 0.049),
    ] {
        search(form, known);
    }
}

#[test]
fn kept_boxes_hold_what_joints_moved_by_their_rounding() {
    search(Form::Kept, 0.333);
}
