//! The shapes on which triangles are put together, and the split of a node's triangles among its children.

use glam::Vec3;

use super::{build, sah};
use crate::bounds::Aabb;
use crate::model::MorphModel;

/// Targets that the split looks at beside the base: more of them take time and improve little (docs/tried.md).
const MOST_TARGETS: usize = 16;

/// Midpoints and boxes of all triangles on one shape.
pub(super) struct Shape {
    pub(super) midpoints: Vec<Vec3>,
    pub(super) bounds: Vec<Aabb>,
}

impl Shape {
    fn posed(model: &MorphModel, weights: &[f32]) -> Self {
        let vertices = 0..model.vertex_count() as u32;
        let positions: Vec<Vec3> = vertices.map(|vertex| model.blend_vertex(vertex, weights)).collect();
        let (midpoints, bounds) = (0..model.triangle_count())
            .map(|triangle| {
                let corners = model.triangle(triangle).map(|vertex| positions[vertex as usize]);
                let third = 1.0 / 3.0;
                let midpoint = corners[0] * third + corners[1] * third + corners[2] * third;
                (midpoint, Aabb::from_points(corners))
            })
            .unzip();
        Self { midpoints, bounds }
    }

    fn with_target(model: &MorphModel, target: usize) -> Self {
        let mut weights = vec![0.0; model.target_count()];
        weights[target] = 1.0;
        Self::posed(model, &weights)
    }
}

/// Splits nodes by the surface-area heuristic, summed over the base and the targets that move it most: one tree good for all.
pub(super) struct Partition {
    leaf_size: usize,
    base: Shape,
    targets: Vec<Shape>,
}

impl Partition {
    pub(super) fn new(model: &MorphModel, leaf_size: usize) -> Self {
        let mut targets: Vec<usize> = (0..model.target_count()).collect();
        targets.sort_by(|&i, &j| model.target_reach()[j].total_cmp(&model.target_reach()[i]));
        targets.truncate(MOST_TARGETS);
        Self {
            leaf_size,
            base: Shape::posed(model, &vec![0.0; model.target_count()]),
            targets: targets
                .into_iter()
                .map(|target| Shape::with_target(model, target))
                .collect(),
        }
    }

    /// Reorders a node's triangles child by child and returns the children's lengths: 2 to 8 of them, none zero.
    ///
    /// `triangles` has at least two entries. Every split makes progress: where triangles cannot be told apart they are
    /// split by count.
    pub(super) fn split(&self, triangles: &mut [u32]) -> Vec<usize> {
        let rule = sah::Rule {
            shape: &self.base,
            others: &self.targets,
            leaf_size: self.leaf_size,
        };
        let counts = sah::split(&rule, triangles);
        if counts.len() > 1 {
            counts
        } else {
            build::by_count(triangles)
        }
    }
}
