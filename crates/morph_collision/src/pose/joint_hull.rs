//! A box in world space around a skinned body, from one box per joint. A broad phase needs it before any node is blended.

use std::ops::RangeInclusive;

use fearless_simd::prelude::*;
use fearless_simd::{Level, f64x4};
use glam::DVec3;

use super::blend::blend_group;
use super::skin_blend::MAX_REACH;
use crate::bounds::{Aabb, BoxLanes, Extent, with_simd};
use crate::joints::{Columns, JointMatrices};
use crate::model::Weights;
use crate::tree::JointBoxes;

/// One box per joint around the vertices that it moves, blended for a pose's weights, before joints move them.
#[derive(Clone, Debug, Default)]
pub(super) struct JointHull {
    boxes: Vec<BoxLanes>,
    /// A bound on the boxes' absolute coordinates.
    reach: f32,
    /// Whether the boxes are valid for the current weights.
    is_current: bool,
}

impl JointHull {
    /// Discards the boxes, because the weights have changed.
    pub(super) fn forget(&mut self) {
        self.is_current = false;
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.boxes)
    }

    /// A box that contains every vertex, exact or rounded.
    ///
    /// A vertex is the sum of its weights, which is in `sums`, times a point in the hull of its joints' images. `error` bounds the
    /// rounding error of vertices; it is larger than the rounding errors here.
    pub(super) fn around(
        &mut self,
        level: Level,
        tables: &JointBoxes,
        weights: &Weights,
        joints: &JointMatrices,
        (sums, error): (RangeInclusive<f64>, f64),
    ) -> Aabb {
        if !self.is_bounded(level, tables, weights) {
            return Aabb::UNBOUNDED;
        }
        let mut hull = Extent::EMPTY;
        for ((moved, _), boxes) in tables.blocks().zip(&self.boxes) {
            let of_block = with_simd!(level, simd => images(simd, moved, boxes, joints));
            hull = hull.union(of_block);
        }
        let (least, most) = sums.into_inner();
        if least <= 0.0 {
            // There may be vertices without influences; they are at the origin.
            hull = hull.union(Extent::point(DVec3::ZERO));
        }
        let pad = DVec3::splat(2.0 * error);
        let scaled = Extent {
            min: (hull.min * least).min(hull.min * most) - pad,
            max: (hull.max * least).max(hull.max * most) + pad,
        };
        scaled.outward()
    }

    /// The boxes; `None` if coordinates are too large to compute with.
    pub(super) fn boxes(&mut self, level: Level, tables: &JointBoxes, weights: &Weights) -> Option<&[BoxLanes]> {
        self.is_bounded(level, tables, weights).then_some(&self.boxes)
    }

    /// Blends the boxes unless they are valid for the weights. Returns whether their coordinates are small enough to compute with.
    fn is_bounded(&mut self, level: Level, tables: &JointBoxes, weights: &Weights) -> bool {
        if !self.is_current {
            self.boxes.clear();
            self.reach = 0.0;
            for (_, tables) in tables.blocks() {
                let mut boxes = BoxLanes::default();
                let reach = with_simd!(level, simd => blend_group(simd, tables, weights, &mut boxes));
                self.reach = self.reach.max(reach);
                self.boxes.push(boxes);
            }
            self.is_current = true;
        }
        // False for NaN.
        self.reach <= MAX_REACH
    }
}

/// The hull of the images of up to eight boxes, each under its joint.
#[inline(always)]
fn images<S: Simd>(simd: S, moved: &[u16], boxes: &BoxLanes, joints: &JointMatrices) -> Extent {
    let mut min = f64x4::splat(simd, f64::INFINITY);
    let mut max = f64x4::splat(simd, f64::NEG_INFINITY);
    for (lane, &joint) in moved.iter().enumerate() {
        let (center, radius) = image(simd, &boxes.get(lane), joints.padded(joint));
        min = min.min(center - radius);
        max = max.max(center + radius);
    }
    let (mut low, mut high) = ([0.0; 4], [0.0; 4]);
    min.store_slice(&mut low);
    max.store_slice(&mut high);
    Extent {
        min: DVec3::new(low[0], low[1], low[2]),
        max: DVec3::new(high[0], high[1], high[2]),
    }
}

