//! How much larger the boxes of a posed tree are than the smallest ones in the same spaces.
//!
//! The measure is the cost of a walk by the surface-area heuristic: the sum over nodes of a box's area times the number of children
//! or triangles below the node.
//!
//! ```
//! use std::sync::Arc;
//! use morph_collision::{BuildOptions, MorphBvh, Pose};
//! use morph_collision_models::generated::dolphin;
//! use morph_collision_testkit::tightness;
//!
//! let model = dolphin(0).to_model()?;
//! let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
//! pose.set_weights(&[0.7, 0.2])?;
//! let corners = tightness::corners(&mut pose);
//! let blended = tightness::of_pose(&mut pose, &corners);
//! assert!(blended.ratio() > 1.0 && blended.ratio() < 2.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use glam::{DMat3, DVec3};
use morph_collision::{Body, Pose, WorldFromModel};

use crate::rivals::RivalNode;

/// Costs of a tree, or sums over several trees or poses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tightness {
    /// With the smallest box of every node.
    pub smallest: f64,
    /// With the smallest boxes of leaves, and the others as they are.
    pub leaves_tight: f64,
    /// With all boxes as they are.
    pub actual: f64,
}

impl Tightness {
    /// The cost of the boxes over that of the smallest ones; 1 is tight.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.actual / self.smallest
    }

    /// The same if the boxes of leaves were the smallest.
    #[must_use]
    pub fn ratio_with_tight_leaves(&self) -> f64 {
        self.leaves_tight / self.smallest
    }

    /// Adds the costs of another tree or pose.
    pub fn add(&mut self, other: &Self) {
        self.smallest += other.smallest;
        self.leaves_tight += other.leaves_tight;
        self.actual += other.actual;
    }

    fn add_node(&mut self, node: &Node<'_>, corners: &[[DVec3; 3]]) {
        // The space of a box may be scaled, so areas are compared in the world's unit.
        let origin = node.place.transform_point(glam::Vec3::ZERO);
        let axis = |axis: glam::Vec3| node.place.transform_point(axis) - origin;
        let linear = DMat3::from_cols(axis(glam::Vec3::X), axis(glam::Vec3::Y), axis(glam::Vec3::Z));
        let (inverse, unit) = (linear.inverse(), linear.determinant().abs().powf(2.0 / 3.0));
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &triangle in node.triangles {
            for corner in corners[triangle as usize] {
                let point = inverse * (corner - origin);
                (min, max) = (min.min(point), max.max(point));
            }
        }
        let is_leaf = node.children == 0;
        let below = if is_leaf { node.triangles.len() } else { node.children } as f64;
        let area = |size: DVec3| (size.x * size.y + size.y * size.z + size.z * size.x) * unit * below;
        let (smallest, actual) = (area(max - min), area(node.max - node.min));
        self.smallest += smallest;
        self.actual += actual;
        self.leaves_tight += if is_leaf { smallest } else { actual };
    }
}

/// A node, with its box in a space of its own.
struct Node<'a> {
    min: DVec3,
    max: DVec3,
    place: WorldFromModel,
    triangles: &'a [u32],
    children: usize,
}

/// The corners of all triangles: in model space, or in world space for a skinned mesh.
pub fn corners(pose: &mut Pose) -> Vec<[DVec3; 3]> {
    let (count, place) = (pose.bvh().model().triangle_count() as u32, WorldFromModel::IDENTITY);
    let mut body = Body::new(pose, &place);
    (0..count).filter_map(|triangle| body.triangle(triangle)).collect()
}

/// The costs of our tree. `corners` are those of the same pose.
pub fn of_pose(pose: &mut Pose, corners: &[[DVec3; 3]]) -> Tightness {
    // In preorder, the children of a node are the nodes one deeper before the next node that is not.
    let mut depths = Vec::new();
    pose.visit_nodes(|node| {
        depths.push(node.depth);
        true
    });
    let mut children = vec![0; depths.len()];
    let mut path: Vec<usize> = Vec::new();
    for (index, &depth) in depths.iter().enumerate() {
        path.truncate(depth);
        if let Some(&parent) = path.last() {
            children[parent] += 1;
        }
        path.push(index);
    }
    let (mut sum, mut counts) = (Tightness::default(), children.iter());
    pose.visit_nodes(|node| {
        let node = Node {
            min: node.bounds.min.as_dvec3(),
            max: node.bounds.max.as_dvec3(),
            place: node.world_from_bounds.unwrap_or_default(),
            triangles: node.triangles,
            children: counts.next().copied().unwrap_or(0),
        };
        sum.add_node(&node, corners);
        true
    });
    sum
}

/// The costs of a rival's tree, whose nodes `visit` passes on. `corners` are those of the same pose.
pub fn of_nodes(corners: &[[DVec3; 3]], visit: impl FnOnce(&mut dyn FnMut(RivalNode<'_>))) -> Tightness {
    let mut sum = Tightness::default();
    visit(&mut |node| {
        let node = Node {
            min: node.bounds.min.as_dvec3(),
            max: node.bounds.max.as_dvec3(),
            place: WorldFromModel::IDENTITY,
            triangles: node.triangles,
            children: node.children,
        };
        sum.add_node(&node, corners);
    });
    sum
}

#[cfg(test)]
mod tests {
    use std::error::Error;
    use std::sync::Arc;

    use morph_collision::{BuildOptions, MorphBvh};

    use super::*;
    use morph_collision_models::generated::random::random_blob;

    #[test]
    fn fitted_boxes_are_tight_and_blended_ones_are_not() -> Result<(), Box<dyn Error>> {
        let mesh = random_blob(7, 3, 8, 0.5);
        let bvh = MorphBvh::build(Arc::new(mesh.to_model()?), &BuildOptions::default());
        let weights: Vec<f32> = (0..8).map(|k| 0.4 * (k as f32 - 3.0)).collect();
        let mut pose = Pose::new(Arc::new(bvh));
        pose.set_weights(&weights)?;
        let corners = corners(&mut pose);
        let blended = of_pose(&mut pose, &corners);
        assert!(blended.ratio() > 1.02, "{blended:?}");
        assert!(blended.ratio_with_tight_leaves() < blended.ratio(), "{blended:?}");
        pose.refit();
        let fitted = of_pose(&mut pose, &corners);
        assert!((fitted.ratio() - 1.0).abs() < 1e-4, "{fitted:?}");
        assert!((fitted.smallest / blended.smallest - 1.0).abs() < 1e-9);
        let mut twice = blended;
        twice.add(&blended);
        assert!((twice.ratio() - blended.ratio()).abs() < 1e-9);
        Ok(())
    }
}
