//! The nodes of a posed tree, to look at.

use super::{NodeRef, Pose, Posed};
use crate::bounds::Aabb;
use crate::tree::ChildKind;

impl Pose {
    /// Calls `visitor` with the boxes, in model space, around the nodes `depth` levels below the root, and around leaves that
    /// are higher up; with each, whether its box had been blended for these weights before.
    ///
    /// Boxes that were not are blended for it: to look at a tree changes what was looked at, and no answer.
    pub fn visit_bounds(&mut self, depth: usize, mut visitor: impl FnMut(Aabb, bool)) {
        self.posed().visit_bounds(depth, &mut visitor);
    }
}

impl Posed<'_> {
    fn visit_bounds(&mut self, depth: usize, visitor: &mut impl FnMut(Aabb, bool)) {
        let was_fresh = self.is_open(0);
        let root = self.root();
        let mut left = vec![(root, was_fresh, 0)];
        while let Some((node, was_fresh, at)) = left.pop() {
            match node.child.kind() {
                ChildKind::Group(group) if at < depth => {
                    let was_fresh = self.is_open(group);
                    let slot = self.open(group);
                    let children = self.topology.group(group).children().len();
                    let lanes = (0..children).rev();
                    let nodes: Vec<NodeRef> = lanes.map(|lane| self.node(slot, group, lane)).collect();
                    left.extend(nodes.into_iter().map(|node| (node, was_fresh, at + 1)));
                }
                _ => visitor(self.node_box(node), was_fresh),
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
    fn every_depth_holds_every_vertex_and_says_what_was_there() {
        let strip: Vec<Vec3> = (0..402).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.0)).collect();
        let triangles: Vec<[u32; 3]> = (0..400).map(|i| [i, i + 1, i + 2]).collect();
        let lift: Vec<Vec3> = strip.iter().map(|p| Vec3::Z * p.x).collect();
        let model = MorphModel::from_displacements(&strip, &triangles, &[lift]).unwrap();
        let options = BuildOptions::default().with_leaf_size(2);
        let bvh = Arc::new(MorphBvh::build(Arc::new(model), &options).unwrap());
        let mut pose = Pose::new(bvh);
        pose.set_weights(&[0.5]).unwrap();
        let mut counts = Vec::new();
        for depth in 0..5 {
            let mut boxes = Vec::new();
            pose.visit_bounds(depth, |bounds, was_fresh| boxes.push((bounds, was_fresh)));
            // The level above was looked at before this one.
            assert!(depth > 2 || boxes.iter().all(|(_, was_fresh)| !was_fresh));
            counts.push(boxes.len());
            for (i, p) in strip.iter().enumerate() {
                let posed = pose.source_vertex(i).unwrap();
                assert!(boxes.iter().any(|(bounds, _)| bounds.contains(posed)), "{p} at {depth}");
            }
            let mut again = Vec::new();
            pose.visit_bounds(depth, |_, was_fresh| again.push(was_fresh));
            assert!(again.iter().all(|was_fresh| *was_fresh));
        }
        assert!(counts[0] == 1 && counts[1] > 1 && counts[2] > counts[1], "{counts:?}");
        assert_eq!(counts[3], counts[4], "all are leaves");
    }
}
