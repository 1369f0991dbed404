//! What a pose of a skinned mesh keeps: its joints, the maps to the frames of its boxes, and what was made with them.

use fearless_simd::{Level, Simd};
use glam::DVec3;

use super::cache::EpochCache;
use super::joint_hull::JointHull;
use super::skin_blend::blend_skinned;
use crate::bounds::{Aabb, BoxLanes, BoxMap, Frame, JointMap, MapFrame, PlacedBounds, WorldFromModel, with_simd};
use crate::joints::JointMatrices;
use crate::model::{MorphModel, Skin, Weights};
use crate::tree::{BODY_FRAME, SkinTables};

/// The state of a skinned pose.
#[derive(Clone, Debug)]
pub(super) struct Skinning {
    pub(super) joints: JointMatrices,
    /// Of joints and weights together: it counts their changes.
    version: u32,
    frames: Vec<BoneFrame>,
    maps: Vec<KeptMap>,
    /// By group, in the group's frame. They outlast joints that move without changing a group's maps.
    boxes: EpochCache<BoxLanes>,
    /// By group.
    made: Vec<Made>,
    hull: JointHull,
    /// World positions, by welded vertex, in the first three numbers.
    pub(super) placed: EpochCache<[f64; 4]>,
    /// The largest absolute coordinate of vertices before joints move them.
    reach: f64,
    /// How far world positions may be from those without rounding.
    error: f64,
    /// The largest absolute world coordinate of a vertex relative to the body's frame.
    radius: f64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Made {
    /// The version in which the boxes were last found to be right.
    version: u32,
    /// How much they were widened.
    widening: f32,
    /// How far the world's origin may be along an axis.
    origin: f32,
}

/// A space in which boxes are kept.
#[derive(Clone, Debug, Default)]
struct BoneFrame {
    /// The version it is of.
    version: u32,
    /// Whether boxes are kept in it; otherwise they are in the body's frame.
    is_used: bool,
    place: WorldFromModel,
    /// What maps to it are made of.
    maps: MapFrame,
    /// How far the world's origin is along an axis.
    origin: f32,
    /// The version that the maps to the body's frame are of.
    placed_in: u32,
    to_body: Option<Frame>,
    boxes_to_body: Option<BoxMap>,
}

#[derive(Clone, Copy, Debug, Default)]
struct KeptMap {
    map: JointMap,
    /// The version in which it was last found to be right.
    version: u32,
    /// That in which it last changed.
    changed: u32,
}

/// What the functions below need of the tree.
#[derive(Clone, Copy)]
pub(super) struct SkinTree<'a> {
    pub(super) model: &'a MorphModel,
    pub(super) skin: &'a SkinTables,
    pub(super) weights: &'a Weights,
    pub(super) level: Level,
}

impl Skinning {
    pub(super) fn new(skin: &SkinTables, joints: JointMatrices, groups: usize, vertices: usize) -> Self {
        Self {
            joints,
            version: 0,
            frames: vec![BoneFrame::default(); skin.frames.len()],
            maps: vec![KeptMap::default(); skin.maps.len()],
            boxes: EpochCache::new(groups),
            made: vec![Made::default(); groups],
            hull: JointHull::default(),
            placed: EpochCache::new(vertices),
            reach: 0.0,
            error: 0.0,
            radius: 0.0,
        }
    }

