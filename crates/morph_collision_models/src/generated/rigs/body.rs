//! Closed surfaces around joints, with weights that fall off smoothly from each bone.

use glam::{DVec3, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::Bones;
use crate::generated::grid;
use crate::generated::random::point;
use crate::generated::tube::Pieces;
use crate::mesh::{InfluenceSet, MeshSkin, MorphMesh};

/// Sides of a tube.
const SIDES: usize = 8;
/// Rings between two joints.
const RINGS: usize = 4;
/// Radius of a tube.
const RADIUS: f64 = 0.14;
/// The smallest share that a joint may have, relative to the largest one.
const LEAST_SHARE: f64 = 1e-4;

/// One tube along a bent chain of joints, about 2 units long.
///
/// `influences` (at least 1) is the largest number per vertex; each four take a set.
pub fn tube(seed: u64, joints: usize, influences: usize, targets: usize) -> MorphMesh {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let joints = joints.max(2);
    let step = 2.0 / (joints - 1) as f64;
    let mut at = DVec3::new(-1.0, 0.0, 0.0);
    let mut positions = vec![at];
    for _ in 1..joints {
        at += DVec3::new(step, 0.0, 0.0) + point(&mut rng, step * 0.3);
        positions.push(at);
    }
    let parents = (0..joints).map(|joint| joint.checked_sub(1)).collect();
    let bones = Bones::new(parents, positions);
    let mut pieces = Pieces::default();
    let along: Vec<[DVec3; 2]> = bones
        .positions
        .windows(2)
        .map(|ends| [ends[0], ends[1]].map(Vec3::as_dvec3))
        .collect();
    add_tube(&mut pieces, &along);
    rigged(format!("tube_{seed}"), &mut rng, &bones, &pieces, influences, targets)
}

/// A tube around every bone of a random tree of joints, about 2 units across. The tubes overlap at the
/// joints.
///
/// `influences` (at least 1) is the largest number per vertex; each four take a set.
pub fn branching(seed: u64, joints: usize, influences: usize, targets: usize) -> MorphMesh {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let joints = joints.max(2);
    let mut parents = vec![None];
    let mut positions = vec![DVec3::ZERO];
    for joint in 1..joints {
        // Usually continues from the last joint, so that limbs form.
        let parent = if rng.random_bool(0.7) {
            joint - 1
        } else {
            rng.random_range(0..joint)
        };
        let from: DVec3 = positions[parent];
        let step = point(&mut rng, 0.5);
        // Turns back towards the middle if a limb would leave the cube.
        let to = from + step;
        let inside = to.abs().max_element() < 1.0;
        positions.push(if inside { to } else { from * 0.5 + step * 0.5 });
        parents.push(Some(parent));
    }
    let bones = Bones::new(parents, positions);
    let mut pieces = Pieces::default();
    for (joint, parent) in bones.parents.iter().enumerate() {
        if let Some(parent) = parent {
            add_tube(
                &mut pieces,
                &[[*parent, joint].map(|end| bones.positions[end].as_dvec3())],
            );
        }
    }
    rigged(
        format!("branching_{seed}"),
        &mut rng,
        &bones,
        &pieces,
        influences,
        targets,
    )
}

/// Adds a closed tube along consecutive segments.
fn add_tube(pieces: &mut Pieces, along: &[[DVec3; 2]]) {
    let mut rings = Vec::new();
    let (mut start, mut end) = (DVec3::ZERO, DVec3::ZERO);
    for (index, [from, to]) in along.iter().enumerate() {
        let direction = (*to - *from).normalize_or(DVec3::X);
        let across = direction.any_orthonormal_vector();
        let other = direction.cross(across);
        if index == 0 {
            start = *from - direction * RADIUS;
        }
        end = *to + direction * RADIUS;
        for ring in 0..RINGS {
            let middle = from.lerp(*to, (ring as f64 + 0.5) / RINGS as f64);
            rings.push(corners().map(|[x, y]| middle + (across * x + other * y) * RADIUS));
        }
    }
    pieces.add_tube(start, &rings, end);
}

/// The corners of a regular octagon, without trigonometry.
fn corners() -> [[f64; 2]; SIDES] {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let quarter = [[1.0, 0.0], [half, half]];
    std::array::from_fn(|side| {
        let [x, y] = quarter[side % 2];
        match side / 2 {
            0 => [x, y],
            1 => [-y, x],
            2 => [-x, -y],
            _ => [y, -x],
        }
    })
}

fn rigged(
    name: String,
    rng: &mut Pcg64Mcg,
    bones: &Bones,
    pieces: &Pieces,
    influences: usize,
    targets: usize,
) -> MorphMesh {
    let positions = pieces.positions.iter().map(|&p| grid::snap(p)).collect();
    let mut mesh = MorphMesh::rigid(name, positions, pieces.triangles.clone());
    for target in 0..targets {
        let centre = bones.positions[rng.random_range(0..bones.positions.len())].as_dvec3();
        let reach = rng.random_range(0.4..1.0);
        let push = point(rng, 0.3);
        let displaced = pieces.positions.iter().map(|p| {
            let share = 1.0 - p.distance(centre) / reach;
            if share <= 0.0 {
                return Vec3::ZERO;
            }
            grid::snap(push * share + point(rng, 0.02))
        });
        mesh.targets.push(displaced.collect());
        mesh.target_names.push(format!("target_{target}"));
    }
    let influences = influences.max(1);
    let of_vertices: Vec<_> = pieces.positions.iter().map(|p| shares(bones, *p, influences)).collect();
    let sets = (0..influences.div_ceil(4)).map(|set| InfluenceSet {
        joints: of_vertices
            .iter()
            .map(|of| std::array::from_fn(|i| of[4 * set + i].0))
            .collect(),
        weights: of_vertices
            .iter()
            .map(|of| std::array::from_fn(|i| of[4 * set + i].1))
            .collect(),
    });
    mesh.skin = Some(MeshSkin {
        sets: sets.collect(),
        skeleton: bones.skeleton(),
    });
    mesh
}

/// The joints nearest to a point, with shares that sum to 1, in whole sets of four. Distances are to the bones that begin at the
/// joints.
fn shares(bones: &Bones, p: DVec3, influences: usize) -> Vec<(u16, f32)> {
    let mut squares = vec![f64::INFINITY; bones.positions.len()];
    for (joint, parent) in bones.parents.iter().enumerate() {
        let end = bones.positions[joint].as_dvec3();
        squares[joint] = squares[joint].min(p.distance_squared(end));
        if let Some(parent) = parent {
            let start = bones.positions[*parent].as_dvec3();
            let along = end - start;
            let t = ((p - start).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
            squares[*parent] = squares[*parent].min(p.distance_squared(start + along * t));
        }
    }
    let mut nearest: Vec<(u16, f64)> = squares
        .iter()
        .enumerate()
        .map(|(joint, square)| {
            let falloff = 1.0 / (square + 0.01);
            (joint as u16, falloff * falloff)
        })
        .collect();
    nearest.sort_by(|a, b| b.1.total_cmp(&a.1));
    nearest.truncate(influences);
    // A joint with almost no share is left out, as exporters do.
    let largest = nearest.first().map_or(0.0, |(_, share)| *share);
    nearest.retain(|(_, share)| *share >= LEAST_SHARE * largest);
    let sum: f64 = nearest.iter().map(|(_, share)| share).sum();
    let mut slots = vec![(0, 0.0); influences.next_multiple_of(4)];
    for (slot, (joint, share)) in slots.iter_mut().zip(nearest) {
        *slot = (joint, (share / sum) as f32);
    }
    slots
}
