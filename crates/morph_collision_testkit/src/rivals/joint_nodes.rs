//! The nodes of `joint-boxes`, for measuring their tightness.

use glam::Affine3A;
use morph_collision::ModelError;

use super::blended::WeldedMesh;
use super::joint_boxes::Measured;
use super::tree::Child;
use super::{MethodOptions, RivalNode};
use morph_collision_models::mesh::MorphMesh;

/// The tree of a skinned mesh whose boxes are composed of one box per joint.
#[derive(Debug)]
pub struct JointNodes {
    measured: Measured,
}

impl JointNodes {
    /// Builds the tree.
    ///
    /// # Errors
    /// See [`MorphMesh::to_model`].
    pub fn new(mesh: &MorphMesh, options: &MethodOptions) -> Result<Self, ModelError> {
        let measured = Measured::new(&WeldedMesh::new(mesh)?, options);
        Ok(Self { measured })
    }

    /// Visits every node, with one weight per target and one matrix per joint, which maps to world space. Parents come before
    /// their children.
    ///
    /// # Panics
    /// If weights or joints are missing.
    pub fn visit(&self, weights: &[f32], joints: &[Affine3A], mut visitor: impl FnMut(RivalNode<'_>)) {
        let Measured { tree, nodes, .. } = &self.measured;
        for (group, nodes) in tree.groups.iter().zip(nodes) {
            for (&child, &node) in group.children().iter().zip(nodes) {
                visitor(RivalNode {
                    bounds: self.measured.bounds(node, weights, joints).aabb(),
                    triangles: &tree.triangles[tree.under(child)],
                    children: match child {
                        Child::Leaf(_) => 0,
                        Child::Group(group) => tree.groups[group as usize].children().len(),
                    },
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::{posed_vertices, skinned_vertices};
    use morph_collision_models::generated::rigs::{PoseKind, branching};

    #[test]
    fn boxes_hold_what_is_below_and_each_triangle_has_a_leaf() -> Result<(), ModelError> {
        let mesh = branching(2, 12, 4, 2);
        let skin = mesh.skin.as_ref().expect("it is skinned");
        let joints = PoseKind::Scaled.draw(&skin.skeleton, 3);
        let weights = [0.5, -0.5];
        let posed = posed_vertices(&mesh.positions, &mesh.targets, &weights);
        let world = skinned_vertices(&posed, &skin.sets, &joints);
        let (mut seen, mut children, mut nodes) = (vec![0; mesh.triangles.len()], 0, 0);
        JointNodes::new(&mesh, &MethodOptions::default())?.visit(&weights, &joints, |node| {
            for &triangle in node.triangles {
                seen[triangle as usize] += usize::from(node.children == 0);
                for vertex in mesh.triangles[triangle as usize] {
                    let vertex = world[vertex as usize];
                    let (min, max) = (node.bounds.min.as_dvec3(), node.bounds.max.as_dvec3());
                    let inside = min.cmple(vertex) & vertex.cmple(max);
                    assert!(inside.all(), "{vertex} outside {node:?}");
                }
            }
            (children, nodes) = (children + node.children, nodes + 1);
        });
        assert!(seen.iter().all(|leaves| *leaves == 1), "{seen:?}");
        // All nodes except the root are children.
        assert_eq!(children + 1, nodes);
        Ok(())
    }
}
