//! After a refit, at once or lazily, every box is the smallest one around the posed vertices below it.

use std::sync::Arc;

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::blend::max_widening;
use super::{Pose, Posed};
use crate::Kernel;
use crate::bounds::{Aabb, WorldFromModel};
use crate::model::MorphModel;
use crate::tree::{BuildOptions, ChildKind, MorphBvh};

fn vector(rng: &mut Pcg64Mcg) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)))
}

/// A refitted pose of random triangles with random size, leaf size and weights. Boxes may have been blended before.
fn refitted(rng: &mut Pcg64Mcg) -> Pose {
    let size = 10_f32.powf(rng.random_range(-30.0..25.0));
    let offset = if rng.random_bool(0.3) {
        vector(rng) * 1e4
    } else {
        Vec3::ZERO
    };
    let vertices = rng.random_range(3..60);
    let base: Vec<Vec3> = (0..vertices).map(|_| (vector(rng) + offset) * size).collect();
    let corner = |rng: &mut Pcg64Mcg| rng.random_range(0..vertices as u32);
    let triangles: Vec<[u32; 3]> = (0..rng.random_range(1..120))
        .map(|_| [corner(rng), corner(rng), corner(rng)])
        .collect();
    let targets: Vec<Vec<Vec3>> = (0..rng.random_range(0..12))
        .map(|_| {
            let moved = |rng: &mut Pcg64Mcg| {
                if rng.random_bool(0.5) {
                    vector(rng) * size
                } else {
                    Vec3::ZERO
                }
            };
            (0..vertices).map(|_| moved(rng)).collect()
        })
        .collect();
    let model = MorphModel::from_displacements(&base, &triangles, &targets).unwrap();
    let leaf_size = [1, 3, 8, 20][rng.random_range(0..4_usize)];
    let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &options)));
    let weights: Vec<f32> = targets.iter().map(|_| rng.random_range(-2.0..3.0)).collect();
    pose.set_weights(&weights).unwrap();
    if rng.random_bool(0.5) {
        pose.visit_nodes(|_| true);
    }
    refit_somehow(&mut pose, rng);
    pose
}

fn refit_somehow(pose: &mut Pose, rng: &mut Pcg64Mcg) {
    if rng.random_bool(0.5) {
        pose.refit();
    } else {
        pose.refit_lazily();
    }
}

/// Visits every box of a subtree together with the posed vertices below it. Returns the vertices of the whole subtree.
fn each_box(posed: &mut Posed<'_>, group: usize, visit: &mut impl FnMut(&Aabb, &[Vec3], bool)) -> Vec<Vec3> {
    let slot = posed.open(group);
    let topology = posed.topology;
    let mut all = Vec::new();
    for (lane, child) in topology.group(group).children().iter().enumerate() {
        let (below, is_leaf) = match child.kind() {
            ChildKind::Group(group) => (each_box(posed, group, visit), false),
            ChildKind::Leaf(leaf) => {
                let vertices = topology.leaf_triangles(leaf).iter();
                let vertices = vertices.flat_map(|&triangle| posed.model.corners(triangle));
                let blend = |vertex| Vec3::from(posed.model.blend_vertex(vertex, posed.weights));
                (vertices.map(blend).collect(), true)
            }
        };
        visit(&posed.boxes(slot).get(lane), &below, is_leaf);
        all.extend(below);
    }
    all
}

#[test]
fn refitted_boxes_are_the_boxes_of_the_posed_vertices() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    let mut leaves = 0;
    for i in 0..200 {
        let mut pose = refitted(&mut rng);
        let kernels = Kernel::available();
        pose.bvh = Arc::new((*pose.bvh).clone().with_kernel(kernels[i % kernels.len()]));
        pose.refit();
        each_box(&mut pose.posed(), 0, &mut |bounds, points, is_leaf| {
            assert_eq!(*bounds, Aabb::from_points(points.iter().copied()));
            leaves += u32::from(is_leaf);
        });
        assert_eq!(pose.bounds(), pose.tight_world_bounds(&WorldFromModel::IDENTITY));
    }
    assert!(leaves > 1000, "{leaves}");
}

