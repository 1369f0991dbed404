//! Computes the position of a vertex: the `f32` blend, then the `f64` world position.

use glam::{Affine3A, DVec3, Vec3};

use morph_collision_models::mesh::InfluenceSet;

/// Blends every vertex in model space: `b + w_0 d_0 + w_1 d_1 + ...`.
///
/// Each target holds one displacement per vertex, in model units, or is empty if it moves nothing. The sum runs in `f32` over the
/// targets in ascending order. A weight of exactly zero skips its target. Every step multiplies, rounds, adds and rounds: never
/// fused.
///
/// # Panics
///
/// If the numbers of weights and targets differ, or a target is neither empty nor as long as `base`.
pub fn posed_vertices(base: &[Vec3], targets: &[Vec<Vec3>], weights: &[f32]) -> Vec<Vec3> {
    assert_eq!(weights.len(), targets.len(), "one weight per target");
    for (index, target) in targets.iter().enumerate() {
        let fits = target.is_empty() || target.len() == base.len();
        assert!(fits, "displacements of target {index}");
    }
    let mut posed = base.to_vec();
    for (target, &weight) in targets.iter().zip(weights) {
        if weight == 0.0 {
            continue;
        }
        for (vertex, displacement) in posed.iter_mut().zip(target) {
            vertex.x += weight * displacement.x;
            vertex.y += weight * displacement.y;
            vertex.z += weight * displacement.z;
        }
    }
    posed
}

/// Takes model-space vertices to world space in `f64`: per component `((m_x * x + m_y * y) + m_z * z) + t`.
///
/// All factors are converted from `f32` first; every operation rounds once, none is fused.
pub fn world_vertices(vertices: &[Vec3], world_from_model: &Affine3A) -> Vec<DVec3> {
    let x_axis = world_from_model.matrix3.x_axis.as_dvec3();
    let y_axis = world_from_model.matrix3.y_axis.as_dvec3();
    let z_axis = world_from_model.matrix3.z_axis.as_dvec3();
    let translation = world_from_model.translation.as_dvec3();
    vertices
        .iter()
        .map(|vertex| {
            let v = vertex.as_dvec3();
            let component = |m_x: f64, m_y: f64, m_z: f64, t: f64| ((m_x * v.x + m_y * v.y) + m_z * v.z) + t;
            DVec3::new(
                component(x_axis.x, y_axis.x, z_axis.x, translation.x),
                component(x_axis.y, y_axis.y, z_axis.y, translation.y),
                component(x_axis.z, y_axis.z, z_axis.z, translation.z),
            )
        })
        .collect()
}