/// The centre and half size of a box's image.
#[inline(always)]
fn image<S: Simd>(simd: S, of: &Aabb, [x, y, z, translation]: &Columns) -> (f64x4<S>, f64x4<S>) {
    let (min, max) = (of.min.as_dvec3(), of.max.as_dvec3());
    let (center, half) = ((min + max) * 0.5, (max - min) * 0.5);
    let mut middle = f64x4::from_slice(simd, translation);
    let mut radius = f64x4::splat(simd, 0.0);
    for (column, along, extent) in [(x, center.x, half.x), (y, center.y, half.y), (z, center.z, half.z)] {
        let column = f64x4::from_slice(simd, column);
        middle += column * f64x4::splat(simd, along);
        radius += column.abs() * f64x4::splat(simd, extent);
    }
    (middle, radius)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Affine3A, DVec3, Vec3};

    use crate::{Body, BuildOptions, Influences, JointMatrices, MorphBvh, MorphModel, Pose, WorldFromModel};

    /// The bounds and corners of one triangle, moved by one joint with these weights to a place far away.
    fn bounds(weights: [f32; 3], at: Vec3) -> (crate::Aabb, Vec<Vec3>) {
        let weights = weights.map(|weight| [weight, 0.0, 0.0, 0.0]);
        let influences = Influences {
            joints: &[[0; 4]; 3],
            weights: &weights,
        };
        let no_targets: [Vec<Vec3>; 0] = [];
        let model = MorphModel::skinned(&Vec3::AXES, &[[0, 1, 2]], &no_targets, 1, &[influences]).unwrap();
        let bvh = MorphBvh::build(Arc::new(model), &BuildOptions::default());
        let mut pose = Pose::new(Arc::new(bvh));
        let joints = JointMatrices::new(&[Affine3A::from_translation(at)]).unwrap();
        pose.set_joints(&joints).unwrap();
        let place = WorldFromModel::IDENTITY;
        let bounds = pose.broad_phase_bounds(&place);
        let corners = Body::new(&mut pose, &place).triangle(0).unwrap();
        (bounds, corners.map(DVec3::as_vec3).to_vec())
    }

    #[test]
    fn vertices_are_inside_whatever_their_weights_sum_to() {
        let at = Vec3::new(100.0, -50.0, 7.0);
        for weights in [
            [1.0; 3],
            [0.5, 0.6, 0.7],
            [1.5, 1.0, 1.2],
            [0.0, 1.0, 1.0],
            [0.0, 0.3, 1.8],
        ] {
            let (bounds, corners) = bounds(weights, at);
            assert!(
                bounds.min.is_finite() && bounds.max.is_finite(),
                "{weights:?}: {bounds:?}"
            );
            for corner in corners {
                assert!(bounds.contains(corner), "{weights:?}: {corner} outside {bounds:?}");
            }
        }
    }

    #[test]
    fn they_are_tight_where_weights_sum_to_one_and_infinite_beyond_f32() {
        let (tight, corners) = bounds([1.0; 3], Vec3::new(100.0, -50.0, 7.0));
        let smallest = crate::Aabb::from_points(corners);
        assert!((tight.min - smallest.min).abs().max_element() < 1e-4, "{tight:?}");
        assert!((tight.max - smallest.max).abs().max_element() < 1e-4, "{tight:?}");
        let (endless, _) = bounds([1000.0; 3], Vec3::X * 1e34);
        assert!(endless.max.x >= 1e37, "{endless:?}");
        let (endless, _) = bounds([1000.0; 3], Vec3::X * 9e33);
        assert!(endless.max.x.is_finite() && endless.max.x >= 9e36, "{endless:?}");
    }
}