/// Weights, displacements and base positions of all magnitudes, which cancel each other or vanish.
#[test]
fn refitted_boxes_are_tight_where_blends_round_most() {
    let mut rng = Pcg64Mcg::seed_from_u64(6);
    for _ in 0..100 {
        let mut number = || match rng.random_range(0..6) {
            0 => 0.0,
            1 => -0.0,
            2 => f32::from_bits(rng.random_range(1..9)),
            3 => 1.0 + f32::EPSILON,
            4 => rng.random_range(-1.0..1.0_f32) * 1e15,
            _ => rng.random_range(-1.0..1.0_f32) * 2_f32.powi(-24),
        };
        let mut vectors = || -> Vec<Vec3> { (0..45).map(|_| Vec3::from_array([(); 3].map(|()| number()))).collect() };
        let (base, targets) = (vectors(), [(); 9].map(|()| vectors()));
        let weights: Vec<f32> = (0..9).map(|_| number()).collect();
        let triangles: Vec<[u32; 3]> = (0..43).map(|i| [i, i + 1, i + 2]).collect();
        let model = MorphModel::from_displacements(&base, &triangles, &targets).unwrap();
        let options = BuildOptions::default().with_leaf_size(2).unwrap();
        let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &options)));
        pose.set_weights(&weights).unwrap();
        pose.refit();
        each_box(&mut pose.posed(), 0, &mut |bounds, points, _| {
            assert_eq!(*bounds, Aabb::from_points(points.iter().copied()));
        });
    }
}

#[test]
fn a_lazy_refit_fits_the_upper_half_of_the_levels_at_once() {
    let mesh = morph_collision_models::generated::dolphin(1);
    let model = MorphModel::from_displacements(&mesh.positions, &mesh.triangles, &mesh.targets).unwrap();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    pose.visit_nodes(|_| true);
    pose.refit_lazily();
    let middle = pose.bvh().depth().div_ceil(2);
    let mut below = 0;
    pose.visit_nodes(|node| {
        assert_eq!(node.was_cached, node.depth <= middle, "depth {}", node.depth);
        below += usize::from(node.depth > middle);
        true
    });
    assert!(below > 100, "{below}");
    pose.refit();
    pose.visit_nodes(|node| {
        assert!(node.was_cached);
        true
    });
}

/// Checks that every box contains the posed vertices below it.
fn assert_holds(pose: &mut Pose) {
    each_box(&mut pose.posed(), 0, &mut |bounds, points, _| {
        assert!(points.iter().all(|point| bounds.contains(*point)), "{bounds:?}");
    });
}

#[test]
fn other_weights_end_a_refit() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    for _ in 0..100 {
        let mut pose = refitted(&mut rng);
        let weights: Vec<f32> = pose.weights().iter().map(|w| 0.5 - w).collect();
        pose.set_weights(&weights).unwrap();
        assert_holds(&mut pose);
    }
}

fn assert_tight(posed: &mut Posed<'_>, about: &str) {
    let size = posed.bounds().size().max_element();
    each_box(posed, 0, &mut |bounds, points, _| {
        let tight = Aabb::from_points(points.iter().copied());
        let near = 1e-4 * size;
        assert!(
            bounds.min.abs_diff_eq(tight.min, near),
            "{about}: {bounds:?}, {tight:?}"
        );
        assert!(
            bounds.max.abs_diff_eq(tight.max, near),
            "{about}: {bounds:?}, {tight:?}"
        );
    });
}

#[test]
fn every_box_is_tight_at_the_base_and_at_each_target() {
    let meshes = [
        morph_collision_models::generated::dolphin(0),
        morph_collision_models::generated::random::random_blob(3, 3, 5, 0.5),
    ];
    for mesh in meshes {
        let model = MorphModel::from_displacements(&mesh.positions, &mesh.triangles, &mesh.targets).unwrap();
        let bvh = MorphBvh::build(Arc::new(model), &BuildOptions::default());
        let mut pose = Pose::new(Arc::new(bvh));
        let targets = mesh.targets.len();
        assert_tight(&mut pose.posed(), "base");
        for target in 0..targets {
            let mut weights = vec![0.0; targets];
            weights[target] = 1.0;
            pose.set_weights(&weights).unwrap();
            assert_tight(&mut pose.posed(), &format!("target {target}"));
        }
    }
}

