//! Corners blended side by side equal the posed vertices by definition, bit for bit except for the sign of a zero.

use std::sync::Arc;

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::blend::{FEW, few_indices};
use super::{Pose, Posed};
use crate::bounds::{LANES, Lanes, levels};
use crate::model::MorphModel;
use crate::tree::{BuildOptions, Leaf, MorphBvh};

/// Coordinates of many magnitudes, some of them zeros of either sign.
fn vector(rng: &mut Pcg64Mcg) -> Vec3 {
    let mut coordinate = || match rng.random_range(0..8) {
        0 => 0.0,
        1 => -0.0,
        _ => rng.random_range(-1.0..1.0_f32) * 2_f32.powi(rng.random_range(-30..3)),
    };
    Vec3::new(coordinate(), coordinate(), coordinate())
}

/// Random triangles over random vertices. Each target moves a fraction `moved` of the vertices.
fn model(rng: &mut Pcg64Mcg, triangles: usize, targets: usize, moved: f64) -> Arc<MorphModel> {
    let vertices = rng.random_range(3..=triangles + 2);
    let base: Vec<Vec3> = (0..vertices).map(|_| vector(rng)).collect();
    let corner = |rng: &mut Pcg64Mcg| rng.random_range(0..vertices as u32);
    let triangles: Vec<[u32; 3]> = (0..triangles)
        .map(|_| [corner(rng), corner(rng), corner(rng)])
        .collect();
    let displacement = |rng: &mut Pcg64Mcg| {
        if rng.random_bool(moved) {
            vector(rng)
        } else {
            Vec3::ZERO
        }
    };
    let targets: Vec<Vec<Vec3>> = (0..targets)
        .map(|_| (0..vertices).map(|_| displacement(rng)).collect())
        .collect();
    Arc::new(MorphModel::from_displacements(&base, &triangles, &targets).unwrap())
}

/// Random weights: zeros of either sign, one, ordinary, negative, tiny and huge ones.
fn weights(rng: &mut Pcg64Mcg, targets: usize) -> Vec<f32> {
    let mut weight = || match rng.random_range(0..8) {
        0 | 1 => 0.0,
        2 => -0.0,
        3 => 1.0,
        4 => rng.random_range(-1e-6..1e-6),
        5 => rng.random_range(-1e6..1e6),
        _ => rng.random_range(-3.0..3.0),
    };
    (0..targets).map(|_| weight()).collect()
}

/// How a tree's corners are expected to be blended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    SideBySide,
    Gathered,
}

fn judge(rng: &mut Pcg64Mcg, model: &Arc<MorphModel>, leaf_size: usize, way: Way) {
    let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(model.clone(), &options)));
    for _ in 0..4 {
        pose.set_weights(&weights(rng, model.target_count())).unwrap();
        judge_posed(&mut pose.posed(), way);
    }
}

fn judge_posed(posed: &mut Posed<'_>, way: Way) {
    assert_eq!(posed.leaf_lanes.is_some(), way == Way::SideBySide);
    let topology = posed.topology;
    for &level in levels() {
        posed.level = level;
        for leaf in 0..topology.leaf_count() {
            // `leaf_corners` appends.
            let mut patches = vec![[[Lanes::default(); 3]; 3]];
            posed.leaf_corners(Leaf(leaf), &mut patches);
            assert_eq!(patches.remove(0), [[Lanes::default(); 3]; 3]);
            let triangles = topology.leaf_triangles(Leaf(leaf));
            assert_eq!(patches.len(), triangles.len().div_ceil(LANES));
            for (patch, triangles) in patches.iter().zip(triangles.chunks(LANES)) {
                for lane in 0..LANES {
                    // Unused lanes repeat the last triangle.
                    let triangle = triangles[lane.min(triangles.len() - 1)];
                    let vertices = posed.model.corners(triangle);
                    for ([x, y, z], vertex) in patch.iter().zip(vertices) {
                        let corner = Vec3::new(x.0[lane], y.0[lane], z.0[lane]);
                        let expected = Vec3::from(posed.model.blend_vertex(vertex, posed.weights));
                        // Equal nonzero numbers have the same bits.
                        assert_eq!(corner, expected, "leaf {leaf}, lane {lane}, vertex {vertex}");
                    }
                }
            }
        }
    }
}

#[test]
fn corners_blended_side_by_side_are_the_posed_vertices() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    for (targets, moved) in [(0, 0.0), (1, 1.0), (8, 1.0), (8, 0.3), (60, 0.004)] {
        for leaf_size in [8, 8, 20, 255] {
            let triangles = rng.random_range(60..300);
            let model = model(&mut rng, triangles, targets, moved);
            judge(&mut rng, &model, leaf_size, Way::SideBySide);
        }
    }
}

#[test]
fn corners_gathered_one_by_one_are_the_posed_vertices() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    // Leaves with too few triangles or too many targets.
    for (leaf_size, targets, moved) in [(1, 3, 1.0), (2, 3, 0.3), (3, 0, 0.0), (8, 9, 1.0), (20, 60, 0.5)] {
        for _ in 0..4 {
            let triangles = rng.random_range(60..300);
            let model = model(&mut rng, triangles, targets, moved);
            judge(&mut rng, &model, leaf_size, Way::Gathered);
        }
    }
}

#[test]
fn a_single_triangle_has_its_corners_in_every_lane() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let model = model(&mut rng, 1, 3, 0.5);
    judge(&mut rng, &model, 8, Way::Gathered);
}

#[test]
fn few_active_targets_are_looked_up_in_the_order_of_the_tables() {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    let mut looked_up = 0;
    for moved in [1.0, 0.02] {
        let model = model(&mut rng, 200, 90, moved);
        let mut pose = Pose::new(Arc::new(MorphBvh::build(model, &BuildOptions::default())));
        for active in (0..=FEW + 2).cycle().take(60) {
            let mut weights = vec![-0.0; 90];
            for _ in 0..active {
                weights[rng.random_range(0..90)] = rng.random_range(-2.0..2.0);
            }
            pose.set_weights(&weights).unwrap();
            let posed = pose.posed();
            for group in 0..posed.topology.group_count() {
                let tables = posed.tables.group(group);
                let is_active = |&place: &u16| weights[usize::from(tables.targets[usize::from(place)].target)] != 0.0;
                let expected: Vec<u16> = (0..tables.targets.len() as u16).filter(is_active).collect();
                if let Some(places) = few_indices(tables, posed.weights, &mut [0; FEW]) {
                    assert_eq!(places, expected, "group {group}");
                    looked_up += places.len();
                }
            }
        }
    }
    assert!(looked_up > 100, "{looked_up}");
}
