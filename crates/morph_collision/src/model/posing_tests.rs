//! Blocks are posed with the bits of the definition of one vertex, written out here once more.

use fearless_simd::Level;
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::blocks::{BLOCK, block_and_lane};
use super::influences::Influence;
use super::{BlendedBlock, Influences, MorphModel, PlacedBlock, Weights};
use crate::bounds::{Kernel, with_simd};
use crate::joints::JointMatrices;

/// A mesh as it is passed to the model.
struct Mesh {
    base: Vec<Vec3>,
    targets: Vec<Vec<Vec3>>,
    joint_count: usize,
    /// By set and vertex.
    joints: Vec<Vec<[u16; 4]>>,
    weights: Vec<Vec<[f32; 4]>>,
}

/// A number of any sign and size, often 0 or -0.
fn number(rng: &mut Pcg64Mcg) -> f32 {
    match rng.random_range(0..8) {
        0 => 0.0,
        1 => -0.0,
        2 => rng.random_range(-1.0..1.0) * 1e-44,
        3 => rng.random_range(-1.0..1.0) * 1e30,
        _ => rng.random_range(-2.0..2.0),
    }
}

fn vector(rng: &mut Pcg64Mcg) -> Vec3 {
    Vec3::from([(); 3].map(|()| number(rng)))
}

impl Mesh {
    fn random(rng: &mut Pcg64Mcg) -> Self {
        let vertices = rng.random_range(3..200);
        let base = (0..vertices).map(|_| vector(rng)).collect();
        let targets = (0..rng.random_range(0..20)).map(|_| {
            let moved = [0.0, 0.05, 0.5, 1.0][rng.random_range(0..4)];
            let mut delta = || {
                if rng.random_bool(moved) {
                    vector(rng)
                } else {
                    Vec3::ZERO
                }
            };
            (0..vertices).map(|_| delta()).collect()
        });
        let targets = targets.collect();
        // Few joints in few orders, as in characters, or any.
        let (joint_count, sets) = (rng.random_range(1..9), rng.random_range(0..6));
        let used = [0.1, 0.3, 1.0][rng.random_range(0..3)];
        let is_ordered = rng.random_bool(0.5);
        let mut joints = vec![Vec::new(); sets];
        let mut weights = vec![Vec::new(); sets];
        for set in 0..sets {
            for _ in 0..vertices {
                let mut of = [(); 4].map(|()| rng.random_range(0..joint_count) as u16);
                if is_ordered {
                    of.sort_unstable();
                }
                joints[set].push(of);
                weights[set].push(of.map(|_| match rng.random_range(0..6) {
                    _ if !rng.random_bool(used) => 0.0,
                    0 => -0.0,
                    1 => 1.0,
                    2 => 1e-42,
                    _ => rng.random_range(0.0..1.0),
                }));
            }
        }
        Self {
            base,
            targets,
            joint_count,
            joints,
            weights,
        }
    }

    /// Every vertex has one joint, with weight 1.
    fn make_rigid(&mut self, rng: &mut Pcg64Mcg) {
        let first = rng.random_range(0..self.joint_count) as u16;
        self.joints = vec![
            self.base
                .iter()
                .map(|at| [if at.x > 1.9 { 0 } else { first }; 4])
                .collect(),
        ];
        self.weights = vec![vec![[1.0, 0.0, 0.0, 0.0]; self.base.len()]];
    }

    fn model(&self) -> MorphModel {
        let sets = self.joints.iter().zip(&self.weights);
        let sets: Vec<Influences<'_>> = sets.map(|(joints, weights)| Influences { joints, weights }).collect();
        MorphModel::skinned(&self.base, &[[0, 1, 2]], &self.targets, self.joint_count, &sets).unwrap()
    }

    /// The influences of a vertex in slot order.
    fn influences(&self, vertex: usize) -> Vec<Influence> {
        let sets = self.joints.iter().zip(&self.weights);
        let slots = sets.flat_map(|(joints, weights)| joints[vertex].into_iter().zip(weights[vertex]));
        let slots = slots.filter(|(_, weight)| *weight > 0.0);
        slots.map(|(joint, weight)| Influence { joint, weight }).collect()
    }

