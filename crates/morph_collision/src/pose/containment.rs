//! Every box of a posed tree checked against every vertex below it.

use glam::{DVec3, Vec3};

use super::{Pose, Posed};
use crate::bounds::Aabb;
use crate::model::MorphModel;
use crate::tree::ChildKind;

/// The outcome of [`Pose::check_containment`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContainmentReport {
    /// How often a vertex was looked for in a box.
    pub checks: u64,
    /// How often it was outside.
    pub violations: u64,
    /// The first violation.
    pub first: Option<ContainmentViolation>,
}

/// A vertex outside a box that should hold it.
#[derive(Clone, Debug, PartialEq)]
pub struct ContainmentViolation {
    /// The welded vertex.
    pub vertex: u32,
    /// Edges from the root to the node.
    pub depth: usize,
    /// Where the vertex is, in model space.
    pub position: DVec3,
}

impl Pose {
    /// Checks every box of the tree, blended for the weights in force, against every vertex below it: both the posed
    /// vertex in `f32` and its position to `f64` precision.
    ///
    /// A tool for tests and tools; it blends the whole mesh. Any violation is a bug of this crate, but after a
    /// [`Pose::refit`]: those boxes are fitted to the rounded vertices alone.
    pub fn check_containment(&mut self) -> ContainmentReport {
        let mut report = ContainmentReport::default();
        check_group(&mut self.posed(), 0, &mut Vec::new(), &mut report);
        report
    }
}

fn check_group(posed: &mut Posed<'_>, group: usize, above: &mut Vec<Aabb>, report: &mut ContainmentReport) {
    let slot = posed.open(group);
    let topology = posed.topology;
    for (lane, child) in topology.group(group).children().iter().enumerate() {
        above.push(posed.boxes(slot).get(lane));
        match child.kind() {
            ChildKind::Group(group) => check_group(posed, group, above, report),
            ChildKind::Leaf(leaf) => {
                for &triangle in topology.leaf_triangles(leaf) {
                    for vertex in posed.model.triangle(triangle as usize) {
                        check_vertex(posed, vertex, above, report);
                    }
                }
            }
        }
        above.pop();
    }
}

fn check_vertex(posed: &mut Posed<'_>, vertex: u32, above: &[Aabb], report: &mut ContainmentReport) {
    let rounded: Vec3 = posed.vertex(vertex);
    for position in [rounded.as_dvec3(), exact_vertex(posed.model, vertex, posed.weights)] {
        for (depth, bounds) in above.iter().enumerate() {
            report.checks += 1;
            let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
            if !(min.cmple(position) & position.cmple(max)).all() {
                report.violations += 1;
                report.first.get_or_insert(ContainmentViolation {
                    vertex,
                    depth,
                    position,
                });
            }
        }
    }
}

fn exact_vertex(model: &MorphModel, vertex: u32, weights: &[f32]) -> DVec3 {
    let displacements = model.displacements(vertex).iter();
    displacements.fold(model.base(vertex).as_dvec3(), |position, d| {
        position + d.delta.as_dvec3() * f64::from(weights[d.target as usize])
    })
}