/// Takes morphed vertices to world space by their joints, in `f64`.
///
/// `joints` map the mesh's space to world space. The entries of a vertex's matrix are `((w_0 J_0 + w_1 J_1) + w_2 J_2) + ...`
/// over the slots of all sets in order. Slots of weight 0 are skipped, and weights are not normalised. A component of the
/// position is `((m_x * x + m_y * y) + m_z * z) + t`. All factors are converted from `f32` first; every operation rounds once,
/// none is fused.
///
/// # Panics
///
/// If a set is shorter than `posed`, or a weight that is not 0 names a joint that does not exist.
pub fn skinned_vertices(posed: &[Vec3], sets: &[InfluenceSet], joints: &[Affine3A]) -> Vec<DVec3> {
    let joints: Vec<[f64; 12]> = joints
        .iter()
        .map(|joint| joint.to_cols_array().map(f64::from))
        .collect();
    let mut world = Vec::with_capacity(posed.len());
    for (vertex, position) in posed.iter().enumerate() {
        let mut matrix = [0.0_f64; 12];
        for set in sets {
            for (joint, weight) in std::iter::zip(set.joints[vertex], set.weights[vertex]) {
                if weight == 0.0 {
                    continue;
                }
                for (sum, entry) in matrix.iter_mut().zip(joints[usize::from(joint)]) {
                    let product = f64::from(weight) * entry;
                    *sum += product;
                }
            }
        }
        let [x, y, z] = position.to_array().map(f64::from);
        let component = |row: usize| ((matrix[row] * x + matrix[row + 3] * y) + matrix[row + 6] * z) + matrix[row + 9];
        world.push(DVec3::new(component(0), component(1), component(2)));
    }
    world
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_added_in_ascending_order_and_rounded_each_time() {
        // 1 + 2^-24 rounds back to 1, twice. Summed in the other order, the two halves would make one step.
        let tiny = 2f32.powi(-24);
        let posed = posed_vertices(&[Vec3::X], &[vec![Vec3::X * tiny], vec![Vec3::X * tiny]], &[1.0, 1.0]);
        assert_eq!(posed, [Vec3::X]);
        let posed = posed_vertices(&[Vec3::X * tiny], &[vec![Vec3::X * tiny], vec![Vec3::X]], &[1.0, 1.0]);
        assert_eq!(posed, [Vec3::X * (1.0 + f32::EPSILON)]);
    }

    #[test]
    fn the_product_is_rounded_before_it_is_added() {
        let x = 1.0 + 2f32.powi(-12); // x * x = 1 + 2^-11 + 2^-24 rounds to 1 + 2^-11
        let posed = posed_vertices(&[Vec3::X * -1.0], &[vec![Vec3::X * x]], &[x]);
        assert_eq!(posed[0].x, 2f32.powi(-11));
        assert_ne!(posed[0].x, x.mul_add(x, -1.0));
    }

    #[test]
    fn a_zero_weight_leaves_its_target_out() {
        let posed = posed_vertices(&[Vec3::X], &[vec![Vec3::INFINITY], vec![Vec3::Y]], &[-0.0, 2.0]);
        assert_eq!(posed, [Vec3::new(1.0, 2.0, 0.0)]);
    }

    #[test]
    fn the_world_position_is_computed_in_f64() {
        let scale = 1.0 + 2f32.powi(-23);
        let world_from_model =
            Affine3A::from_scale(Vec3::splat(scale)) * Affine3A::from_translation(Vec3::new(0.0, 0.0, 2.0));
        let world = world_vertices(&[Vec3::splat(scale)], &world_from_model);
        let square = f64::from(scale) * f64::from(scale);
        assert_eq!(world, [DVec3::new(square, square, square + f64::from(2.0 * scale))]);
    }

    #[test]
    fn a_shear_adds_the_columns_in_order() {
        let world_from_model =
            Affine3A::from_cols_array(&[1.0, 2.0, 3.0, 10.0, 20.0, 30.0, 100.0, 200.0, 300.0, 0.5, 0.25, 0.125]);
        let world = world_vertices(&[Vec3::new(1.0, 2.0, 3.0)], &world_from_model);
        assert_eq!(world, [DVec3::new(321.5, 642.25, 963.125)]);
    }

    /// One vertex with these influences.
    fn influences(slots: &[(u16, f32)]) -> Vec<InfluenceSet> {
        let set = |slots: &[(u16, f32)]| {
            let slot = |i: usize| slots.get(i).copied().unwrap_or((9, 0.0));
            InfluenceSet {
                joints: vec![[0, 1, 2, 3].map(|i| slot(i).0)],
                weights: vec![[0, 1, 2, 3].map(|i| slot(i).1)],
            }
        };
        slots.chunks(4).map(set).collect()
    }

    #[test]
    fn a_vertex_moves_with_the_weighted_sum_of_its_joints_matrices() {
        let joints = [
            Affine3A::from_translation(Vec3::X * 8.0),
            Affine3A::from_scale(Vec3::new(2.0, 4.0, -1.0)),
        ];
        let sets = influences(&[(1, 0.25), (0, 0.75)]);
        let world = skinned_vertices(&[Vec3::new(1.0, 2.0, 3.0)], &sets, &joints);
        assert_eq!(
            world,
            [DVec3::new(
                0.75 * 9.0 + 0.25 * 2.0,
                0.75 * 2.0 + 0.25 * 8.0,
                0.75 * 3.0 - 0.25 * 3.0
            )]
        );
    }

    #[test]
    fn weights_that_do_not_sum_to_one_pull_from_the_world_s_origin() {
        let joints = [Affine3A::from_translation(Vec3::Y * 10.0)];
        let at = |weight| skinned_vertices(&[Vec3::X], &influences(&[(0, weight)]), &joints)[0];
        assert_eq!(at(0.5), DVec3::new(0.5, 5.0, 0.0));
        assert_eq!(at(3.0), DVec3::new(3.0, 30.0, 0.0));
        assert_eq!(at(0.0), DVec3::ZERO);
    }

    #[test]
    fn slots_are_added_in_order_over_both_sets() {
        // 2^53 + 1 - 2^53 + 1 is 1 from left to right, and 2 if the large ones come first. `f32` entries hold these numbers.
        let joints = [2_f32.powi(53), 1.0, -(2_f32.powi(53)), 1.0].map(|x| Affine3A::from_translation(Vec3::X * x));
        let one = |order: [u16; 4]| {
            let slots: Vec<(u16, f32)> = order.into_iter().map(|joint| (joint, 1.0)).collect();
            // A slot of weight 0 in between moves the last one into the second set.
            let slots = [&slots[..3], &[(9, 0.0)], &slots[3..]].concat();
            skinned_vertices(&[Vec3::ZERO], &influences(&slots), &joints)[0].x
        };
        assert_eq!(one([0, 1, 2, 3]), 1.0);
        assert_eq!(one([0, 2, 1, 3]), 2.0);
        assert_eq!(one([1, 3, 0, 2]), 2.0);
    }

    #[test]
    fn a_slot_of_weight_zero_may_name_any_joint() {
        let joints = [Affine3A::IDENTITY, Affine3A::from_scale(Vec3::INFINITY)];
        let sets = influences(&[(1, 0.0), (999, -0.0), (0, 1.0)]);
        assert_eq!(skinned_vertices(&[Vec3::ONE], &sets, &joints), [DVec3::ONE]);
    }
}