    /// The definition of a vertex before joints and placement. The base's -0 counts as 0.
    fn blended(&self, vertex: usize, weights: &[f32]) -> [f32; 3] {
        [0, 1, 2].map(|axis| {
            let mut sum = self.base[vertex][axis] + 0.0;
            for (target, &weight) in self.targets.iter().zip(weights) {
                if weight != 0.0 && target[vertex] != Vec3::ZERO {
                    sum += weight * target[vertex][axis];
                }
            }
            sum
        })
    }

    /// The definition of a vertex that joints have placed.
    fn placed(&self, vertex: usize, position: [f32; 3], joints: &[Affine3A]) -> [f64; 4] {
        let [x, y, z] = position.map(f64::from);
        let coordinate = |axis: usize| {
            let mut matrix = [0.0; 4];
            for Influence { joint, weight } in self.influences(vertex) {
                let of = joints[usize::from(joint)];
                let columns = [of.matrix3.x_axis, of.matrix3.y_axis, of.matrix3.z_axis, of.translation];
                for (entry, column) in matrix.iter_mut().zip(columns) {
                    *entry += f64::from(column[axis]) * f64::from(weight);
                }
            }
            ((matrix[0] * x + matrix[1] * y) + matrix[2] * z) + matrix[3]
        };
        [coordinate(0), coordinate(1), coordinate(2), 0.0]
    }
}

/// The positions of a block before joints, and after.
type Posed = (BlendedBlock, PlacedBlock);

fn posed(level: Level, model: &MorphModel, block: usize, weights: &Weights, joints: &JointMatrices) -> Posed {
    let (mut blended, mut placed) = ([[f32::NAN; 4]; BLOCK], [[f64::NAN; 4]; BLOCK]);
    with_simd!(level, simd => {
        model.blend_points(simd, block, weights, &mut blended);
        let positions = model.blend_block(simd, block, weights);
        model.skin().unwrap().place_block(simd, block, positions, joints, &mut placed);
    });
    (blended, placed)
}

fn matrix(rng: &mut Pcg64Mcg) -> Affine3A {
    let mut column = || Vec3A::from(vector(rng));
    Affine3A {
        matrix3: Mat3A::from_cols(column(), column(), column()),
        translation: column(),
    }
}

#[test]
fn blocks_have_the_bits_of_the_definition_of_one_vertex() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let (mut rows, mut whole, mut few, mut many, mut most) = (0, 0, 0, 0, 0);
    for case in 0..300 {
        let mut mesh = Mesh::random(&mut rng);
        if case % 4 == 0 {
            mesh.make_rigid(&mut rng);
        }
        let model = mesh.model();
        let active = [0.05, 0.5, 1.0][rng.random_range(0..3)];
        let mut weight = || {
            if rng.random_bool(active) {
                rng.random_range(-2.0..2.0)
            } else {
                -0.0
            }
        };
        let all: Vec<f32> = mesh.targets.iter().map(|_| weight()).collect();
        let weights = Weights::new(&all);
        let matrices: Vec<Affine3A> = (0..mesh.joint_count).map(|_| matrix(&mut rng)).collect();
        let joints = JointMatrices::new(&matrices).unwrap();
        let mut seen = vec![false; model.vertex_count()];
        let blocks = |level| -> Vec<Posed> {
            let of = |block| posed(level, &model, block, &weights, &joints);
            (0..model.vertex_count().div_ceil(BLOCK)).map(of).collect()
        };
        let by_level: Vec<Vec<Posed>> = Kernel::available().iter().map(|kernel| blocks(kernel.level)).collect();
        for (source, &vertex) in model.welded_from_source().iter().enumerate() {
            let (block, lane) = block_and_lane(vertex);
            seen[vertex as usize] = true;
            let blended = mesh.blended(source, &all);
            let placed = mesh.placed(source, blended, &matrices);
            for (of_level, kernel) in by_level.iter().zip(Kernel::available()) {
                let (of_block, placed_block) = &of_level[block];
                let about = format!("case {case}, vertex {source}, {}", kernel.name());
                let [x, y, z] = blended;
                assert_eq!(
                    of_block[lane].map(f32::to_bits),
                    [x, y, z, 0.0].map(f32::to_bits),
                    "{about}"
                );
                assert_eq!(
                    placed_block[lane].map(f64::to_bits),
                    placed.map(f64::to_bits),
                    "{about}"
                );
            }
            // One vertex alone.
            let alone = model.blend_vertex(vertex, &weights);
            assert_eq!(alone.to_array().map(f32::to_bits), blended.map(f32::to_bits));
            let skin = model.skin().unwrap();
            let alone = with_simd!(Kernel::default().level, simd => skin.place(simd, vertex, alone, &joints));
            assert_eq!(alone.map(f64::to_bits), placed.map(f64::to_bits));
            let mut influences: Vec<Influence> = skin.influences(vertex).collect();
            let expected = mesh.influences(source);
            if influences != expected {
                influences.swap(0, 1);
            }
            assert_eq!(influences, expected);
            most = most.max(expected.len());
        }
        assert!(seen.iter().all(|seen| *seen), "every number is a vertex");
        for block in 0..model.vertex_count().div_ceil(BLOCK) {
            let of_block = model.skin().unwrap().rows().of_block(block);
            rows += of_block.len();
            whole += usize::from(of_block.iter().any(|row| row.is_whole));
            let (_, targets, _) = model.block(block);
            *(if weights.are_few_of(targets.len()) {
                &mut few
            } else {
                &mut many
            }) += 1;
        }
    }
    assert!(
        whole > 200 && few > 500 && many > 500 && most > 18,
        "{whole} {few} {many} {most}"
    );
    assert!(rows > 10_000, "{rows}");
}

