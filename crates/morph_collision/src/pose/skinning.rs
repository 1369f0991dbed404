//! The state of a skinned mesh's pose: its joints, the maps to the frames of its boxes, and the boxes computed with them.

use fearless_simd::{Level, Simd};
use glam::DVec3;

use super::cache::EpochCache;
use super::joint_hull::{JointHull, VertexSlack};
use super::outer_boxes::OuterBoxes;
use super::skin_blend::blend_skinned;
use super::skin_tree::SkinTree;
use crate::bounds::{Aabb, BoxLanes, BoxMap, Frame, JointMap, MapFrame, PlacedBounds, WorldFromModel, with_simd};
use crate::joints::JointMatrices;
use crate::model::Skin;
use crate::tree::{BODY_FRAME, SkinTables};

/// The state of a skinned pose.
#[derive(Clone, Debug)]
pub(super) struct Skinning {
    pub(super) joints: JointMatrices,
    /// Counts the changes of joints and weights.
    version: u32,
    frames: Vec<BoneFrame>,
    maps: Vec<KeptMap>,
    /// Indexed by group, in the group's frame. If the root's children are blended one by one, each is stored like a group. They stay valid while the joints move without changing the group's maps.
    boxes: EpochCache<BoxLanes>,
    /// Indexed by group.
    made: Vec<Made>,
    hull: JointHull,
    outer: OuterBoxes,
    /// Version for which `outer` was computed.
    outer_version: u32,
    /// World positions, indexed by welded vertex. The fourth number is padding.
    pub(super) placed: EpochCache<[f64; 4]>,
    /// A bound on the absolute coordinates of vertices before joints move them.
    reach: f64,
    /// A bound on the rounding error of world positions.
    error: f64,
    /// The largest absolute coordinate of a joint's translation relative to the origin of the body's frame.
    spread: f64,
    /// A bound on the absolute world coordinates of vertices relative to the origin of the body's frame.
    radius: f64,
}

/// How a group's boxes were computed.
#[derive(Clone, Copy, Debug, Default)]
struct Made {
    /// The last version for which the boxes were known to be valid.
    version: u32,
    /// By how much they were widened.
    widening: f32,
    /// The boxes are valid while the world's origin has no coordinate larger than this in the frame.
    origin: f32,
}

/// A space in which boxes are kept.
#[derive(Clone, Debug, Default)]
struct BoneFrame {
    /// Version for which the frame was computed.
    version: u32,
    /// Whether boxes are kept in it; otherwise they are in the body's frame.
    is_used: bool,
    place: WorldFromModel,
    /// Common input for the maps to this frame.
    maps: MapFrame,
    /// The largest absolute coordinate of the world's origin in this frame.
    origin: f32,
    /// Version for which `to_body` and `boxes_to_body` were computed.
    placed_in: u32,
    to_body: Option<Frame>,
    boxes_to_body: Option<BoxMap>,
}

#[derive(Clone, Copy, Debug, Default)]
struct KeptMap {
    map: JointMap,
    /// The last version for which the map was known to be valid.
    version: u32,
    /// The version in which it last changed.
    changed: u32,
}

impl Skinning {
    pub(super) fn new(skin: &SkinTables, joints: JointMatrices, vertices: usize) -> Self {
        let groups = skin.group_count();
        Self {
            joints,
            version: 0,
            frames: vec![BoneFrame::default(); skin.frames.len()],
            maps: vec![KeptMap::default(); skin.maps.len()],
            boxes: EpochCache::new(groups),
            made: vec![Made::default(); groups],
            hull: JointHull::default(),
            outer: OuterBoxes::default(),
            outer_version: 0,
            placed: EpochCache::new(vertices),
            reach: 0.0,
            error: 0.0,
            spread: 0.0,
            radius: 0.0,
        }
    }

    /// Updates the state after a change of the joints or the weights. Returns the transform of the body's frame to the world.
    pub(super) fn change(&mut self, tree: SkinTree<'_>, mut weights_changed: bool) -> WorldFromModel {
        if self.version == u32::MAX {
            let joints = self.joints.clone();
            *self = Self::new(tree.skin, joints, tree.model.vertex_count());
            weights_changed = true;
        }
        self.version += 1;
        self.placed.next_epoch();
        if weights_changed {
            self.boxes.next_epoch();
            self.hull.invalidate();
            self.outer.invalidate();
            let of_targets = tree.weights.active().iter().map(|&(target, weight)| {
                f64::from(weight.abs()) * f64::from(tree.model.target_reach()[target as usize])
            });
            // The factor covers the rounding of blends.
            self.reach = (f64::from(tree.model.base_reach()) + of_targets.sum::<f64>()) * (1.0 + 1.5e-2);
        }
        let (sum, influences) = tree
            .model
            .skin()
            .map_or((1.0, 1), |skin| (skin.max_sum(), skin.most_influences()));
        // A product and a sum per influence for the matrix, and three of each for the position.
        self.error = 4.0 * influences as f64 * f64::EPSILON * sum * self.joints.world_reach(self.reach);
        self.frame_is_used(tree.skin, BODY_FRAME);
        let place = self.frames[BODY_FRAME].place;
        if let Some(skin) = tree.model.skin() {
            let origin = place.translation();
            self.spread = self.joints.spread(origin);
            let moved = self.joints.linear_reach() * self.reach + self.spread;
            let missing = skin.max_missing() * origin.abs().max_element();
            self.radius = (skin.max_sum() * moved + missing + self.error) * (1.0 + 1e-9);
        }
        place
    }

