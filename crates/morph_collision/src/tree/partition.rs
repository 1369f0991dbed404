//! The shapes on which the split of a node's triangles is decided.

use glam::Vec3;

use crate::bounds::Aabb;
use crate::model::MorphModel;

/// The most targets that a split considers beside the base. Build time grows with it. Not measured; splitting on the base alone
/// makes trees that are 0.91 to 1.08 times as slow (docs/tried.md), so more targets can gain little.
const MAX_TARGETS: usize = 16;

/// The midpoints and boxes of all triangles of one shape.
#[derive(Clone)]
pub(super) struct Shape {
    pub(super) midpoints: Vec<Vec3>,
    pub(super) bounds: Vec<Aabb>,
}

impl Shape {
    fn new(model: &MorphModel, weights: &[f32]) -> Self {
        let vertices = 0..model.vertex_count() as u32;
        let positions: Vec<Vec3> = vertices.map(|vertex| model.blend_vertex(vertex, weights)).collect();
        let (midpoints, bounds) = (0..model.triangle_count() as u32)
            .map(|triangle| {
                let corners = model.corners(triangle).map(|vertex| positions[vertex as usize]);
                let third = 1.0 / 3.0;
                let midpoint = corners[0] * third + corners[1] * third + corners[2] * third;
                (midpoint, Aabb::from_points(corners))
            })
            .unzip();
        Self { midpoints, bounds }
    }
}

/// Splits nodes by the surface-area heuristic, summed over the base and the targets with the largest displacements, so that
/// one tree is good for all shapes. The methods are in `sah`.
pub(super) struct Partition {
    pub(super) leaf_size: usize,
    /// The base comes first.
    pub(super) shapes: Vec<Shape>,
}

impl Partition {
    pub(super) fn new(model: &MorphModel, leaf_size: usize) -> Self {
        let mut targets: Vec<usize> = (0..model.target_count()).collect();
        targets.sort_by(|&i, &j| model.target_reach()[j].total_cmp(&model.target_reach()[i]));
        targets.truncate(MAX_TARGETS);
        let mut weights = vec![0.0; model.target_count()];
        let mut shapes = vec![Shape::new(model, &weights)];
        for target in targets {
            weights[target] = 1.0;
            shapes.push(Shape::new(model, &weights));
            weights[target] = 0.0;
        }
        Self { leaf_size, shapes }
    }
}
