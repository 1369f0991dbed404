//! Boxes that need no pose against the vertices of the pose.

use std::sync::Arc;

use bevy::math::{Affine3A, EulerRot, Quat, Vec3};
use morph_collision::{BuildOptions, Influences, JointMatrices, MorphBvh, MorphModel, Pose, WorldFromModel};
use parry3d::bounding_volume::Aabb;
use parry3d::math::Pose as Isometry;

use super::{LazyPose, SurfaceJoints};
use crate::math::affine_of;

const VERTICES: usize = 40;

/// Numbers between -1 and 1 that look random.
struct Numbers(u32);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }

    fn rotation(&mut self) -> Quat {
        let [x, y, z] = (3.0 * self.vector()).to_array();
        Quat::from_euler(EulerRot::XYZ, x, y, z)
    }

    fn collider(&mut self, far: f32) -> Isometry {
        Isometry::from_parts(far * self.vector(), self.rotation())
    }

    /// Joints near a collider.
    fn joints(&mut self, collider: &Isometry) -> SurfaceJoints {
        let mut joint = || {
            let scale = Vec3::ONE + 0.5 * self.vector();
            let own = Affine3A::from_scale_rotation_translation(scale, self.rotation(), self.vector());
            affine_of(collider) * own
        };
        let joints = JointMatrices::new(&[joint(), joint()]).unwrap();
        SurfaceJoints::drawn(joints, *collider, Vec3::ZERO).unwrap()
    }
}

/// A mesh of two targets and two joints, whose joint weights sum to `sum`.
fn mesh(numbers: &mut Numbers, sum: f32) -> Arc<MorphBvh> {
    let base: Vec<Vec3> = (0..VERTICES).map(|_| 2.0 * numbers.vector()).collect();
    let triangles: Vec<[u32; 3]> = (0..VERTICES as u32 - 2).map(|i| [i, i + 1, i + 2]).collect();
    let mut target = || -> Vec<Vec3> { (0..VERTICES).map(|_| numbers.vector()).collect() };
    let targets = [target(), target()];
    let mut share = || 0.5 + 0.5 * numbers.next();
    let weights: Vec<[f32; 4]> = (0..VERTICES)
        .map(|_| share())
        .map(|share| [sum * share, sum * (1.0 - share), 0.0, 0.0])
        .collect();
    let influences = Influences {
        joints: &[[0, 1, 0, 0]; VERTICES],
        weights: &weights,
    };
    let model = MorphModel::skinned(&base, &triangles, &targets, 2, &[influences]).unwrap();
    Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()))
}

fn check(bounds: &Aabb, points: &[Vec3], what: &str) {
    for point in points {
        let is_inside = point.cmpge(bounds.mins).all() && point.cmple(bounds.maxs).all();
        assert!(is_inside, "{what}: {point} outside {bounds:?}");
    }
}

#[test]
fn boxes_without_a_pose_hold_every_vertex_of_the_pose() {
    let mut numbers = Numbers(1);
    let (mut without_pose, mut in_world) = (0, 0);
    for case in 0..600_u32 {
        let sum = [1.0, 1.0, 0.9, 1.2][case as usize % 4];
        let far = [0.0, 3.0, 1000.0][case as usize % 3];
        let mut pose = LazyPose::new(Pose::new(mesh(&mut numbers, sum)));
        let weights = [(); 2].map(|()| numbers.next() * if case % 5 == 0 { 3.0 } else { 0.1 });
        pose.set_weights(&weights).unwrap();
        let collider = numbers.collider(far);
        let before = numbers.joints(&collider);
        let (joints, place) = match case % 7 {
            0..4 => (before, collider),
            4 => (before.between(&numbers.joints(&collider), 0.3), collider),
            _ => {
                let later = numbers.collider(far);
                (before.between(&numbers.joints(&later), 0.7), later)
            }
        };
        assert!(pose.set_joints(&joints) && !pose.is_seen());
        pose.find_bounds();
        let (local, placed) = (pose.local_bounds(&WorldFromModel::IDENTITY), pose.bounds_at(&place));
        let world_from_model = WorldFromModel::new(affine_of(&place)).unwrap();
        let in_the_world = pose.world_bounds(&world_from_model);
        without_pose += u32::from(!pose.is_seen());
        in_world += u32::from(pose.bounds.is_some_and(|it| it.at_exactly(&world_from_model).is_some()));
        let vertices: Vec<Vec3> = (0..VERTICES as u32)
            .map(|vertex| pose.get().source_vertex(vertex).unwrap())
            .collect();
        check(&local, &vertices, &format!("case {case}"));
        let to_world = |vertex: &Vec3| world_from_model.transform_point(*vertex).as_vec3();
        let there: Vec<Vec3> = vertices.iter().map(to_world).collect();
        let in_the_world = Aabb::new(in_the_world.min, in_the_world.max);
        check(&in_the_world, &there, &format!("case {case}, in the world"));
        if let Some(placed) = placed {
            check(&placed, &there, &format!("case {case}, placed"));
        }
    }
    assert!(without_pose > 300 && in_world > 200, "{without_pose}, {in_world}");
}

#[test]
fn a_pose_that_nobody_looks_at_is_not_posed() {
    let mut numbers = Numbers(2);
    let mut pose = LazyPose::new(Pose::new(mesh(&mut numbers, 1.0)));
    let at_rest = pose.get().source_vertex(0);
    let collider = numbers.collider(1.0);
    let joints = numbers.joints(&collider);
    pose.set_joints(&joints);
    pose.set_weights(&[0.1, -0.1]).unwrap();
    pose.find_bounds();
    pose.local_bounds(&WorldFromModel::IDENTITY);
    assert!(!pose.is_seen() && pose.pose.weights() == [0.0; 2]);
    assert_ne!(pose.get().source_vertex(0), at_rest);
    assert!(pose.is_seen() && pose.pose.weights() == [0.1, -0.1]);
    // The same again: nothing changes.
    pose.set_weights(&[0.1, -0.1]).unwrap();
    pose.set_joints(&joints);
    assert!(pose.is_seen());
    pose.set_weights(&[f32::NAN, 0.0]).unwrap_err();
    assert!(pose.is_seen() && pose.weights() == [0.1, -0.1]);
}
