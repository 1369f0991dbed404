//! Bounds on how far vertices move, compared with all vertices.

use std::sync::Arc;

use glam::{Affine3A, DVec3, EulerRot, Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::displacement::displacement;
use crate::{Body, BuildOptions, Influences, JointMatrices, MorphBvh, MorphModel, Pose, WorldFromModel};

const JOINTS: u16 = 3;

/// Loose triangles with joint weights that sum to `sums`.
fn skinned(rng: &mut Pcg64Mcg, sums: f32) -> Arc<MorphBvh> {
    let point = |rng: &mut Pcg64Mcg| Vec3::from_array([(); 3].map(|()| rng.random_range(-1.0..1.0)));
    let base: Vec<Vec3> = (0..90).map(|_| point(rng)).collect();
    let targets: [Vec<Vec3>; 2] = [(); 2].map(|()| (0..90).map(|_| point(rng) * 0.3).collect());
    let joints: Vec<_> = (0..90).map(|_| [(); 4].map(|()| rng.random_range(0..JOINTS))).collect();
    let weights = (0..90).map(|_| {
        let share = rng.random_range(0.0..1.0);
        [share * sums, (1.0 - share) * sums, 0.0, 0.0]
    });
    let weights: Vec<_> = weights.collect();
    let triangles: Vec<_> = (0..30).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let influences = Influences {
        joints: &joints,
        weights: &weights,
    };
    let model = MorphModel::skinned(&base, &triangles, &targets, usize::from(JOINTS), &[influences]).unwrap();
    Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()))
}

fn vertices(pose: &mut Pose) -> Vec<DVec3> {
    let place = WorldFromModel::IDENTITY;
    let count = pose.bvh().model().vertex_count() as u32;
    (0..count).map(|v| Body::new(pose, &place).vertex(v).unwrap()).collect()
}

#[test]
fn no_vertex_of_a_skinned_mesh_moves_farther_than_the_bound() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let (mut closest, mut moved_at_all) = (0.0_f64, 0);
    for case in 0..200 {
        let sums = [1.0, 1.0, 0.7, 1.6][case % 4];
        let bvh = skinned(&mut rng, sums);
        let [mut before, mut now] = [(); 2].map(|()| {
            let matrices = [(); JOINTS as usize].map(|()| {
                let [a, b, c] = [(); 3].map(|()| rng.random_range(-0.2..0.2));
                let at = Vec3::from_array([(); 3].map(|()| rng.random_range(-1.0..1.0)));
                let turn = Quat::from_euler(EulerRot::XYZ, a, b, c);
                Affine3A::from_scale_rotation_translation(Vec3::splat(1.0 + a), turn, at)
            });
            let mut pose = Pose::new(bvh.clone());
            pose.set_joints(&JointMatrices::new(&matrices).unwrap()).unwrap();
            let weights = [(); 2].map(|()| rng.random_range(-0.1..0.1));
            pose.set_weights(&weights).unwrap();
            pose
        });
        let bound = now.displacement_from_pose(&mut before);
        let (from, to) = (vertices(&mut before), vertices(&mut now));
        let most = from.iter().zip(&to).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(most <= bound, "{most} is more than {bound}");
        let place = WorldFromModel::IDENTITY;
        for (factor, is_within) in [(1.0 - 1e-6, false), (1.0 + 1e-6, true)] {
            let now = Body::new(&mut now, &place);
            let before = Body::new(&mut before, &place);
            assert_eq!(now.moved_at_most(factor * bound, before), is_within);
        }
        closest = closest.max(most / bound);
        moved_at_all += usize::from(most > 0.1);
    }
    assert!(moved_at_all == 200 && closest > 0.5, "{closest}");
}

#[test]
fn the_bound_is_the_way_where_all_joints_go_the_same_one() {
    let bvh = skinned(&mut Pcg64Mcg::seed_from_u64(6), 1.0);
    let at = |x: f32| {
        let mut pose = Pose::new(bvh.clone());
        let matrices = [Affine3A::from_translation(Vec3::X * x); JOINTS as usize];
        pose.set_joints(&JointMatrices::new(&matrices).unwrap()).unwrap();
        pose
    };
    let bound = at(3.0).displacement_from_pose(&mut at(1.0));
    assert!((2.0..2.0001).contains(&bound), "{bound}");
    assert_eq!(at(3.0).displacement_from_pose(&mut at(3.0)), 0.0);
    let other = skinned(&mut Pcg64Mcg::seed_from_u64(6), 1.0);
    assert_eq!(at(3.0).displacement_from_pose(&mut Pose::new(other)), f64::INFINITY);
}

