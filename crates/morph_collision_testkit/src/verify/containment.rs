//! Checks every box of a posed tree against every vertex below it. The positions are blended here, from the mesh.

use glam::DVec3;
use morph_collision::Pose;

use crate::oracle;
use morph_collision_models::mesh::MorphMesh;

/// The outcome of [`check_containment`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContainmentReport {
    /// The number of checks of one position and one box.
    pub checks: u64,
    /// The number of positions outside a box.
    pub violations: u64,
    /// The first violation.
    pub first: Option<ContainmentViolation>,
}

/// A vertex outside a box that should hold it.
#[derive(Clone, Debug, PartialEq)]
pub struct ContainmentViolation {
    /// The vertex of the mesh.
    pub vertex: u32,
    /// Edges from the root to the node.
    pub depth: usize,
    /// The position of the vertex, in model space.
    pub position: DVec3,
}

/// Checks every box of a pose of `mesh` against every vertex below it: both the vertex rounded to `f32` and its position
/// in `f64`.
///
/// A violation is a bug in the library, except after [`Pose::refit`]: see [`check_refitted_containment`].
pub fn check_containment(mesh: &MorphMesh, pose: &mut Pose) -> ContainmentReport {
    let weights = pose.weights().to_vec();
    check_at(mesh, &weights, pose)
}

/// Like [`check_containment`], but for use after [`Pose::refit`], which fits boxes only to the rounded vertices.
pub fn check_refitted_containment(mesh: &MorphMesh, pose: &mut Pose) -> ContainmentReport {
    let rounded = oracle::posed_vertices(&mesh.positions, &mesh.targets, pose.weights());
    let positions: Vec<_> = rounded.iter().map(|p| [p.as_dvec3()]).collect();
    check_positions(mesh, &positions, pose)
}

/// Checks a pose's boxes against the vertices at some weights.
fn check_at(mesh: &MorphMesh, weights: &[f32], pose: &mut Pose) -> ContainmentReport {
    let rounded = oracle::posed_vertices(&mesh.positions, &mesh.targets, weights);
    let mut exact: Vec<DVec3> = mesh.positions.iter().map(|p| p.as_dvec3()).collect();
    for (target, &weight) in mesh.targets.iter().zip(weights) {
        for (position, displacement) in exact.iter_mut().zip(target) {
            *position += displacement.as_dvec3() * f64::from(weight);
        }
    }
    let rounded = rounded.iter().map(|p| p.as_dvec3());
    let positions: Vec<[DVec3; 2]> = rounded.zip(exact).map(<[_; 2]>::from).collect();
    check_positions(mesh, &positions, pose)
}

/// Checks a pose's boxes against positions of each vertex.
fn check_positions<const N: usize>(mesh: &MorphMesh, positions: &[[DVec3; N]], pose: &mut Pose) -> ContainmentReport {
    let mut report = ContainmentReport::default();
    pose.visit_nodes(|node| {
        let (min, max) = (node.bounds.min.as_dvec3(), node.bounds.max.as_dvec3());
        for &triangle in node.triangles {
            for vertex in mesh.triangles[triangle as usize] {
                for position in positions[vertex as usize] {
                    report.checks += 1;
                    if !(min.cmple(position) & position.cmple(max)).all() {
                        report.violations += 1;
                        report.first.get_or_insert(ContainmentViolation {
                            vertex,
                            depth: node.depth,
                            position,
                        });
                    }
                }
            }
        }
        true
    });
    report
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec3;
    use morph_collision::{BuildOptions, MorphBvh};

    use super::*;
    use morph_collision_models::generated::dolphin;

    #[test]
    fn boxes_of_other_weights_are_caught_at_every_depth() -> Result<(), Box<dyn std::error::Error>> {
        let mesh = dolphin(0);
        let bvh = MorphBvh::build(Arc::new(mesh.to_model()?), &BuildOptions::default());
        let depth = bvh.depth();
        let mut pose = Pose::new(Arc::new(bvh));
        let mut weights = vec![0.0; mesh.targets.len()];
        weights[0] = 0.5;
        pose.set_weights(&weights)?;
        let right = check_containment(&mesh, &mut pose);
        assert_eq!((right.violations, &right.first), (0, &None));
        let mut refitted = pose.clone();
        refitted.refit();
        let tight = check_refitted_containment(&mesh, &mut refitted);
        assert_eq!((tight.violations, 2 * tight.checks), (0, right.checks));
        assert!(right.checks >= 6 * (mesh.triangles.len() * depth) as u64, "{right:?}");
        weights[0] = 3.0;
        let wrong = check_at(&mesh, &weights, &mut pose);
        let first = wrong.first.ok_or("no violation")?;
        assert_eq!(wrong.checks, right.checks);
        assert!(
            wrong.violations > wrong.checks / 10,
            "{} of {}",
            wrong.violations,
            wrong.checks
        );
        assert_eq!(first.depth, 0);
        // Only vertices that the target moves are outside.
        assert_ne!(mesh.targets[0][first.vertex as usize], Vec3::ZERO);
        Ok(())
    }

    #[test]
    fn one_vertex_outside_one_leaf_is_caught() -> Result<(), Box<dyn std::error::Error>> {
        let mut mesh = dolphin(0);
        let bvh = MorphBvh::build(Arc::new(mesh.to_model()?), &BuildOptions::default());
        let mut pose = Pose::new(Arc::new(bvh));
        // One vertex is slightly off: inside the boxes of all nodes except the smallest ones around it.
        let size = pose.bounds().size().max_element();
        let center = pose.bounds().center();
        let towards = (center - mesh.positions[100]).normalize_or_zero();
        mesh.positions[100] += towards * (0.1 * size);
        let report = check_containment(&mesh, &mut pose);
        let first = report.first.ok_or("no violation")?;
        assert_eq!(first.vertex, 100);
        assert!(first.depth > 0 && report.violations < report.checks / 100, "{first:?}");
        Ok(())
    }
}
