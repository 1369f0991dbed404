//! The state of a skinned mesh's pose: its joints, and what has been computed for them.
//!
//! | what | is made when a query first needs it | is valid until |
//! |---|---|---|
//! | [`PosedVertices`] | one of eight vertices, or any box of their chunk | joints or weights change |
//! | [`OuterBoxes`]: boxes of joints' parts | a node above the chunks | weights change |
//! | [`JointHull`]: boxes of joints | the bounds of the whole body, unless those at rest will do | weights change |

use fearless_simd::Simd;
use glam::DVec3;

use super::joint_hull::{JointHull, Reach, placement_error};
use super::outer_boxes::OuterBoxes;
use super::part_boxes::Parts;
use super::posed_vertices::PosedVertices;
use super::skin_tree::{MAX_REACH, SkinTree};
use crate::bounds::{Aabb, BoxLanes, WorldFromModel, with_simd};
use crate::joints::JointMatrices;
use crate::model::{MorphModel, Skin, Weights};
use crate::tree::SkinTables;

/// The state of a skinned pose.
#[derive(Clone, Debug)]
pub(super) struct Skinning {
    pub(super) joints: JointMatrices,
    pub(super) vertices: PosedVertices,
    hull: JointHull,
    outer: OuterBoxes,
    /// The body's frame has the axes of the world and its origin in the body.
    origin: DVec3,
    reach: Reach,
    /// A bound on the rounding error of world positions.
    error: f64,
    /// A bound on the absolute coordinates of vertices in the body's frame.
    radius: f64,
    /// Whether the joints or the weights changed since the last update, and whether the weights did.
    is_old: bool,
    is_reach_old: bool,
}

impl Skinning {
    pub(super) fn new(skin: &SkinTables, joints: JointMatrices) -> Self {
        Self {
            joints,
            vertices: PosedVertices::new(),
            hull: JointHull::default(),
            outer: OuterBoxes::new(&skin.outer),
            origin: DVec3::ZERO,
            reach: Reach::default(),
            error: 0.0,
            radius: 0.0,
            is_old: true,
            is_reach_old: true,
        }
    }

    /// Notes that the joints or the weights changed. [`Skinning::update`] follows before the next question, so that a pose that gets both
    /// is updated once.
    pub(super) fn change(&mut self, weights_changed: bool) {
        self.vertices.invalidate();
        self.hull.invalidate();
        self.is_old = true;
        self.is_reach_old |= weights_changed;
    }

    /// Updates the state if the joints or the weights changed. Returns the transform of the body's frame to the world; `None` if it is the
    /// same.
    #[inline]
    pub(super) fn update(&mut self, tree: SkinTree<'_>) -> Option<WorldFromModel> {
        self.is_old.then(|| self.update_now(tree))
    }

    #[inline(never)]
    fn update_now(&mut self, tree: SkinTree<'_>) -> WorldFromModel {
        self.is_old = false;
        if std::mem::take(&mut self.is_reach_old) {
            self.reach = Reach::new(tree.model, tree.weights.all());
        }
        if let Some(skin) = tree.model.skin() {
            self.measure(tree, skin);
        }
        let [x, y, z] = DVec3::AXES;
        let frame = WorldFromModel::from_columns([x, y, z, self.origin]);
        frame.of_mirrored(tree.skin.middle.is_some_and(|(joint, _)| self.joints.mirrors(joint)))
    }

    fn measure(&mut self, tree: SkinTree<'_>, skin: &Skin) {
        let sum = skin.max_sum();
        self.error = placement_error(skin, &self.joints, self.reach.of_vertices);
        self.origin = tree.skin.middle.map_or(DVec3::ZERO, |(joint, point)| {
            let ([x, y, z, translation], point) = (self.joints.columns(joint), point.as_dvec3());
            let middle = x * point.x + y * point.y + z * point.z + translation;
            // Beyond the range of `f32` no box is bounded, wherever the origin is.
            if middle.abs().max_element() <= f64::from(MAX_REACH) {
                middle
            } else {
                DVec3::ZERO
            }
        });
        let moved = self.joints.linear_reach() * self.reach.of_vertices + self.joints.spread(self.origin);
        let missing = skin.max_missing() * self.origin.abs().max_element();
        self.radius = (sum * moved + missing + self.error) * (1.0 + 1e-9);
    }

    /// A bound on the rounding error of world positions.
    pub(super) fn error(&self) -> f64 {
        self.error
    }

    /// The same for a pose that may not be up to date.
    pub(super) fn error_with(&self, model: &MorphModel, weights: &Weights) -> f64 {
        if !self.is_old {
            return self.error;
        }
        let of_skin = |skin| placement_error(skin, &self.joints, Reach::new(model, weights.all()).of_vertices);
        model.skin().map_or(0.0, of_skin)
    }

    /// By how much boxes that are fitted to vertices are widened, to cover the rounding of coordinates in the body's frame. Infinite if
    /// these are too large to compute with.
    pub(super) fn widening(&self) -> f32 {
        // Narrowing rounds by half as much. False for NaN.
        if self.radius <= f64::from(MAX_REACH) {
            self.radius as f32 * f32::EPSILON + f32::MIN_POSITIVE
        } else {
            f32::INFINITY
        }
    }

    /// Poses the vertices of a chunk. Returns how many.
    #[inline]
    pub(super) fn pose_chunk(&mut self, tree: SkinTree<'_>, chunk: usize) -> u64 {
        self.vertices.pose_chunk(tree, &self.joints, self.origin, chunk)
    }

    /// Poses all vertices that are not posed yet. Returns how many.
    #[inline(always)]
    pub(super) fn pose_all<S: Simd>(&mut self, simd: S, tree: SkinTree<'_>) -> u64 {
        self.vertices.pose_all(simd, tree, &self.joints, self.origin)
    }

    /// Poses a block of vertices. Returns how many.
    pub(super) fn pose_block(&mut self, tree: SkinTree<'_>, block: usize) -> u64 {
        with_simd!(tree.level, simd => self.vertices.pose(simd, tree, &self.joints, self.origin, block))
    }

    /// Boxes around the children of a group above the chunks, in the body's frame.
    pub(super) fn outer(&mut self, tree: SkinTree<'_>, outer: usize, boxes: &mut BoxLanes) {
        self.outer.compute(tree, outer, &self.joints, self.origin, boxes);
    }

    /// A box in world space around all vertices.
    pub(super) fn world_bounds(&mut self, tree: SkinTree<'_>) -> Aabb {
        self.hull.around(tree, &self.joints, &self.reach, self.error)
    }

    /// A box around all vertices in the model space of an entity.
    pub(super) fn bounds_in(&mut self, tree: SkinTree<'_>, place: &WorldFromModel) -> Aabb {
        self.hull.around_in(tree, &self.joints, &self.reach, self.error, place)
    }

    /// Boxes around the vertices of each joint, before it moves them; `None` if coordinates are too large to compute with.
    pub(super) fn joint_boxes<'a>(&'a mut self, tree: SkinTree<'a>) -> Option<Parts<'a>> {
        self.hull.parts(tree)
    }

    pub(super) fn bytes(&self) -> usize {
        self.vertices.bytes() + self.hull.bytes() + self.outer.bytes()
    }
}
