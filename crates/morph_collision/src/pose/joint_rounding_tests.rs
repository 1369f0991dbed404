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

/// The kind of joint weights.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// One joint per vertex.
    Rigid,
    /// Weights that sum to exactly 1.
    Smooth,
    /// Weights whose sum differs from 1 by rounding.
    Rounded,
    /// Any weights.
    Free,
}

/// A pose and its joints. Each vertex is a triangle and a leaf.
struct Case {
    pose: Pose,
    joints: JointMatrices,
}

/// `numbers` are the weight of the only target, the joints' matrices, and the vertices.
fn case(form: Form, numbers: &[f32]) -> Option<Case> {
    let (weight, rest) = numbers.split_first()?;
    let (joints, vertices) = rest.split_at(JOINTS * MATRIX);
    let matrix = |m: &[f32]| Affine3A::from_cols_array(&std::array::from_fn(|i| m[i]));
    let joints = JointMatrices::new(&joints.chunks_exact(MATRIX).map(matrix).collect::<Vec<_>>()).ok()?;
    let (mut base, mut displacements, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    for (i, vertex) in vertices.chunks_exact(VERTEX).enumerate() {
        base.push(Vec3::from_slice(vertex));
        // As intervals store it, so that only roundings add to a box.
        displacements.push(Aabb::from_points([Vec3::from_slice(&vertex[3..])]).coarse().min);
        let [x, y, z] = std::array::from_fn(|joint| vertex[6 + joint].abs().min(1.5));
        let few_bits = |weight: f32| (weight * 4096.0).round() / 4096.0;
        let whole = x + y + z;
        let [x, y, z] = match form {
            Form::Rigid => std::array::from_fn(|joint| f32::from(u8::from(joint == i % JOINTS))),
            Form::Smooth => {
                let (x, y) = (few_bits(x / whole), few_bits(y / whole));
                [x, y, (1.0 - x - y).max(0.0)]
            }
            Form::Rounded => [x / whole, y / whole, z / whole],
            Form::Free => [x, y, z],
        };
        weights.push([x, y, z, 0.0]);
    }
    let triangles: Vec<[u32; 3]> = (0..base.len() as u32).map(|i| [i; 3]).collect();
    let influences = Influences {
        joints: &vec![[0, 1, 2, 0]; base.len()],
        weights: &weights,
    };
    let model = MorphModel::skinned(&base, &triangles, &[displacements], JOINTS, &[influences]).ok()?;
    let options = BuildOptions::default().with_leaf_size(1).ok()?;
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &options)));
    pose.set_weights(&[*weight]).ok()?;
    pose.set_joints(&joints).ok()?;
    Some(Case { pose, joints })
}

fn frame_columns(place: &WorldFromModel) -> [DVec3; 4] {
    let linear = place.linear();
    [linear.x_axis, linear.y_axis, linear.z_axis, place.translation()]
}

impl Case {
    /// The largest share of its slack that a box which is fitted to vertices needs to contain them. They are rounded in `f64`.
    fn share_of_fitted(mut self, is_refitted: bool) -> Option<f64> {
        if is_refitted {
            self.pose.refit();
        }
        let mut nodes = Vec::new();
        self.pose.visit_nodes(|node| {
            // The box of the root is not fitted without a refit.
            if is_refitted || node.depth > 0 {
                nodes.push((node.bounds, node.triangles.to_vec()));
            }
            true
        });
        // Without a refit, the box of a leaf that is the root is not fitted.
        if nodes.is_empty() {
            return None;
        }
        let mut posed = self.pose.posed();
        let share = |(bounds, triangles): (Aabb, Vec<u32>)| {
            let point = |triangle| {
                let [vertex, ..] = posed.model.corners(triangle);
                posed.world_vertex(vertex).to_array().map(Dyadic::from)
            };
            let points: Vec<ExactPoint> = triangles.into_iter().map(point).collect();
            share(&bounds, posed.world_from_model.translation(), &points)
        };
        highest(nodes.into_iter().map(share))
    }

