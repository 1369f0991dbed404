//! A body that moves from one pose to another, as walks see it: each box contains its node during the whole motion.

use fearless_simd::Level;
use glam::DVec3;

use super::mapping::Mapping;
use crate::bounds::{Aabb, BoxLanes, MovingLanes, PlacedBounds, WorldFromModel, with_simd};
use crate::pose::{BoxTree, EpochCache, PlacedBody, Posed};
use crate::tree::Topology;

/// The boxes that a query has computed for a moving body. The next query reuses the memory.
#[derive(Debug, Default)]
pub(crate) struct MovingBoxes {
    /// Indexed by group.
    groups: EpochCache<MovingGroup>,
    /// How the boxes at the start and at the end of the motion are mapped to the space of the moving boxes.
    mappings: [Mapping; 2],
}

/// The boxes of the children of a node: at both ends of the motion, and during all of it.
#[derive(Clone, Debug, Default)]
struct MovingGroup {
    ends: MovingLanes,
    hull: BoxLanes,
}

/// A body that moves from one pose of its tree to another.
///
/// Vertices move on straight lines in the world. A box around a node's box at the start and the one at the end contains all of its
/// vertices in between, in any space that stays the same during the motion. That space is the body's own at the start. Seen from a
/// space that moves along a straight line, vertices also move on straight lines. So a translation common to both bodies is left out
/// (`drift`).
pub(crate) struct Moving<'m, 'p> {
    /// The poses at the start and at the end.
    pub(crate) ends: [Posed<'p>; 2],
    moving: &'m mut MovingBoxes,
    placed_body: PlacedBody,
    /// The boxes of the root at the start and at the end.
    root: [Aabb; 2],
    /// The body's size and the slack for rounding at the start and at the end, in world units.
    resolution: [(f64, f64); 2],
}

impl<'m, 'p> Moving<'m, 'p> {
    /// Prepares a query. `drift` is how far the observer moves during the motion.
    ///
    /// If `within`, boxes also allow for the rounding of placed vertices, because they are compared with boxes of the same body.
    pub(crate) fn new(mut ends: [Posed<'p>; 2], drift: DVec3, moving: &'m mut MovingBoxes, within: bool) -> Self {
        let [start, end] = ends.each_mut().map(|end| end.placed_body().clone());
        let world_from_model = start.placed.world_from_model();
        // Boxes of a body that is flat in the world are kept along the world's axes instead.
        let is_own = world_from_model.is_well_conditioned();
        let space = if is_own {
            *world_from_model
        } else {
            let [x, y, z] = DVec3::AXES;
            WorldFromModel::from_columns([x, y, z, world_from_model.translation()])
        };
        let after = space.translation() + drift;
        let at = |translation: DVec3| {
            // The other body's drift is rounded differently.
            let rounding = f64::EPSILON * translation.abs().max_element();
            PlacedBounds::with_error(&space.at(translation), DVec3::ZERO, rounding)
        };
        let MovingBoxes { groups, mappings } = &mut *moving;
        groups.next_epoch();
        // Maps allow for the rounding of vertices.
        let keeps = is_own && !within;
        let targets = [at(space.translation()), at(after)];
        for (i, (mapping, of)) in mappings.iter_mut().zip([&start, &end]).enumerate() {
            if i == 0 && keeps {
                mapping.set(None);
                continue;
            }
            match targets[i].frame_from(&of.placed) {
                Some(frame) => mapping.set(Some(&frame)),
                None => mapping.set_unbounded(),
            }
        }
        let mut root = [mappings[0].one(&start.bounds), mappings[1].one(&end.bounds)];
        if !(root[0].size() + root[1].size()).is_finite() {
            root = [Aabb::UNBOUNDED; 2];
        }
        let bounds = root[0].union(&root[1]);
        let placed = PlacedBounds::with_error(&space, bounds.magnitude().as_dvec3(), start.placed.error());
        // Boxes at either end are rounded as numbers in this space.
        let resolution = [0, 1].map(|i| {
            let rounding = root[i].magnitude().max_element() * f32::EPSILON;
            let of = [&start, &end][i];
            (of.size, of.slack.max(f64::from(rounding) * space.scale()))
        });
        let mut placed_body = start;
        placed_body.size = placed_body.size.max(end.size);
        placed_body.slack += end.slack;
        (placed_body.bounds, placed_body.placed) = (bounds, placed);
        Self {
            ends,
            moving,
            placed_body,
            root,
            resolution,
        }
    }

    /// The body's size at the start (0) or at the end (1), and a bound on how far rounding moves its points and widens its boxes then, in
    /// world units.
    pub(crate) fn resolution(&self, end: usize) -> (f64, f64) {
        self.resolution[end]
    }

    /// What queries about two bodies need to know of it. Its bounds contain the whole motion.
    pub(crate) fn placed_body(&self) -> &PlacedBody {
        &self.placed_body
    }

    #[inline(never)]
    fn compute(&mut self, group: usize) -> usize {
        let MovingBoxes { groups, mappings } = &mut *self.moving;
        let slot = groups.claim(group);
        let MovingGroup { ends, hull } = groups.get_mut(slot);
        if group == 0 {
            ends.set(0, &self.root);
            hull.set(0, &self.placed_body.bounds);
            return slot;
        }
        let [start, end] = &mut self.ends;
        let (at_start, at_end) = (start.open(group), end.open(group));
        with_simd!(start.level, simd => {
            mappings[0].all(simd, start.boxes(at_start), &mut ends.start);
            mappings[1].all(simd, end.boxes(at_end), &mut ends.end);
            ends.sweep(simd, hull);
        });
        slot
    }
}

impl BoxTree for Moving<'_, '_> {
    const MOVES: bool = true;

    #[inline(always)]
    fn topology(&self) -> &Topology {
        self.ends[0].topology
    }

    #[inline(always)]
    fn level(&self) -> Level {
        self.ends[0].level
    }

    #[inline(always)]
    fn open(&mut self, group: usize) -> usize {
        match self.moving.groups.find(group) {
            Some(slot) => slot,
            None => self.compute(group),
        }
    }

    #[inline(always)]
    fn boxes(&self, slot: usize) -> &BoxLanes {
        &self.moving.groups.get(slot).hull
    }

    #[inline(always)]
    fn moving_boxes(&self, slot: usize) -> Option<&MovingLanes> {
        Some(&self.moving.groups.get(slot).ends)
    }
}

/// The middle of a body's bounds in the world, to tell how far it moves as a whole.
pub(crate) fn middle(placed_body: &PlacedBody) -> DVec3 {
    let PlacedBody { bounds, placed, .. } = placed_body;
    let middle = placed.world_from_model().transform_point(bounds.center());
    if middle.is_finite() { middle } else { DVec3::ZERO }
}
