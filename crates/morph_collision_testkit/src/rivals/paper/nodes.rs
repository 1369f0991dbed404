//! The nodes of the paper's tree with boxes, for measuring their tightness.

use glam::DVec3;
use morph_collision::{Aabb, ModelError};

use super::references::References;
use super::slabs::Slabs;
use super::tree::{Content, Tree};
use super::volume::Volume;
use super::weights::Blend;
use crate::mesh::MorphMesh;
use crate::rivals::RivalNode;
use crate::rivals::blended::WeldedMesh;

/// The paper's tree of a mesh, with boxes.
#[derive(Debug)]
pub struct PaperNodes {
    references: References,
    tree: Tree<Slabs<3>>,
    /// The triangles below each node.
    triangles: Vec<Vec<u32>>,
}

impl PaperNodes {
    /// Builds the tree.
    ///
    /// # Errors
    /// See [`MorphMesh::to_model`].
    pub fn new(mesh: &MorphMesh) -> Result<Self, ModelError> {
        let references = References::new(&WeldedMesh::new(mesh)?);
        let tree = Tree::build(&references, false);
        let mut triangles = vec![Vec::new(); tree.node_count()];
        // Children come after their parents.
        for node in (0..tree.node_count()).rev() {
            triangles[node] = match tree.content(node as u32) {
                Content::Triangle(triangle) => vec![*triangle],
                Content::Children(children) => children
                    .clone()
                    .flat_map(|child| triangles[child as usize].clone())
                    .collect(),
            };
        }
        Ok(Self {
            references,
            tree,
            triangles,
        })
    }

    /// Visits every node, with one weight per target.
    ///
    /// # Panics
    /// If weights are missing.
    pub fn visit(&self, weights: &[f32], mut visitor: impl FnMut(RivalNode<'_>)) {
        let mut blend = Blend::default();
        blend.set(weights, &self.references, false);
        for (node, triangles) in (0..).zip(&self.triangles) {
            visitor(RivalNode {
                bounds: around(self.tree.blend(node, &blend).aabb()),
                triangles,
                children: match self.tree.content(node) {
                    Content::Triangle(_) => 0,
                    Content::Children(children) => children.len(),
                },
            });
        }
    }
}

/// The box in `f32`, rounded outward.
pub(super) fn around([least, most]: [DVec3; 2]) -> Aabb {
    Aabb {
        min: least.as_vec3().map(f32::next_down),
        max: most.as_vec3().map(f32::next_up),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::random::random_blob;
    use crate::oracle::posed_vertices;

    #[test]
    fn boxes_hold_what_is_below_and_each_triangle_has_a_leaf() -> Result<(), ModelError> {
        let mesh = random_blob(3, 2, 5, 0.5);
        let weights = [0.5, -0.25, 1.5, 0.0, 0.3];
        let posed = posed_vertices(&mesh.positions, &mesh.targets, &weights);
        let (mut leaves, mut children, mut nodes) = (vec![0; mesh.triangles.len()], 0, 0);
        PaperNodes::new(&mesh)?.visit(&weights, |node| {
            for &triangle in node.triangles {
                leaves[triangle as usize] += usize::from(node.children == 0);
                for vertex in mesh.triangles[triangle as usize] {
                    let vertex = posed[vertex as usize];
                    let inside = node.bounds.min.cmple(vertex) & vertex.cmple(node.bounds.max);
                    assert!(inside.all(), "{vertex} outside {node:?}");
                }
            }
            (children, nodes) = (children + node.children, nodes + 1);
        });
        assert!(leaves.iter().all(|leaves| *leaves == 1), "{leaves:?}");
        assert_eq!(children + 1, nodes);
        Ok(())
    }
}