/// Refits and new weights in any order: no box of earlier weights stays in the cache.
#[test]
fn boxes_hold_every_vertex_after_refits_and_new_weights_in_any_order() {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    for _ in 0..60 {
        let mut pose = refitted(&mut rng);
        for _ in 0..12 {
            if rng.random_bool(0.4) {
                refit_somehow(&mut pose, &mut rng);
            } else {
                let weights: Vec<f32> = pose.weights().iter().map(|_| rng.random_range(-2.0..3.0)).collect();
                pose.set_weights(&weights).unwrap();
            }
            assert_holds(&mut pose);
        }
    }
}

/// Physics relies on this bound when it moves surfaces.
#[test]
fn no_vertex_moves_farther_between_weights_than_the_bound() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let mut nearest = 0.0_f64;
    for _ in 0..60 {
        let mut pose = refitted(&mut rng);
        let model = pose.bvh().model().clone();
        let vertices: Vec<u32> = (0..model.triangle_count() as u32)
            .flat_map(|triangle| model.corners(triangle))
            .collect();
        let mut before = pose.weights().to_vec();
        for _ in 0..4 {
            let places: Vec<Vec3> = vertices.iter().map(|&vertex| pose.vertex(vertex).unwrap()).collect();
            let weights: Vec<f32> = before.iter().map(|_| rng.random_range(-2.0..3.0)).collect();
            let mut posed_before = Pose::new(pose.bvh().clone());
            posed_before.set_weights(&before).unwrap();
            pose.set_weights(&weights).unwrap();
            let bound = pose.displacement_from_pose(&mut posed_before);
            for (&vertex, place) in vertices.iter().zip(places) {
                let moved = pose.vertex(vertex).unwrap().as_dvec3().distance(place.as_dvec3());
                assert!(moved <= bound, "{moved}, bound {bound}");
                nearest = nearest.max(if bound > 0.0 { moved / bound } else { 0.0 });
            }
            before = weights;
        }
    }
    assert!(nearest > 0.3, "the bound is far from reached: {nearest}");
}

/// Many targets, each of which moves every vertex. With all weights 1 blended boxes are loose.
fn with_many_targets() -> Pose {
    let mesh = morph_collision_models::generated::random::random_blob(7, 3, 60, 0.0);
    let model = MorphModel::from_displacements(&mesh.positions, &mesh.triangles, &mesh.targets).unwrap();
    Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())))
}

#[test]
fn boxes_that_would_be_loose_are_fitted_as_soon_as_something_looks_below_the_roots_children() {
    let mut pose = with_many_targets();
    let vertices = pose.bvh().model().vertex_count() as u64;
    for (weight, is_loose) in [(1.0, true), (0.1, false), (-1.0, true)] {
        pose.set_weights(&[weight; 60]).unwrap();
        let before = pose.posed().blended();
        let of_the_body = pose.bounds();
        assert_eq!(pose.posed().blended().vertices, before.vertices, "bounds pose nothing");
        let (mut tight, mut loose) = (0, 0);
        let rounding = Vec3::splat(max_widening(pose.bvh.model(), &pose.weights));
        each_box(&mut pose.posed(), 2, &mut |bounds, points, _| {
            let fitted = Aabb::from_points(points.iter().copied());
            assert!(bounds.contains(fitted.min) && bounds.contains(fitted.max));
            let largest = Aabb {
                min: fitted.min - 1.01 * rounding,
                max: fitted.max + 1.01 * rounding,
            };
            let is_tight = largest.contains(bounds.min) && largest.contains(bounds.max);
            *if is_tight { &mut tight } else { &mut loose } += 1;
        });
        assert!(tight + loose > 15, "{tight} {loose}");
        assert_eq!(is_loose, loose == 0, "{tight} {loose}");
        if is_loose {
            assert_eq!(pose.posed().blended().vertices - before.vertices, vertices, "each once");
        }
        // The bounds of the body do not depend on what was asked before.
        pose.visit_nodes(|_| true);
        assert_eq!(pose.bounds(), of_the_body);
        pose.refit();
        assert_ne!(pose.bounds(), of_the_body);
        pose.set_weights(&[0.0; 60]).unwrap();
    }
}