fn random_vector(rng: &mut Pcg64Mcg) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| rng.random_range(-1.0..1.0)))
}

/// A mesh of up to a few hundred loose triangles near each other, with targets that move part of it, all of it, or nothing.
fn morphing(rng: &mut Pcg64Mcg) -> Arc<MorphBvh> {
    let triangles = rng.random_range(1..300);
    let base: Vec<Vec3> = (0..triangles)
        .flat_map(|_| {
            let at = random_vector(rng) * 2.0;
            [(); 3].map(|()| at + random_vector(rng) * 0.1)
        })
        .collect();
    let targets: Vec<Vec<Vec3>> = (0..rng.random_range(0..20))
        .map(|_| {
            let (center, radius) = (random_vector(rng), rng.random_range(0.0..4.0));
            let moved = |p: &Vec3| {
                if p.distance(center) < radius {
                    random_vector(rng) * 0.3
                } else {
                    Vec3::ZERO
                }
            };
            base.iter().map(moved).collect()
        })
        .collect();
    let triangles: Vec<_> = (0..triangles).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let model = MorphModel::from_displacements(&base, &triangles, &targets).unwrap();
    Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()))
}

/// A random transform: rotated and possibly scaled, sheared, mirrored, flattened, or far away.
fn any_place(rng: &mut Pcg64Mcg) -> Affine3A {
    let [a, b, c] = [(); 3].map(|()| rng.random_range(-4.0..4.0));
    let turn = Quat::from_euler(EulerRot::XYZ, a, b, c);
    let scale = [1.0, 0.0, -1.0, 3.0, 1e-20, 1e5];
    let scale = Vec3::from_array([(); 3].map(|()| scale[rng.random_range(0..6)]));
    let far = [0.0, 1.0, 1e6, 1e12][rng.random_range(0..4)];
    let shear = Affine3A::from_mat3(glam::Mat3::from_cols(
        Vec3::X,
        Vec3::new(rng.random_range(-1.0..1.0), 1.0, 0.0),
        Vec3::Z,
    ));
    Affine3A::from_scale_rotation_translation(scale, turn, random_vector(rng) * far) * shear
}

/// A transform that differs a little from another one.
fn nearby(rng: &mut Pcg64Mcg, place: Affine3A, by: f32) -> Affine3A {
    let [a, b, c] = [(); 3].map(|()| rng.random_range(-by..by));
    let moved = Affine3A::from_rotation_translation(Quat::from_euler(EulerRot::XYZ, a, b, c), random_vector(rng) * by);
    moved * place
}

#[test]
fn no_vertex_of_a_placed_mesh_moves_farther_than_the_bound() {
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    let (mut closest, mut kept) = (0.0_f64, 0);
    for case in 0..600 {
        let bvh = morphing(&mut rng);
        let size = [1e-3, 0.1, 3.0][case % 3];
        let [mut before, mut now] = [(); 2].map(|()| Pose::new(bvh.clone()));
        let weights: Vec<f32> = before.weights().iter().map(|_| rng.random_range(-2.0..3.0)).collect();
        let others: Vec<f32> = weights
            .iter()
            .map(|weight| weight + [0.0, rng.random_range(-size..size)][case % 2])
            .collect();
        before.set_weights(&weights).unwrap();
        now.set_weights(&others).unwrap();
        let is_extreme = case % 5 == 0;
        let from = if is_extreme {
            any_place(&mut rng)
        } else {
            Affine3A::from_rotation_y(case as f32)
        };
        let to = match case % 7 {
            0 => from,
            1 => any_place(&mut rng),
            _ => nearby(&mut rng, from, size),
        };
        let [from, to] = [from, to].map(|place| WorldFromModel::new(place).unwrap());
        let mut old = Body::new(&mut before, &from);
        let mut new = Body::new(&mut now, &to);
        let bound = new.displacement_from(old.reborrow());
        let mut most = 0.0_f64;
        for triangle in 0..bvh.model().triangle_count() as u32 {
            let corners = old
                .triangle(triangle)
                .unwrap()
                .into_iter()
                .zip(new.triangle(triangle).unwrap());
            most = corners.map(|(p, q)| p.distance(q)).fold(most, f64::max);
        }
        assert!(most <= bound, "case {case}: {most} is more than {bound}");
        if most > 0.0 && !is_extreme {
            closest = closest.max(most / bound);
            assert!(most / bound > 0.1, "case {case}: {most} is far less than {bound}");
        }
        for (factor, is_within) in [
            (1.0 - 1e-6, bound == 0.0),
            (1.0 + 1e-6, bound.is_finite()),
            (2.0, bound.is_finite()),
        ] {
            let distance = factor * bound;
            assert_eq!(new.moved_at_most(distance, old.reborrow()), is_within, "case {case}");
            kept += usize::from(is_within);
        }
    }
    assert!(closest > 0.95 && kept > 1000, "{closest}, {kept}");
}

