//! A box around a skinned body in the world or in another space, from one box per joint. A broad phase needs it before any node is
//! blended.
//!
//! Weights that move vertices little, as those of a face on a body do, blend nothing for it: it is made from the boxes at rest, widened by
//! what the weights can do at most. Only the weights decide that.

use std::ops::RangeInclusive;

use fearless_simd::prelude::*;
use fearless_simd::{Level, f64x4};
use glam::DVec3;

use super::part_boxes::{PartBoxes, Parts};
use super::skin_tree::SkinTree;
use crate::bounds::{Aabb, CenteredLanes, Extent, MapFrame, WorldFromModel, with_simd};
use crate::joints::JointMatrices;
use crate::model::{MorphModel, Skin};
use crate::tree::{JointBoxes, MorphBvh};

/// One box per joint around the vertices that it moves, before joints move them: blended for a pose's weights, if those at rest will not do.
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

    /// A box in world space that contains every vertex. `error` is a bound on the rounding errors of vertices.
    ///
    /// It is kept until joints or weights change, because a physics step asks for it several times.
    pub(super) fn around(&mut self, tree: SkinTree<'_>, joints: &JointMatrices, reach: &Reach, error: f64) -> Aabb {
        if let Some(known) = self.world {
            return known;
        }
        let hull = self.hull(tree, reach, error);
        let bounds = hull.map_or(Aabb::UNBOUNDED, |hull| hull.in_world(tree.level, joints));
        self.world = Some(bounds);
        bounds
    }

    /// Like [`JointHull::around`], in the model space of an entity.
    pub(super) fn around_in(
        &mut self,
        tree: SkinTree<'_>,
        joints: &JointMatrices,
        reach: &Reach,
        error: f64,
        place: &WorldFromModel,
    ) -> Aabb {
        let hull = self.hull(tree, reach, error);
        hull.map_or(Aabb::UNBOUNDED, |hull| hull.in_entity(tree.level, joints, place))
    }

    /// From boxes at rest if they will do, or else from blended ones; `None` if coordinates are too large to compute with.
    fn hull<'a>(&'a mut self, tree: SkinTree<'a>, reach: &Reach, error: f64) -> Option<Hull<'a>> {
        let joints = &tree.skin.joints;
        let boxes = match HullBoxes::at_rest(joints, reach) {
            Some(boxes) => boxes,
            None => {
                let parts = self.parts(tree)?;
                HullBoxes {
                    joints,
                    still: parts.still,
                    moved: parts.moved,
                    widening: 0.0,
                }
            }
        };
        Some(Hull {
            boxes,
            sums: tree.model.skin().map_or(1.0..=1.0, Skin::sums),
            reach: reach.of_vertices,
            error,
        })
    }

    /// The boxes; `None` if coordinates are too large to compute with.
    pub(super) fn parts<'a>(&'a mut self, tree: SkinTree<'a>) -> Option<Parts<'a>> {
        let of_tree = &tree.skin.joints;
        self.boxes
            .blend(tree.level, &of_tree.boxes, &of_tree.blocks, tree.weights);
        self.boxes.parts(&of_tree.boxes, &of_tree.blocks)
    }
}

/// How far weights can move vertices, before joints do.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reach {
    /// A bound on the absolute coordinates of all vertices.
    pub(super) of_vertices: f64,
    /// A bound on how far the weights move any vertex along an axis.
    pub(super) of_weights: f64,
}

impl Reach {
    pub(super) fn new(model: &MorphModel, weights: &[f32]) -> Self {
        let (mut of_targets, mut active) = (0.0, 0_u32);
        for (weight, reach) in weights.iter().zip(model.target_reach()) {
            of_targets += f64::from(weight.abs()) * f64::from(*reach);
            active += u32::from(*weight != 0.0);
        }
        let largest = f64::from(model.base_reach()) + of_targets;
        // A vertex is blended in `f32`: for each target, a product and a sum of numbers up to this one, or subnormal ones.
        let roundings = f64::from(2 * active + 8) * (f64::from(f32::EPSILON) * largest + f64::from(f32::MIN_POSITIVE));
        Self {
            // The factor covers the rounding of blends.
            of_vertices: largest * (1.0 + 1.5e-2),
            of_weights: if active == 0 {
                0.0
            } else {
                (1.0 + 1e-9) * of_targets + roundings
            },
        }
    }
}

/// One box per joint, which joints are about to move.
struct HullBoxes<'a> {
    joints: &'a JointBoxes,
    /// Those that no target moves.
    still: &'a [CenteredLanes],
    moved: &'a [CenteredLanes],
    /// How much larger those are that targets move.
    widening: f64,
}

impl<'a> HullBoxes<'a> {
    /// `None` if weights may move vertices far.
    fn at_rest(joints: &'a JointBoxes, reach: &Reach) -> Option<Self> {
        let [still, moved] = joints.at_rest();
        // False for NaN.
        (reach.of_weights <= joints.most_widening).then_some(Self {
            joints,
            still,
            moved,
            widening: reach.of_weights,
        })
    }