/// The joints of a model's rows. Vertices of the only block are moved by these joints, in this order. The last vertex counts more than
/// once, because unused lanes repeat it.
fn rows(of_vertices: &[&[u16]]) -> Vec<u16> {
    let mut slots = [vec![[0; 4]; of_vertices.len()], vec![[0; 4]; of_vertices.len()]];
    let mut weights = [vec![[0.0; 4]; of_vertices.len()], vec![[0.0; 4]; of_vertices.len()]];
    for (vertex, joints) in of_vertices.iter().enumerate() {
        for (slot, &joint) in joints.iter().enumerate() {
            slots[slot / 4][vertex][slot % 4] = joint;
            weights[slot / 4][vertex][slot % 4] = 0.1;
        }
    }
    let base: Vec<Vec3> = (0..of_vertices.len()).map(|x| Vec3::X * x as f32).collect();
    let [first, second] = [0, 1].map(|set| Influences {
        joints: &slots[set],
        weights: &weights[set],
    });
    let none: [Vec<Vec3>; 0] = [];
    let model = MorphModel::skinned(&base, &[[0; 3]], &none, 10, &[first, second]).unwrap();
    let rows = model.skin().unwrap().rows().of_block(0);
    rows.iter().map(|row| row.joint).collect()
}

#[test]
fn a_joint_has_several_rows_only_if_orders_disagree() {
    let check = |of_vertices: &[&[u16]], expected: &[u16]| assert_eq!(rows(of_vertices), expected, "{of_vertices:?}");
    check(&[&[]], &[]);
    check(&[&[5], &[5], &[5]], &[5]);
    check(&[&[5, 3], &[3], &[5]], &[5, 3]);
    // The first two may be swapped.
    check(&[&[5, 3], &[3, 5], &[5], &[7, 5]], &[5, 7, 3]);
    check(&[&[5, 3, 1], &[3, 5, 2], &[1, 2]], &[3, 5, 1, 2]);
    check(&[&[1, 2, 3, 4], &[4, 5, 6], &[6, 7]], &[7, 1, 2, 3, 4, 5, 6]);
    check(&[&[1, 2, 3], &[1, 3, 2]], &[1, 3, 2, 3]);
    check(&[&[1, 1], &[1]], &[1, 1]);
    check(&[&[1, 2, 1], &[1, 2]], &[2, 1, 1]);
    check(&[&[1, 2, 3, 4, 5, 6, 7, 8], &[8]], &[1, 2, 3, 4, 5, 6, 7, 8]);
}