    /// The same for the box of the root, which comes from one box per joint. It must contain the images of exact positions, too.
    fn share_of_outer(mut self) -> Option<f64> {
        let vertices = 0..self.pose.bvh().model().vertex_count() as u32;
        let points: Vec<ExactPoint> = vertices.flat_map(|vertex| self.world_points(vertex)).collect();
        let mut posed = self.pose.posed();
        let root = posed.root();
        let share = share(&posed.node_box(root), posed.world_from_model.translation(), &points);
        assert_eq!(posed.blended().vertices, 0);
        share
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
                let image = exact_image(&self.joints.columns(influence.joint), &p);
                for (sum, image) in sum.iter_mut().zip(image) {
                    *sum = sum.clone() + Dyadic::from(influence.weight) * image;
                }
            }
            sum
        })
    }
}

fn highest(mut shares: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    shares.try_fold(f64::NEG_INFINITY, |most, share| Some(most.max(share?)))
}

/// The largest share of its slack that a box relative to `origin` needs to contain some points in the world. Without rounding, it would fit
/// them tightly; its slack is by how much it is larger than that.
fn share(bounds: &Aabb, origin: DVec3, points: &[ExactPoint]) -> Option<f64> {
    if !bounds.min.is_finite() || !bounds.max.is_finite() {
        return None;
    }
    let of_axis = |axis: usize| {
        let along = |point: &ExactPoint| point[axis].clone() - Dyadic::from(origin[axis]);
        let [least, most] = [points.iter().map(along).min()?, points.iter().map(along).max()?];
        let [low, high] = [bounds.min, bounds.max].map(|end| Dyadic::from(end[axis]));
        let slack = (high.clone() - low.clone()) - (most.clone() - least.clone());
        let room = (least - low).min(high - most);
        Some(1.0 - 2.0 * room.ratio(&slack))
    };
    highest((0..3).map(of_axis))
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

fn search(boxes: &str, known: &[(Form, f64)], share: impl Fn(Form, &[f32]) -> Option<f64>) {
    let climb = Climb {
        seed: 7,
        starts: 9,
        steps: 400,
    };
    let highest = |form: Form| {
        let share = |numbers: &[f32]| {
            let share = share(form, numbers)?;
            assert!(share <= 1.0, "{boxes}, {form:?} {share}: {numbers:?}");
            Some(share)
        };
        climb.highest(start, share).0
    };
    let found: Vec<f64> = known.iter().map(|(form, _)| highest(*form)).collect();
    println!("{boxes}: {found:.3?} of the slack");
    for ((form, known), found) in known.iter().zip(found) {
        assert!(
            is_as_known(found, *known),
            "{boxes}, {form:?}: {found} of the slack, known is {known}"
        );
    }
}

/// Half is all that a box can need, apart from differences between its two ends, as docs/numerics.md shows.
#[test]
fn fitted_boxes_need_half_of_their_slack_and_never_more() {
    for (boxes, is_refitted) in [("fitted", false), ("refitted", true)] {
        let known = [(Form::Rigid, 0.5), (Form::Free, 0.5)];
        search(boxes, &known, |form, numbers| {
            case(form, numbers)?.share_of_fitted(is_refitted)
        });
    }
}

/// The ends of a box may come from different joints, so one vertex may be as far out as an end allows while the other end has all the slack.
#[test]
fn outer_boxes_need_much_of_their_slack_and_never_more() {
    let known = [
        (Form::Rigid, 1.0),
        (Form::Smooth, 1.0),
        (Form::Rounded, 1.0),
        (Form::Free, 1.0),
    ];
    search("outer", &known, |form, numbers| {
        let vertices = if form == Form::Rigid { JOINTS } else { 1 };
        case(form, &numbers[..numbers.len() - (VERTICES - vertices) * VERTEX])?.share_of_outer()
    });
}
