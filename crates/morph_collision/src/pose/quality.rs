//! How good a tree is at some weights.

use super::anchor::Anchor;
use super::{Pose, Posed};
use crate::bounds::Aabb;
use crate::tree::{ChildKind, Topology};

/// What a tree costs at some weights, by the surface-area heuristic: how many tests a random query that hits the root's
/// tight box is expected to make. From [`Pose::quality`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeQuality {
    /// Expected tests with volumes as they are blended.
    pub cost: f64,
    /// Expected tests if every volume were fitted to its vertices.
    pub tight_cost: f64,
}

impl TreeQuality {
    /// How much looser than tight the blended volumes are: 1 is tight.
    #[must_use]
    pub fn looseness(&self) -> f64 {
        self.cost / self.tight_cost
    }
}

impl Pose {
    /// Measures the tree at the weights in force: the cost of its blended boxes and of tight ones.
    ///
    /// A tool for choosing build options; it blends the whole mesh. A mesh that is a point costs 0.
    pub fn quality(&mut self) -> TreeQuality {
        quality(&mut self.posed())
    }
}

fn quality(posed: &mut Posed<'_>) -> TreeQuality {
    let tight = Anchor::fit(posed.model, posed.topology, posed.weights);
    let root = half_area(&tight.boxes[0].get(0));
    let mut quality = TreeQuality {
        cost: 0.0,
        tight_cost: 0.0,
    };
    if root == 0.0 {
        return quality;
    }
    for group in 0..posed.topology.group_count() {
        let slot = posed.open(group);
        for (lane, child) in posed.topology.group(group).children().iter().enumerate() {
            let tests = tests_below(posed.topology, child.kind()) as f64 / root;
            quality.cost += tests * half_area(&posed.boxes(slot).get(lane));
            quality.tight_cost += tests * half_area(&tight.boxes[group].get(lane));
        }
    }
    quality
}

/// What visiting a node takes: its children, or its triangles.
fn tests_below(topology: &Topology, node: ChildKind) -> usize {
    match node {
        ChildKind::Group(group) => topology.group(group).children().len(),
        ChildKind::Leaf(leaf) => topology.leaf_triangles(leaf).len(),
    }
}

fn half_area(bounds: &Aabb) -> f64 {
    let s = bounds.size().as_dvec3();
    s.x * s.y + s.y * s.z + s.z * s.x
}