#[test]
fn where_numbers_overflow_there_is_no_bound() {
    let bvh = morphing(&mut Pcg64Mcg::seed_from_u64(9));
    let count = bvh.model().target_count();
    let at = |place: Affine3A, weight: f32| {
        let mut pose = Pose::new(bvh.clone());
        pose.set_weights(&vec![weight; count]).unwrap();
        (pose, WorldFromModel::new(place).unwrap())
    };
    let scaled = |scale: f32| Affine3A::from_scale(Vec3::splat(scale));
    for (place, weight) in [(scaled(3e38), 1e30), (scaled(1.0), 1e36), (scaled(-3e38), 0.0)] {
        let [(mut pose, place), (mut rest, origin)] = [at(place, weight), at(scaled(1.0), 0.0)];
        let bound = Body::new(&mut pose, &place).displacement_from(Body::new(&mut rest, &origin));
        assert!(bound > 1e35, "{bound}");
        let back = Body::new(&mut rest, &origin).displacement_from(Body::new(&mut pose, &place));
        assert!(back > 1e35, "{back}");
    }
}

/// Far away vertices are rounded to multiples of more than the way that they go.
#[test]
fn the_bound_covers_the_roundings_of_both_places() {
    let mut rng = Pcg64Mcg::seed_from_u64(10);
    let mut beyond = 0;
    for _ in 0..50 {
        let bvh = morphing(&mut rng);
        let count = bvh.model().target_count();
        let place = Affine3A::from_rotation_translation(Quat::from_rotation_x(0.3), random_vector(&mut rng) * 1e12);
        let place = WorldFromModel::new(place).unwrap();
        let [mut before, mut now] = [(); 2].map(|()| Pose::new(bvh.clone()));
        now.set_weights(&vec![1e-5; count]).unwrap();
        let near = now.displacement_from_pose(&mut before);
        let (mut old, mut new) = (Body::new(&mut before, &place), Body::new(&mut now, &place));
        let bound = new.displacement_from(old.reborrow());
        for vertex in 0..bvh.model().vertex_count() as u32 {
            let moved = old.vertex(vertex).unwrap().distance(new.vertex(vertex).unwrap());
            assert!(moved <= bound, "{moved} is more than {bound}");
            beyond += usize::from(moved > near);
        }
    }
    assert!(beyond > 100, "{beyond}");
}

#[test]
fn the_bound_covers_the_roundings_of_joints_far_away() {
    let bvh = skinned(&mut Pcg64Mcg::seed_from_u64(11), 1.0);
    let at = Affine3A::from_rotation_translation(Quat::from_rotation_x(0.3), Vec3::splat(1e12));
    let joints = JointMatrices::new(&[at; JOINTS as usize]).unwrap();
    let [mut before, mut now] = [(); 2].map(|()| Pose::new(bvh.clone()));
    for pose in [&mut before, &mut now] {
        pose.set_joints(&joints).unwrap();
    }
    now.set_weights(&[1e-5, 0.0]).unwrap();
    let bound = now.displacement_from_pose(&mut before);
    let (from, to) = (vertices(&mut before), vertices(&mut now));
    let most = from.iter().zip(&to).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    assert!((1e-4..bound).contains(&most), "{most} is more than {bound}");
    let place = WorldFromModel::IDENTITY;
    for (factor, is_within) in [(0.99, false), (1.01, true)] {
        let (now, before) = (Body::new(&mut now, &place), Body::new(&mut before, &place));
        assert_eq!(now.moved_at_most(factor * bound, before), is_within);
    }
}

