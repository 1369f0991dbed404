//! Where a vertex is: the `f32` blend, then the `f64` world position.

use glam::{Affine3A, DVec3, Vec3};

/// Blends every vertex in model space: `b + w_0 d_0 + w_1 d_1 + ...`.
///
/// `targets` hold one displacement per vertex, in model units, or none where a target moves nothing. The sum runs in `f32` over the targets in ascending order;
/// a weight of exactly zero leaves its target out, and every step multiplies, rounds, adds and rounds: never fused.
///
/// # Panics
///
/// If there are not as many weights as targets or a target is neither empty nor as long as `base`.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_added_in_ascending_order_and_rounded_each_time() {
        // 1 + 2^-24 rounds back to 1, twice; summed the other way round the two halves would make one step.
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
}