    /// The hull of the images of the boxes, each under its joint, in world space or in another frame.
    #[inline(always)]
    fn images<S: Simd>(&self, simd: S, joints: &JointMatrices, frame: Option<&MapFrame>) -> Extent {
        let mut min = f64x4::splat(simd, f64::INFINITY);
        let mut max = f64x4::splat(simd, f64::NEG_INFINITY);
        let blocks = self.still.iter().map(|boxes| (boxes, 0.0));
        let blocks = blocks.chain(self.moved.iter().map(|boxes| (boxes, self.widening)));
        for (joints_of, (boxes, widening)) in self.joints.joints().zip(blocks) {
            for (lane, &joint) in joints_of.iter().enumerate() {
                let columns = match frame {
                    Some(frame) => frame.joint(simd, joints.padded(joint)),
                    None => joints.loaded(simd, joint),
                };
                let [center, radius] = boxes.image(simd, lane, columns, widening);
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
}

/// What bounds a body. A vertex is the sum of its weights times a point in the hull of its joints' images.
struct Hull<'a> {
    boxes: HullBoxes<'a>,
    /// A range that contains the sum of every vertex's weights.
    sums: RangeInclusive<f64>,
    /// As [`Reach::of_vertices`].
    reach: f64,
    /// A bound on the rounding errors of vertices, which is larger than those of the hull.
    error: f64,
}

impl Hull<'_> {
    /// A box in world space that contains every vertex, exact or rounded.
    fn in_world(self, level: Level, joints: &JointMatrices) -> Aabb {
        let images = with_simd!(level, simd => self.boxes.images(simd, joints, None));
        pulled(images, DVec3::ZERO, self.sums, DVec3::splat(2.0 * self.error))
    }

    /// A box in the model space of an entity that contains the exact preimage of every vertex, exact or rounded. It is infinite if the space
    /// cannot be inverted.
    fn in_entity(self, level: Level, joints: &JointMatrices, place: &WorldFromModel) -> Aabb {
        let far = joints.world_reach(self.reach) + place.translation().abs().max_element();
        let Some(rounding) = place.model_error(far * self.sums.end().max(1.0), self.error) else {
            return Aabb::UNBOUNDED;
        };
        let frame = MapFrame::new(place);
        let images = with_simd!(level, simd => self.boxes.images(simd, joints, Some(&frame)));
        pulled(images, place.model_origin(), self.sums, rounding)
    }
}

impl MorphBvh {
    /// A box in world space around a skinned mesh with these weights and joints: that of
    /// [`Pose::broad_phase_bounds`](crate::Pose::broad_phase_bounds) unless the pose is refitted. No pose has to be set for it.
    ///
    /// `None` if weights or joints do not fit, if the mesh is not skinned, or if the weights may move vertices far. Then, a pose has to blend
    /// boxes.
    ///
    /// Cost: linear in the numbers of joints and targets.
    #[must_use]
    pub fn broad_phase_bounds(&self, weights: &[f32], joints: &JointMatrices) -> Option<Aabb> {
        let at_rest = self.at_rest(weights, joints)?;
        Some(at_rest.in_world(self.kernel().level, joints))
    }

    /// A box in the model space of an entity at `world_from_model` around a skinned mesh with these weights and joints: that of
    /// [`Pose::local_bounds`](crate::Pose::local_bounds). No pose has to be set for it.
    ///
    /// `None` and cost: as [`MorphBvh::broad_phase_bounds`].
    #[must_use]
    pub fn local_bounds(
        &self,
        weights: &[f32],
        joints: &JointMatrices,
        world_from_model: &WorldFromModel,
    ) -> Option<Aabb> {
        let at_rest = self.at_rest(weights, joints)?;
        Some(at_rest.in_entity(self.kernel().level, joints, world_from_model))
    }

    fn at_rest(&self, weights: &[f32], joints: &JointMatrices) -> Option<Hull<'_>> {
        let (model, tables) = (self.model(), self.skin.as_ref()?);
        let skin = model.skin()?;
        if model.joint_count() != Some(joints.len()) || model.check_weights(weights).is_err() {
            return None;
        }
        let reach = Reach::new(model, weights);
        Some(Hull {
            boxes: HullBoxes::at_rest(&tables.joints, &reach)?,
            sums: skin.sums(),
            reach: reach.of_vertices,
            error: placement_error(skin, joints, reach.of_vertices),
        })
    }
}