/// Joints that make the mesh ten times as large, and what its targets do with it.
#[test]
fn the_bound_grows_with_what_joints_scale() {
    let bvh = skinned(&mut Pcg64Mcg::seed_from_u64(12), 1.0);
    let joints = JointMatrices::new(&[Affine3A::from_scale(Vec3::splat(10.0)); JOINTS as usize]).unwrap();
    let [mut before, mut now] = [(); 2].map(|()| Pose::new(bvh.clone()));
    for pose in [&mut before, &mut now] {
        pose.set_joints(&joints).unwrap();
    }
    now.set_weights(&[0.5, 0.0]).unwrap();
    let bound = now.displacement_from_pose(&mut before);
    let (from, to) = (vertices(&mut before), vertices(&mut now));
    let most = from.iter().zip(&to).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    assert!((0.6..1.0).contains(&(most / bound)), "{most}, {bound}");
}

#[test]
fn the_bound_does_not_depend_on_what_is_wanted() {
    let place = WorldFromModel::IDENTITY;
    for sums in [0.5, 1.0, 1.6] {
        let bvh = skinned(&mut Pcg64Mcg::seed_from_u64(13), sums);
        let at = |x: f32| {
            let mut pose = Pose::new(bvh.clone());
            let matrices = [Affine3A::from_translation(Vec3::X * x); JOINTS as usize];
            pose.set_joints(&JointMatrices::new(&matrices).unwrap()).unwrap();
            pose
        };
        let (mut before, now) = (at(1.0), at(1.25));
        let mut bound = |wanted| displacement(&mut before, &place, &now, &place, wanted);
        let whole = bound(0.0..f64::INFINITY);
        assert!((whole / f64::from(0.25 * sums) - 1.0).abs() < 1e-5, "{whole}, {sums}");
        for start in [0.0, 0.5, 0.99] {
            for end in [1.01, 1.5, 4.0] {
                let same = bound(start * whole..end * whole);
                assert!((same / whole - 1.0).abs() < 1e-12, "{same}, {whole}");
            }
            assert!(bound(start * whole..0.995 * whole) > 0.995 * whole);
        }
        assert_eq!(bound(1.01 * whole..2.0 * whole), 1.01 * whole);
    }
}

/// Each axis in turn is stretched by the other two, which it is parallel to.
#[test]
fn the_bound_covers_how_much_a_sheared_place_stretches() {
    for axis in 0..3 {
        let (mut columns, mut way) = ([Vec3::X * 0.5; 3], Vec3::ONE);
        columns[axis] = Vec3::X;
        way[axis] = 2.0;
        let base = [Vec3::ZERO, Vec3::Y, Vec3::Z];
        let model = MorphModel::from_displacements(&base, &[[0, 1, 2]], &[[way; 3]]).unwrap();
        let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
        let [x, y, z] = columns;
        let place = WorldFromModel::new(Affine3A::from_mat3(glam::Mat3::from_cols(x, y, z))).unwrap();
        let [mut before, mut now] = [(); 2].map(|()| Pose::new(bvh.clone()));
        now.set_weights(&[1.0]).unwrap();
        let bound = Body::new(&mut now, &place).displacement_from(Body::new(&mut before, &place));
        assert!((3.0..4.0).contains(&bound), "{bound}");
    }
}

/// The corners of a cube are as far from its diagonal as points of its box are.
#[test]
fn the_bound_is_the_way_of_the_farthest_corner() {
    let corner = |i: u8| Vec3::from_array([1, 2, 4].map(|bit| if i & bit == 0 { -1.0 } else { 1.0 }));
    let base: Vec<Vec3> = (0..8).map(corner).collect();
    let no_targets: [Vec<Vec3>; 0] = [];
    let model = MorphModel::from_displacements(&base, &[[0, 1, 2], [3, 4, 5], [5, 6, 7]], &no_targets).unwrap();
    let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
    let turn = Affine3A::from_axis_angle(Vec3::ONE.normalize(), 0.01);
    let [from, to] = [Affine3A::IDENTITY, turn].map(|place| WorldFromModel::new(place).unwrap());
    let [mut before, mut now] = [(); 2].map(|()| Pose::new(bvh.clone()));
    let (mut old, mut new) = (Body::new(&mut before, &from), Body::new(&mut now, &to));
    let bound = new.displacement_from(old.reborrow());
    let way = |v| old.vertex(v).unwrap().distance(new.vertex(v).unwrap());
    let most = (0..8).map(way).fold(0.0, f64::max);
    assert!((most..1.001 * most).contains(&bound), "{most}, {bound}");
}