    pub(super) fn version(&self) -> u32 {
        self.version
    }

    pub(super) fn error(&self) -> f64 {
        self.error
    }

    /// By how much a group's boxes were widened.
    pub(super) fn widening(&self, skin: &SkinTables, group: usize) -> f32 {
        let made = match &skin.root_children {
            Some(children) if children.group == group => &self.made[children.first..][..children.children.len()],
            _ => &self.made[group..=group],
        };
        made.iter().map(|made| made.widening).fold(0.0, f32::max)
    }

    /// Brings a frame up to date and returns whether boxes are kept in it.
    fn frame_is_used(&mut self, skin: &SkinTables, frame: usize) -> bool {
        let of = &mut self.frames[frame];
        if of.version != self.version {
            of.version = self.version;
            let columns = skin.frames[frame].map(|joint| self.joints.columns(joint));
            of.place = columns.map_or(WorldFromModel::IDENTITY, WorldFromModel::from_columns);
            of.is_used = of.place.is_well_conditioned();
            if frame == BODY_FRAME && !of.is_used {
                let [x, y, z] = DVec3::AXES;
                of.place = WorldFromModel::from_columns([x, y, z, of.place.translation()]);
            }
            of.maps = MapFrame::new(&of.place);
            of.origin = of.place.model_origin().abs().max_element() as f32;
        }
        of.is_used
    }

    /// The frame of a group's boxes.
    pub(super) fn frame_of(&mut self, skin: &SkinTables, group: usize) -> usize {
        let frame = skin.frame(group);
        if self.frame_is_used(skin, frame) {
            frame
        } else {
            BODY_FRAME
        }
    }

    /// Brings a group's maps up to date. Returns the latest version in which one of them changed.
    #[inline(always)]
    fn follow<S: Simd>(&mut self, simd: S, skin: &SkinTables, group: usize, frame: usize) -> u32 {
        let (own, of) = (skin.frames[frame], &self.frames[frame].maps);
        let mut changed = 0;
        for &map in skin.maps_of(group) {
            let kept = &mut self.maps[map as usize];
            if kept.version != self.version {
                kept.version = self.version;
                let joint = skin.maps[map as usize].joint;
                let has_changed = if own == Some(joint) && self.frames[frame].is_used {
                    !std::mem::replace(&mut kept.map, JointMap::IDENTITY).is_identity
                } else {
                    kept.map.update(simd, of, self.joints.padded(joint), self.reach)
                };
                if has_changed || kept.changed == 0 {
                    kept.changed = self.version;
                }
            }
            changed = changed.max(kept.changed);
        }
        changed
    }

    /// Boxes around the root's children in the body's frame, for which none of them is blended; `None` if they are always blended together.
    pub(super) fn outer(&mut self, tree: SkinTree<'_>) -> Option<&OuterBoxes> {
        let children = tree.skin.root_children.as_ref()?;
        if self.outer_version != self.version {
            self.outer_version = self.version;
            let frame = &self.frames[BODY_FRAME].maps;
            self.outer
                .compute(tree.level, children, tree.weights, &self.joints, frame, self.spread);
        }
        Some(&self.outer)
    }

    /// The box of one of the root's children in the body's frame, and whether it had to be blended.
    pub(super) fn root_child(&mut self, tree: SkinTree<'_>, first: usize, lane: usize) -> (Aabb, bool) {
        let (slot, was_blended) = self.open(tree, first + lane);
        let boxes = self.boxes.get(slot);
        let bounds = with_simd!(tree.level, simd => boxes.hull_of_all(simd));
        self.outer.replace(lane, &bounds);
        (bounds, was_blended)
    }

    /// The slot of a group's boxes in its frame, and whether they had to be blended.
    #[inline(always)]
    pub(super) fn open(&mut self, tree: SkinTree<'_>, group: usize) -> (usize, bool) {
        match self.boxes.find(group) {
            Some(slot) if self.made[group].version == self.version => (slot, false),
            found => {
                let frame = self.frame_of(tree.skin, group);
                with_simd!(tree.level, simd => self.make(simd, tree, group, frame, found))
            }
        }
    }