/// A bound on the rounding error of world positions: a product and a sum per influence for the matrix, and three of each for the position.
pub(super) fn placement_error(skin: &Skin, joints: &JointMatrices, reach: f64) -> f64 {
    4.0 * skin.most_influences() as f64 * f64::EPSILON * skin.max_sum() * joints.world_reach(reach)
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

    /// A strip of triangles along x, 100 long, under two joints. One target lifts a third of its vertices by 1.
    fn strip() -> Pose {
        let base: Vec<Vec3> = (0..101_u8)
            .map(|i| Vec3::new(f32::from(i), f32::from(i % 2), 0.0))
            .collect();
        let triangles: Vec<[u32; 3]> = (0..99).map(|i| [i, i + 1, i + 2]).collect();
        let lift = |i| if i < 33 { Vec3::Z } else { Vec3::ZERO };
        let target: Vec<Vec3> = (0..101).map(lift).collect();
        let weights: Vec<[f32; 4]> = (0..101_u8)
            .map(|i| [1.0 - f32::from(i) / 100.0, f32::from(i) / 100.0, 0.0, 0.0])
            .collect();
        let influences = Influences {
            joints: &[[0, 1, 0, 0]; 101],
            weights: &weights,
        };
        let model = MorphModel::skinned(&base, &triangles, &[target], 2, &[influences]).unwrap();
        Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())))
    }

    #[test]
    fn the_box_without_a_pose_is_that_of_the_pose_and_holds_every_vertex() {
        let mut pose = strip();
        let bvh = pose.bvh().clone();
        let turned = Affine3A::from_rotation_translation(glam::Quat::from_rotation_x(0.7), Vec3::new(4.0, -1.0, 2.0));
        let (turned, place) = (WorldFromModel::new(turned).unwrap(), WorldFromModel::IDENTITY);
        let (mut kept, mut blended) = (0, 0);
        for step in 0..400_u16 {
            let turn = f32::from(step) * 0.1;
            let weight = 0.05 * (f32::from(step) - 200.0);
            let joints = [
                Affine3A::from_rotation_y(turn),
                Affine3A::from_scale_rotation_translation(
                    Vec3::new(1.0, -2.0, 0.5),
                    glam::Quat::from_rotation_z(2.0 * turn),
                    Vec3::new(3.0, turn, -5.0),
                ),
            ];
            let joints = JointMatrices::new(&joints).unwrap();
            pose.set_joints(&joints).unwrap();
            pose.set_weights(&[weight]).unwrap();
            let (bounds, local) = (pose.broad_phase_bounds(&place), pose.local_bounds(&turned));
            let without = bvh.broad_phase_bounds(&[weight], &joints);
            let local_without = bvh.local_bounds(&[weight], &joints, &turned);
            assert_eq!(without.is_some(), local_without.is_some());
            match without.zip(local_without) {
                Some(known) => {
                    kept += 1;
                    assert_eq!(known, (bounds, local), "weight {weight}");
                }
                None => blended += 1,
            }
            for vertex in 0..101 {
                let vertex = pose.source_vertex(vertex).unwrap();
                assert!(bounds.contains(vertex), "weight {weight}: {vertex} outside {bounds:?}");
            }
        }
        assert!(kept > 200 && blended > 100, "{kept} at rest, {blended} blended");
    }

    #[test]
    fn a_vertex_that_is_rounded_outward_is_inside() {
        let base = [Vec3::X, Vec3::NEG_X, Vec3::Y];
        let influences = Influences {
            joints: &[[0; 4]; 3],
            weights: &[[1.0, 0.0, 0.0, 0.0]; 3],
        };
        for by in [0.07, 0.01, 0.03] {
            let target = [Vec3::X * by, Vec3::ZERO, Vec3::ZERO];
            let model = MorphModel::skinned(&base, &[[0, 1, 2]], &[target], 1, &[influences]).unwrap();
            let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
            pose.set_weights(&[1.0]).unwrap();
            let joints = JointMatrices::new(&[Affine3A::from_translation(Vec3::NEG_X)]).unwrap();
            pose.set_joints(&joints).unwrap();
            let bounds = pose.broad_phase_bounds(&WorldFromModel::IDENTITY);
            assert_eq!(pose.bvh().broad_phase_bounds(&[1.0], &joints), Some(bounds));
            let vertex = pose.source_vertex(0).unwrap();
            assert!(bounds.contains(vertex), "{vertex} outside {bounds:?}");
        }
    }

    #[test]
    fn without_a_pose_only_what_fits_has_a_box() {
        let pose = strip();
        let (bvh, joints) = (pose.bvh(), JointMatrices::new(&[Affine3A::IDENTITY; 2]).unwrap());
        assert!(bvh.broad_phase_bounds(&[1.0], &joints).is_some());
        for weights in [&[][..], &[1.0, 1.0], &[f32::NAN], &[f32::INFINITY], &[7.0]] {
            assert_eq!(bvh.broad_phase_bounds(weights, &joints), None, "{weights:?}");
            assert_eq!(
                bvh.local_bounds(weights, &joints, &WorldFromModel::IDENTITY),
                None,
                "{weights:?}"
            );
        }
        let one = JointMatrices::new(&[Affine3A::IDENTITY]).unwrap();
        assert_eq!(bvh.broad_phase_bounds(&[1.0], &one), None);
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
