//! The shapes on which triangles are put together, and the split of a node's triangles among its children.

use glam::Vec3;

use super::{BuildOptions, PartitionShape, Split, midpoint, sah};
use crate::bounds::{Aabb, LANES};
use crate::model::MorphModel;

/// More targets than this add little to [`Split::PoseSah`] but time.
const MOST_POSES: usize = 16;

/// Midpoints and boxes of all triangles on one shape.
pub(super) struct Shape {
    pub(super) midpoints: Vec<Vec3>,
    pub(super) bounds: Vec<Aabb>,
}

impl Shape {
    fn new(model: &MorphModel, position: impl Fn(u32) -> Vec3) -> Self {
        let positions: Vec<Vec3> = (0..model.vertex_count() as u32).map(position).collect();
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

    fn posed(model: &MorphModel, weights: &[f32]) -> Self {
        Self::new(model, |vertex| model.blend_vertex(vertex, weights))
    }

    fn with_target(model: &MorphModel, target: usize) -> Self {
        let mut weights = vec![0.0; model.target_count()];
        weights[target] = 1.0;
        Self::posed(model, &weights)
    }

    fn chosen(model: &MorphModel, shape: &PartitionShape) -> Self {
        let targets = model.target_count();
        match shape {
            PartitionShape::Base => Self::posed(model, &vec![0.0; targets]),
            PartitionShape::Target(target) => Self::with_target(model, *target),
            PartitionShape::Average => Self::posed(model, &vec![1.0 / (targets + 1) as f32; targets]),
            PartitionShape::Weights(weights) => Self::posed(model, weights),
        }
    }
}

/// Splits nodes on the shapes it was made for.
pub(super) struct Partition {
    split: Split,
    arity: usize,
    leaf_size: usize,
    shape: Shape,
    /// What [`Split::PoseSah`] looks at beside `shape`.
    others: Vec<Shape>,
}

impl Partition {
    pub(super) fn new(model: &MorphModel, options: &BuildOptions) -> Self {
        let others = if options.split == Split::PoseSah {
            let mut targets: Vec<usize> = (0..model.target_count()).collect();
            targets.sort_by(|&i, &j| model.target_reach()[j].total_cmp(&model.target_reach()[i]));
            targets.truncate(MOST_POSES);
            targets
                .into_iter()
                .map(|target| Shape::with_target(model, target))
                .collect()
        } else {
            Vec::new()
        };
        Self {
            split: options.split,
            arity: options.arity,
            leaf_size: options.leaf_size,
            shape: Shape::chosen(model, &options.shape),
            others,
        }
    }

    /// Reorders a node's triangles child by child and returns the children's lengths: 2 to `arity` of them, none zero.
    ///
    /// `triangles` has at least two entries. Every split makes progress: where triangles cannot be told apart they are
    /// split by count.
    pub(super) fn split(&self, triangles: &mut [u32]) -> Vec<usize> {
        let counts = match self.split {
            Split::Midpoint => midpoint::split(&self.shape, self.arity, triangles),
            Split::Sah | Split::PoseSah => {
                let rule = sah::Rule {
                    shape: &self.shape,
                    others: &self.others,
                    leaf_size: self.leaf_size,
                };
                sah::split(&rule, self.arity, triangles)
            }
        };
        if counts.len() > 1 {
            return counts;
        }
        let chunk = triangles.len().div_ceil(self.arity.min(LANES));
        triangles.chunks(chunk).map(<[u32]>::len).collect()
    }
}