    #[inline(always)]
    fn make<S: Simd>(
        &mut self,
        simd: S,
        tree: SkinTree<'_>,
        group: usize,
        frame: usize,
        found: Option<usize>,
    ) -> (usize, bool) {
        let changed = self.follow(simd, tree.skin, group, frame);
        // If weights do not quite sum to 1, vertices are pulled towards the world's origin, even if joints do not move relative to
        // each other.
        let origin = self.frames[frame].origin;
        let made = &mut self.made[group];
        let is_right = changed <= made.version && (origin <= made.origin || !tree.skin.misses_weight(group));
        made.version = self.version;
        if let Some(slot) = found
            && is_right
        {
            return (slot, false);
        }
        let slot = found.unwrap_or_else(|| self.boxes.claim(group));
        // Allow for more than twice the distance, so that the boxes stay valid for a while. The missing weight is tiny, so they are
        // still tight.
        made.origin = 2.0 * origin + self.reach as f32;
        let (maps, boxes) = (&self.maps, self.boxes.get_mut(slot));
        let map = |map: u32| &maps[map as usize].map;
        made.widening = blend_skinned(simd, tree.skin, group, tree.weights, map, made.origin, boxes);
        (slot, true)
    }

    /// A box in world space around all vertices.
    pub(super) fn world_bounds(&mut self, tree: SkinTree<'_>) -> Aabb {
        let sums = tree.model.skin().map_or(1.0..=1.0, Skin::sums);
        let (joints, slack) = (
            &tree.skin.joints,
            VertexSlack {
                sums,
                error: self.error,
            },
        );
        self.hull.around(tree.level, joints, tree.weights, &self.joints, slack)
    }

    /// A box around all vertices in the model space of `space`.
    pub(super) fn bounds_in(&mut self, tree: SkinTree<'_>, space: &WorldFromModel) -> Aabb {
        let sums = tree.model.skin().map_or(1.0..=1.0, Skin::sums);
        let (joints, slack) = (
            &tree.skin.joints,
            VertexSlack {
                sums,
                error: self.error,
            },
        );
        self.hull
            .around_in(tree.level, joints, tree.weights, &self.joints, slack, space)
    }

    /// Boxes around the vertices of each joint, before it moves them; `None` if coordinates are too large to compute with.
    pub(super) fn joint_boxes(&mut self, tree: SkinTree<'_>) -> Option<&[BoxLanes]> {
        self.hull.boxes(tree.level, &tree.skin.joints, tree.weights)
    }

    /// The transform from a frame to the world.
    pub(super) fn world_from_frame(&self, frame: usize) -> WorldFromModel {
        self.frames[frame].place
    }

    /// Maps boxes to the body's frame.
    pub(super) fn in_body(&mut self, level: Level, frame: usize, slot: usize, boxes: &mut BoxLanes) {
        if frame == BODY_FRAME {
            *boxes = *self.boxes.get(slot);
            return;
        }
        self.place(frame);
        match &self.frames[frame].boxes_to_body {
            Some(map) => with_simd!(level, simd => map.all(simd, self.boxes.get(slot), boxes)),
            None => boxes.set_all(&Aabb::UNBOUNDED),
        }
    }

    /// The boxes in a slot, in the frame of their group.
    pub(super) fn boxes(&self, slot: usize) -> &BoxLanes {
        self.boxes.get(slot)
    }

    /// The map from a frame to the body's; `None` if it could not be computed.
    pub(super) fn body_from_frame(&mut self, frame: usize) -> Option<Frame> {
        self.place(frame);
        self.frames[frame].to_body
    }

    /// Computes the maps from a frame to the body's.
    fn place(&mut self, frame: usize) {
        let body = PlacedBounds::with_error(&self.frames[BODY_FRAME].place, DVec3::ZERO, self.error);
        if self.frames[frame].placed_in == self.version {
            return;
        }
        let placed = self.placed(frame);
        let of = &mut self.frames[frame];
        of.placed_in = self.version;
        of.to_body = body.frame_from(&placed);
        of.boxes_to_body = of.to_body.and_then(|frame| BoxMap::new(&frame));
    }

    /// A frame as a body in the world. Its magnitude covers every vertex.
    pub(super) fn placed(&self, frame: usize) -> PlacedBounds {
        let (origin, place) = (self.frames[BODY_FRAME].place.translation(), &self.frames[frame].place);
        let magnitude = place.model_reach(origin, self.radius);
        PlacedBounds::with_error(place, DVec3::splat(magnitude), self.error)
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.frames)
            + size_of_val(&*self.maps)
            + size_of_val(&*self.made)
            + self.boxes.bytes()
            + self.hull.bytes()
            + self.outer.bytes()
            + self.placed.bytes()
    }
}
