//! Checks every box of a posed skinned tree against every vertex below it. The oracle places the vertices.

use glam::{Affine3A, DMat3, DVec3, Quat, Vec3};
use morph_collision::{Pose, WorldFromModel};

use super::{ContainmentReport, ContainmentViolation};
use crate::oracle;
use morph_collision_models::mesh::{MeshSkin, MorphMesh};

/// Upper bound on all rounding of a world position and of its way into the body's frame, in units of the terms' magnitudes.
const ROUNDINGS: f64 = 256.0 * f64::EPSILON;

/// Like [`check_containment`](super::check_containment), for a skinned mesh with these joint matrices.
///
/// The box of a node must contain each vertex taken into the frame of the box, up to the rounding of `f64`.
/// Boxes are `f32`, with rounding errors about a thousand million times as large. The same holds for the box around the whole body in
/// another space. Both boxes around the whole body in world space must contain each vertex exactly.
///
/// # Panics
/// If the mesh has no skin, or names a joint that is not among `joints`.
pub fn check_skinned_containment(mesh: &MorphMesh, joints: &[Affine3A], pose: &mut Pose) -> ContainmentReport {
    let skin = mesh.skin.as_ref().expect("the mesh is skinned");
    let posed = oracle::posed_vertices(&mesh.positions, &mesh.targets, pose.weights());
    let world = oracle::skinned_vertices(&posed, &skin.sets, joints);
    check_at(mesh, &world, reach(&posed, skin, joints), pose)
}

/// Checks boxes against vertices computed from numbers up to `reach`.
fn check_at(mesh: &MorphMesh, world: &[DVec3], reach: f64, pose: &mut Pose) -> ContainmentReport {
    let mut report = ContainmentReport::default();
    let place = WorldFromModel::IDENTITY;
    let bounds = [pose.world_bounds(&place), pose.broad_phase_bounds(&place)];
    let turned = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.9), Vec3::new(1.0, 0.0, -2.0));
    let turned = WorldFromModel::new(turned).expect("it is finite");
    let (local, to_local) = (pose.local_bounds(&turned), Inverse::new(&turned));
    let mut check = |vertex: u32, depth: usize, position: DVec3, slack: f64, min: Vec3, max: Vec3| {
        report.checks += 1;
        let below = (min.as_dvec3() - slack).cmple(position);
        if !(below & position.cmple(max.as_dvec3() + slack)).all() {
            report.violations += 1;
            report.first.get_or_insert(ContainmentViolation {
                vertex,
                depth,
                position,
            });
        }
    };
    for &vertex in mesh.triangles.iter().flatten() {
        for bounds in &bounds {
            check(vertex, 0, world[vertex as usize], 0.0, bounds.min, bounds.max);
        }
        let (position, slack) = to_local.point(world[vertex as usize], reach);
        check(vertex, 0, position, slack, local.min, local.max);
    }
    pose.visit_nodes(|node| {
        let frame = node.world_from_bounds.as_ref().map(Inverse::new);
        for &vertex in node
            .triangles
            .iter()
            .flat_map(|&triangle| &mesh.triangles[triangle as usize])
        {
            let position = world[vertex as usize];
            let (position, slack) = match &frame {
                None => (position, 0.0),
                Some(frame) => frame.point(position, reach),
            };
            check(vertex, node.depth, position, slack, node.bounds.min, node.bounds.max);
        }
        true
    });
    report
}

/// A bound on the numbers from which world positions are computed.
fn reach(posed: &[Vec3], skin: &MeshSkin, joints: &[Affine3A]) -> f64 {
    let largest = posed.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
    let of_joint = |joint: &Affine3A| {
        let rows = (0..3).map(|row| joint.matrix3.row(row).abs().element_sum());
        f64::from(rows.fold(0.0, f32::max)) * f64::from(largest) + f64::from(joint.translation.abs().max_element())
    };
    let of_joints = joints.iter().map(of_joint).fold(0.0, f64::max);
    let sum = |vertex: usize| skin.sets.iter().flat_map(|set| set.weights[vertex]).sum::<f32>();
    let sums = (0..posed.len()).map(sum).fold(0.0, f32::max);
    of_joints * f64::from(sums.max(1.0))
}

/// Maps world space into a box's space.
struct Inverse {
    linear: DMat3,
    /// The largest sum of absolute values in a row of `linear`.
    norm: f64,
    origin: DVec3,
}

impl Inverse {
    fn new(place: &WorldFromModel) -> Self {
        let origin = place.transform_point(Vec3::ZERO);
        // A large factor, 2^127, so that even the largest origin causes no rounding.
        const FAR: f32 = f32::from_bits(254 << 23);
        let column = |axis: Vec3| (place.transform_point(axis * FAR) - origin) / f64::from(FAR);
        let linear = DMat3::from_cols(column(Vec3::X), column(Vec3::Y), column(Vec3::Z)).inverse();
        let rows = (0..3).map(|row| linear.row(row).abs().element_sum());
        Self {
            norm: rows.fold(0.0, f64::max),
            linear,
            origin,
        }
    }

    /// A point, and its error bound along each axis.
    fn point(&self, world: DVec3, reach: f64) -> (DVec3, f64) {
        let point = self.linear * (world - self.origin);
        let slack = ROUNDINGS * (self.norm * (reach + self.origin.abs().max_element()) + point.abs().max_element());
        (point, slack)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use morph_collision::{BuildOptions, JointMatrices, MorphBvh};

    use super::*;
    use morph_collision_models::generated::rigs::{PoseKind, branching};

    fn posed(kind: PoseKind) -> Result<(MorphMesh, Vec<Affine3A>, Pose), Box<dyn std::error::Error>> {
        let mesh = branching(2, 20, 4, 3);
        let joints = kind.draw(&mesh.skin.as_ref().ok_or("no skin")?.skeleton, 5);
        let mut pose = Pose::new(Arc::new(MorphBvh::build(
            Arc::new(mesh.to_model()?),
            &BuildOptions::default(),
        )));
        pose.set_weights(&[0.5, -1.0, 2.0])?;
        pose.set_joints(&JointMatrices::new(&joints)?)?;
        Ok((mesh, joints, pose))
    }

    #[test]
    fn boxes_hold_the_vertices_of_their_own_joints() -> Result<(), Box<dyn std::error::Error>> {
        for kind in PoseKind::ALL {
            let (mesh, joints, mut pose) = posed(kind)?;
            let report = check_skinned_containment(&mesh, &joints, &mut pose);
            assert!(report.checks >= 9 * mesh.triangles.len() as u64, "{kind:?}: {report:?}");
            assert_eq!(report.first, None, "{kind:?}: {report:?}");
        }
        Ok(())
    }

    #[test]
    fn one_joint_or_one_vertex_elsewhere_is_caught() -> Result<(), Box<dyn std::error::Error>> {
        let (mut mesh, mut joints, mut pose) = posed(PoseKind::Turned)?;
        let right = joints.clone();
        joints[7].translation.x += 0.01;
        let report = check_skinned_containment(&mesh, &joints, &mut pose);
        assert!(
            report.violations > 0 && report.violations < report.checks / 2,
            "{report:?}"
        );
        mesh.positions[100] += Vec3::splat(1.0);
        let report = check_skinned_containment(&mesh, &right, &mut pose);
        assert_eq!(report.first.as_ref().map(|first| first.vertex), Some(100), "{report:?}");
        assert!(report.violations < report.checks / 100, "{report:?}");
        Ok(())
    }
}