    /// Follows a change of the joints or the weights; returns where the body's frame stands.
    pub(super) fn change(&mut self, tree: SkinTree<'_>, weights_changed: bool) -> WorldFromModel {
        if self.version == u32::MAX {
            let joints = self.joints.clone();
            *self = Self::new(tree.skin, joints, self.made.len(), tree.model.vertex_count());
        }
        self.version += 1;
        self.placed.next_epoch();
        if weights_changed {
            self.boxes.next_epoch();
            self.hull.forget();
        }
        let of_targets =
            tree.weights.active().iter().map(|&(target, weight)| {
                f64::from(weight.abs()) * f64::from(tree.model.target_reach()[target as usize])
            });
        // The factor covers the roundings of blends.
        self.reach = (f64::from(tree.model.base_reach()) + of_targets.sum::<f64>()) * (1.0 + 1.5e-2);
        let sum = tree.model.skin().map_or(1.0, Skin::max_sum);
        // Up to eight products and sums of matrices, three of each for the position.
        self.error = 32.0 * f64::EPSILON * sum * self.joints.world_reach(self.reach);
        self.frame_is_used(tree.skin, BODY_FRAME);
        let place = self.frames[BODY_FRAME].place;
        if let Some(skin) = tree.model.skin() {
            let origin = place.translation();
            let moved = self.joints.linear_reach() * self.reach + self.joints.spread(origin);
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

    /// How much a group's boxes were widened.
    pub(super) fn widening(&self, group: usize) -> f32 {
        self.made[group].widening
    }

    /// Whether boxes are kept in a frame. Places it first.
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
            of.origin = of.place.model_point(DVec3::ZERO).0.abs().max_element() as f32;
        }
        of.is_used
    }

    /// The frame that a group's boxes are in.
    pub(super) fn frame_of(&mut self, skin: &SkinTables, group: usize) -> usize {
        let frame = skin.frame(group);
        if self.frame_is_used(skin, frame) {
            frame
        } else {
            BODY_FRAME
        }
    }

    /// Brings a group's maps up to date; returns the version in which the last of them changed.
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
                    kept.map.follow(simd, of, self.joints.padded(joint), self.reach)
                };
                if has_changed || kept.changed == 0 {
                    kept.changed = self.version;
                }
            }
            changed = changed.max(kept.changed);
        }
        changed
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
        // Where weights do not quite sum to 1, vertices are pulled towards the world's origin, however still joints are to each other.
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
        // What is missing is tiny, so boxes stay tight, and right for a while, with more than twice the distance.
        made.origin = 2.0 * origin + self.reach as f32;
        let (maps, boxes) = (&self.maps, self.boxes.get_mut(slot));
        let map = |map: u32| &maps[map as usize].map;
        made.widening = blend_skinned(simd, tree.skin, group, tree.weights, map, made.origin, boxes);
        (slot, true)
    }

    /// A box in world space around all vertices.
    pub(super) fn world_bounds(&mut self, tree: SkinTree<'_>) -> Aabb {
        let sums = tree.model.skin().map_or(1.0..=1.0, Skin::sums);
        let (joints, slack) = (&tree.skin.joints, (sums, self.error));
        self.hull.around(tree.level, joints, tree.weights, &self.joints, slack)
    }

    /// What each joint moves, before it does; `None` where coordinates are too large to compute with.
    pub(super) fn joint_boxes(&mut self, tree: SkinTree<'_>) -> Option<&[BoxLanes]> {
        self.hull.boxes(tree.level, &tree.skin.joints, tree.weights)
    }

    /// Where a frame stands.
    pub(super) fn place_of(&self, frame: usize) -> WorldFromModel {
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

    /// The map from a frame to the body's; `None` where there is none.
    pub(super) fn body_from_frame(&mut self, frame: usize) -> Option<Frame> {
        self.place(frame);
        self.frames[frame].to_body
    }

    /// Makes the maps from a frame to the body's.
    fn place(&mut self, frame: usize) {
        let body = PlacedBounds::with_error(&self.frames[BODY_FRAME].place, DVec3::ZERO, self.error);
        let of = &mut self.frames[frame];
        if of.placed_in == self.version {
            return;
        }
        of.placed_in = self.version;
        let magnitude = of.place.model_reach(body.world_from_model().translation(), self.radius);
        let placed = PlacedBounds::with_error(&of.place, DVec3::splat(magnitude), self.error);
        of.to_body = body.frame_from(&placed);
        of.boxes_to_body = of.to_body.and_then(|frame| BoxMap::new(&frame));
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.frames)
            + size_of_val(&*self.maps)
            + size_of_val(&*self.made)
            + self.boxes.bytes()
            + self.hull.bytes()
            + self.placed.bytes()
    }
}
