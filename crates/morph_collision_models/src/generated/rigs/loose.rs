//! Skinned meshes that are not one body: rigid pieces, and triangles with arbitrary influences.

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::Bones;
use crate::generated::random::{point, random_blob, triangle_soup};
use crate::generated::{grid, rigid};
use crate::mesh::{InfluenceSet, MeshSkin, MorphMesh};

/// Boxes and blobs around a chain of joints; each vertex follows one joint.
pub fn rigid_pieces(seed: u64, pieces: usize, targets: usize) -> MorphMesh {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let bones = Bones::new(
        (0..pieces).map(|joint| joint.checked_sub(1)).collect(),
        (0..pieces).map(|_| point(&mut rng, 0.8)).collect::<Vec<_>>(),
    );
    let mut mesh = MorphMesh::rigid(format!("pieces_{seed}"), Vec::new(), Vec::new());
    let mut joints = Vec::new();
    for (joint, &middle) in bones.positions.iter().enumerate() {
        let piece = if joint % 2 == 0 {
            rigid::box_mesh(grid::snap(point(&mut rng, 0.2).abs() + 0.05))
        } else {
            let mut blob = random_blob(rng.random(), 1, 0, 0.0);
            blob.positions.iter_mut().for_each(|p| *p *= 0.25);
            blob
        };
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(piece.positions.iter().map(|&p| p + middle));
        mesh.triangles
            .extend(piece.triangles.iter().map(|triangle| triangle.map(|v| v + first)));
        joints.extend(vec![[joint as u16, 0, 0, 0]; piece.positions.len()]);
    }
    mesh.primitives = std::iter::once(0..mesh.triangles.len() as u32).collect();
    for target in 0..targets {
        let displaced = mesh.positions.iter().map(|_| grid::snap(point(&mut rng, 0.1)));
        mesh.targets.push(displaced.collect());
        mesh.target_names.push(format!("target_{target}"));
    }
    let weights = vec![[1.0, 0.0, 0.0, 0.0]; joints.len()];
    mesh.skin = Some(MeshSkin {
        sets: vec![InfluenceSet { joints, weights }],
        skeleton: bones.skeleton(),
    });
    mesh
}

/// Separate triangles. Each corner has up to `4 * sets` random joints, some of them named twice, and weights that sum to about 1.
///
/// `joints` joints without a hierarchy are spread over the cube from -1 to 1.
pub fn random_soup(seed: u64, triangles: usize, joints: usize, targets: usize, sets: usize) -> MorphMesh {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut mesh = triangle_soup(rng.random(), triangles, targets);
    mesh.name = format!("soup_rig_{seed}");
    let joints = joints.max(1);
    let bones = Bones::new(
        vec![None; joints],
        (0..joints).map(|_| point(&mut rng, 1.0)).collect::<Vec<_>>(),
    );
    let slots = 4 * sets.max(1);
    let mut of_slots = vec![InfluenceSet::default(); slots / 4];
    for _ in &mesh.positions {
        let used = rng.random_range(1..=slots);
        let near = rng.random_range(0..joints);
        let mut weights = vec![0.0_f32; slots];
        for weight in weights.iter_mut().take(used) {
            *weight = rng.random_range(1..=64_u8).into();
        }
        // Unused slots may be anywhere.
        let turn = rng.random_range(0..slots);
        weights.rotate_left(turn);
        let sum: f32 = weights.iter().sum();
        for (set, influences) in of_slots.iter_mut().enumerate() {
            let joint = |rng: &mut Pcg64Mcg| {
                let joint = if rng.random_bool(0.3) {
                    near
                } else {
                    rng.random_range(0..joints)
                };
                joint as u16
            };
            influences.joints.push(std::array::from_fn(|_| joint(&mut rng)));
            influences
                .weights
                .push(std::array::from_fn(|i| weights[4 * set + i] / sum));
        }
    }
    mesh.skin = Some(MeshSkin {
        sets: of_slots,
        skeleton: bones.skeleton(),
    });
    mesh
}

/// The mesh with weight sums anywhere from 0 to 3; a tenth of its vertices have no weight at all.
///
/// Vertices at the same place keep the same influences, so that a closed surface stays closed.
pub fn unnormalised(mesh: &MorphMesh, seed: u64) -> MorphMesh {
    let mut mesh = mesh.clone();
    let factors: Vec<f32> = mesh.positions.iter().map(|&p| factor(p, seed)).collect();
    for set in mesh.skin.iter_mut().flat_map(|skin| &mut skin.sets) {
        for (weights, factor) in set.weights.iter_mut().zip(&factors) {
            *weights = weights.map(|weight| weight * factor);
        }
    }
    mesh.name += "_unnormalised";
    mesh
}

/// The mesh with weights that are off by up to four units in the last place, as exporters leave them: their sums are almost 1.
///
/// Vertices at the same place keep the same influences.
pub fn nearly_normalised(mesh: &MorphMesh, seed: u64) -> MorphMesh {
    let mut mesh = mesh.clone();
    let of_vertices: Vec<f32> = mesh.positions.iter().map(|&p| factor(p, seed)).collect();
    for set in mesh.skin.iter_mut().flat_map(|skin| &mut skin.sets) {
        for (weights, factor) in set.weights.iter_mut().zip(&of_vertices) {
            // Factors are from 0 to 3.
            let units = (factor * 8.0 / 3.0).round() - 4.0;
            *weights = weights.map(|weight| weight * (1.0 + units * 0.5 * f32::EPSILON));
        }
    }
    mesh.name += "_nearly";
    mesh
}

fn factor(position: Vec3, seed: u64) -> f32 {
    let bits = position.to_array().map(|x| u64::from((x + 0.0).to_bits()));
    let mixed = bits.iter().fold(seed, |mixed, bits| {
        (mixed ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
    });
    let mut rng = Pcg64Mcg::seed_from_u64(mixed);
    if rng.random_bool(0.1) {
        0.0
    } else {
        rng.random_range(0.0..3.0)
    }
}
