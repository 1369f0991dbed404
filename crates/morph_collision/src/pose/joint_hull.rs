//! A box around a skinned body in the world or in another space, from one box per joint. A broad phase needs it before any node is
//! blended.

use std::ops::RangeInclusive;

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::DVec3;

use super::outer_boxes::EntitySpace;
use super::part_boxes::{PartBoxes, Parts};
use super::skin_tree::SkinTree;
use crate::bounds::{Aabb, CenteredLanes, Extent, MapFrame, with_simd};
use crate::joints::JointMatrices;
use crate::model::Skin;

/// One box per joint around the vertices that it moves, blended for a pose's weights, before joints move them.
#[derive(Clone, Debug, Default)]
pub(super) struct JointHull {
    boxes: PartBoxes,
    /// The box in world space, once it is known.
    world: Option<Aabb>,
}

impl JointHull {
    /// Discards the box in world space, because joints or weights have changed.
    pub(super) fn invalidate(&mut self) {
        self.world = None;
    }

    pub(super) fn bytes(&self) -> usize {
        self.boxes.bytes()
    }

    /// A box in world space that contains every vertex, exact or rounded.
    ///
    /// A vertex is the sum of its weights times a point in the hull of its joints' images. `error` is a bound on the rounding errors of
    /// vertices, which is larger than those of the hull.
    ///
    /// It is kept until joints or weights change, because a physics step asks for it several times.
    pub(super) fn around(&mut self, tree: SkinTree<'_>, joints: &JointMatrices, error: f64) -> Aabb {
        if let Some(known) = self.world {
            return known;
        }
        let bounds = self.compute(tree, joints, error);
        self.world = Some(bounds);
        bounds
    }

    fn compute(&mut self, tree: SkinTree<'_>, joints: &JointMatrices, error: f64) -> Aabb {
        let Some(parts) = self.parts(tree) else {
            return Aabb::UNBOUNDED;
        };
        let boxes = tree.skin.joints.joints().zip(parts.iter());
        let hull = with_simd!(tree.level, simd => images(simd, boxes, joints, None));
        pulled(hull, DVec3::ZERO, sums(tree), DVec3::splat(2.0 * error))
    }

    /// Like [`JointHull::around`], in the model space of an entity. The box contains the exact preimage of every vertex. It is infinite if
    /// the space cannot be inverted.
    pub(super) fn around_in(
        &mut self,
        tree: SkinTree<'_>,
        joints: &JointMatrices,
        EntitySpace { place, frame, error }: &EntitySpace<'_>,
    ) -> Aabb {
        let Some(parts) = self.parts(tree) else {
            return Aabb::UNBOUNDED;
        };
        let sums = sums(tree);
        let reach = joints.world_reach(parts.reach) + place.translation().abs().max_element();
        let Some(rounding) = place.model_error(reach * sums.end().max(1.0), *error) else {
            return Aabb::UNBOUNDED;
        };
        let boxes = tree.skin.joints.joints().zip(parts.iter());
        let hull = with_simd!(tree.level, simd => images(simd, boxes, joints, Some(frame)));
        pulled(hull, place.model_origin(), sums, rounding)
    }

    /// The boxes; `None` if coordinates are too large to compute with.
    pub(super) fn parts<'a>(&'a mut self, tree: SkinTree<'a>) -> Option<Parts<'a>> {
        let of_tree = &tree.skin.joints;
        self.boxes
            .blend(tree.level, &of_tree.boxes, &of_tree.blocks, tree.weights);
        self.boxes.parts(&of_tree.boxes, &of_tree.blocks)
    }
}

/// A range that contains the sum of every vertex's weights.
fn sums(tree: SkinTree<'_>) -> RangeInclusive<f64> {
    tree.model.skin().map_or(1.0..=1.0, Skin::sums)
}

/// The hull of vertices that joints take into `hull` and whose weights sum to numbers in `sums`, widened on all sides. The missing weight
/// pulls a vertex towards the origin of the world, or pushes it away from it.
fn pulled(hull: Extent, origin: DVec3, sums: RangeInclusive<f64>, by: DVec3) -> Aabb {
    let (least, most) = sums.into_inner();
    let (mut min, mut max) = (hull.min - origin, hull.max - origin);
    if least <= 0.0 {
        // There may be vertices without influences; they are at the origin.
        (min, max) = (min.min(DVec3::ZERO), max.max(DVec3::ZERO));
    }
    let scaled = Extent {
        min: origin + (min * least).min(min * most) - by,
        max: origin + (max * least).max(max * most) + by,
    };
    scaled.outward()
}

/// The hull of the images of boxes, each under its joint, in world space or in another frame. The boxes come with their joints, eight at a
/// time.
#[inline(always)]
fn images<'b, S: Simd>(
    simd: S,
    blocks: impl Iterator<Item = (&'b [u16], &'b CenteredLanes)>,
    joints: &JointMatrices,
    frame: Option<&MapFrame>,
) -> Extent {
    let mut min = f64x4::splat(simd, f64::INFINITY);
    let mut max = f64x4::splat(simd, f64::NEG_INFINITY);
    for (moved, boxes) in blocks {
        for (lane, &joint) in moved.iter().enumerate() {
            let columns = match frame {
                Some(frame) => frame.joint(simd, joints.padded(joint)),
                None => joints.loaded(simd, joint),
            };
            let [center, radius] = boxes.image(simd, lane, columns);
            min = min.min(center - radius);
            max = max.max(center + radius);
        }
    }
    let (mut low, mut high) = ([0.0; 4], [0.0; 4]);
    min.store_slice(&mut low);
    max.store_slice(&mut high);
    Extent {
        min: DVec3::new(low[0], low[1], low[2]),
        max: DVec3::new(high[0], high[1], high[2]),
    }
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
