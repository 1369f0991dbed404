//! Visits a posed tree's nodes, for tools.

use super::Pose;
use crate::bounds::{Aabb, WorldFromModel};
use crate::tree::ChildKind;

/// A node of a posed tree, as [`Pose::visit_nodes`] passes it to the visitor.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct PosedNode<'a> {
    /// The box around the node's triangles: in model space, or in the space of `world_from_bounds` if that is set.
    pub bounds: Aabb,
    /// For a skinned mesh, the map from the space of `bounds` to world space: its boxes have the world's axes and an origin in the body.
    pub world_from_bounds: Option<WorldFromModel>,
    /// Whether the box was cached before the visit. The root also counts as cached if its children are, because a body's bounds come
    /// from them.
    pub was_cached: bool,
    /// The number of edges from the root to the node.
    pub depth: usize,
    /// Whether the node has no children.
    pub is_leaf: bool,
    /// The triangles below the node, as indices for [`MorphModel::triangle`](crate::MorphModel::triangle).
    pub triangles: &'a [u32],
}

impl Pose {
    /// Visits the tree's nodes from the root down, for tools that draw or check it. If `visitor` returns true, the node's children
    /// are visited too.
    ///
    /// Boxes that are not cached are blended and stay cached. This changes no answer.
    pub fn visit_nodes(&mut self, mut visitor: impl FnMut(&PosedNode<'_>) -> bool) {
        let mut posed = self.posed();
        let topology = posed.topology;
        // Queries may have opened only the root's children.
        let was_cached = posed.is_open(0) || posed.is_top_open();
        let mut rest = vec![(posed.root(), was_cached, 0)];
        while let Some((node, was_cached, depth)) = rest.pop() {
            let kind = node.child.kind();
            let visited = PosedNode {
                bounds: posed.node_box(node),
                world_from_bounds: posed.is_skinned().then_some(*posed.world_from_model),
                was_cached,
                depth,
                is_leaf: matches!(kind, ChildKind::Leaf(_)),
                triangles: topology.triangles_below(node.child),
            };
            if visitor(&visited)
                && let ChildKind::Group(group) = kind
            {
                let was_cached = posed.is_open(group);
                let slot = posed.open(group);
                let lanes = (0..topology.group(group).children().len()).rev();
                rest.extend(lanes.map(|lane| (posed.node(slot, group, lane), was_cached, depth + 1)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec3;

    use crate::{BuildOptions, MorphBvh, MorphModel, Pose};

    #[test]
    fn every_level_holds_every_vertex_and_tells_which_boxes_were_cached() {
        let strip: Vec<Vec3> = (0..402).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.0)).collect();
        let triangles: Vec<[u32; 3]> = (0..400).map(|i| [i, i + 1, i + 2]).collect();
        let lift: Vec<Vec3> = strip.iter().map(|p| Vec3::Z * p.x).collect();
        let model = MorphModel::from_displacements(&strip, &triangles, &[lift]).unwrap();
        let options = BuildOptions::default().with_leaf_size(2).unwrap();
        let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &options)));
        pose.set_weights(&[0.5]).unwrap();
        let mut counts = Vec::new();
        for depth in 0..5 {
            let nodes_at = |pose: &mut Pose| {
                let mut nodes = Vec::new();
                pose.visit_nodes(|node| {
                    if node.depth == depth || node.is_leaf {
                        nodes.push((node.bounds, node.was_cached, node.triangles.to_vec()));
                    }
                    node.depth < depth
                });
                nodes
            };
            let nodes = nodes_at(&mut pose);
            // Only the boxes of the level above have been blended.
            assert!(depth > 2 || nodes.iter().all(|(_, was_cached, _)| !was_cached));
            assert!(nodes_at(&mut pose).iter().all(|(_, was_cached, _)| *was_cached));
            counts.push(nodes.len());
            let mut below: Vec<u32> = nodes.iter().flat_map(|(.., triangles)| triangles).copied().collect();
            below.sort_unstable();
            assert!(below.into_iter().eq(0..400), "depth {depth}");
            for (bounds, _, triangles) in nodes {
                for triangle in triangles {
                    let corners = pose.triangle(triangle).unwrap();
                    assert!(
                        corners.iter().all(|p| bounds.contains(*p)),
                        "{triangle} at depth {depth}"
                    );
                }
            }
        }
        assert!(counts[0] == 1 && counts[1] > 1 && counts[2] > counts[1], "{counts:?}");
        assert_eq!(counts[3], counts[4], "all are leaves");
    }
}
