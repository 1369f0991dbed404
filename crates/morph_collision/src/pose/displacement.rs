//! How far vertices may be from where they were.

use std::sync::Arc;

use super::instance::Pose;
use crate::model::MorphModel;

impl Pose {
    /// A bound on the distance in model space between any vertex and the same vertex at the weights `before`, roundings
    /// included. `before` has one weight per target. Joints do not count: it is about vertices before these move them; see
    /// [`Pose::displacement_from_pose`].
    ///
    /// Cost: linear in the number of targets.
    #[must_use]
    pub fn displacement_from(&self, before: &[f32]) -> f64 {
        displacement(self.bvh.model(), before, self.weights())
    }

    /// A bound on the distance between any vertex and the same vertex in another pose of the mesh, roundings included. Infinite for poses of
    /// different trees.
    ///
    /// Distances are in model space, those of a skinned mesh in world space: what its joints do is bounded by a box per joint, around the vertices
    /// that it moves. Cost: linear in the numbers of targets and joints; no node is blended.
    #[must_use]
    pub fn displacement_from_pose(&self, before: &mut Self) -> f64 {
        if !Arc::ptr_eq(&self.bvh, &before.bvh) {
            return f64::INFINITY;
        }
        let of_targets = self.displacement_from(before.weights());
        let (Some((_, now)), Some(skin)) = (&self.skinning, self.bvh.model().skin()) else {
            return of_targets;
        };
        let joints = now.joints.clone();
        let error = now.error();
        let mut posed = before.posed();
        let Some((of_joints, error_before)) = posed.joint_displacement(&joints) else {
            return f64::INFINITY;
        };
        // The reach of a row bounds each coordinate; the square root of 3 is in the bound for targets.
        let moved = skin.max_sum() * (of_joints + joints.linear_reach() * of_targets);
        if moved == 0.0 {
            return 0.0;
        }
        if moved.is_nan() {
            return f64::INFINITY;
        }
        moved * (1.0 + 1e-9) + 3_f64.sqrt() * (error + error_before)
    }
}

/// A bound on how far any posed vertex moves between two weight vectors, in model space: `sum |dw_k| D_k` plus the roundings
/// of both blends (docs/numerics.md, "Vertices").
fn displacement(model: &MorphModel, before: &[f32], after: &[f32]) -> f64 {
    let mut moved = 0.0;
    let mut reach = f64::from(model.base_reach());
    let mut active = 2.0;
    for ((before, after), target) in before.iter().zip(after).zip(model.target_reach()) {
        let (before, after, target) = (f64::from(*before), f64::from(*after), f64::from(*target));
        moved += (after - before).abs() * target;
        reach += before.abs().max(after.abs()) * target;
        active += f64::from(u8::from(before != 0.0 || after != 0.0));
    }
    // Without any move both blends round alike.
    let rounded = if moved == 0.0 {
        0.0
    } else {
        2.0 * active * f64::from(f32::EPSILON) * reach
    };
    // Reaches are per coordinate.
    3_f64.sqrt() * (moved + rounded)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Affine3A, DVec3, EulerRot, Quat, Vec3};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use crate::{Body, BuildOptions, Influences, JointMatrices, MorphBvh, MorphModel, Pose, WorldFromModel};

    const JOINTS: u16 = 3;

    /// Loose triangles; weights of joints that sum to 1 unless `sums` differ from that.
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
}
