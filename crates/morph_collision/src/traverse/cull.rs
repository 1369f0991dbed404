//! Volumes of two bodies compared in frames that both can be taken to.

use std::any::Any;

use fearless_simd::{Level, Simd};

use super::walkable::Walkable;
use crate::bounds::{Aabb, BoxLanes, CrossAxes, FrameSide, Frames, LANES, Volume, with_simd};
use crate::pose::NodeRef;

/// One of the two bodies of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    A,
    B,
}

/// The frames in which the volumes of two bodies are compared, for the time of a query; the memory is reused by the next one.
#[derive(Debug)]
pub(crate) struct Culls<V: Volume> {
    culls: Vec<Cull<V>>,
    /// How many of them this query has.
    len: usize,
    query: u32,
}

/// A frame.
#[derive(Debug)]
struct Cull<V: Volume> {
    a: View<V>,
    b: View<V>,
    /// What a length in this frame is at least in A's space.
    stretch: f64,
}

/// How a frame sees one body's volumes: as they are, or through a map, each group of them once in a query.
#[derive(Debug)]
struct View<V: Volume> {
    map: Option<V::Map>,
    /// By slot in the pose's cache.
    mapped: Vec<V>,
    /// The query that mapped a slot last.
    stamps: Vec<u32>,
}

impl<V: Volume> Default for View<V> {
    fn default() -> Self {
        Self {
            map: None,
            mapped: Vec::new(),
            stamps: Vec::new(),
        }
    }
}

impl<V: Volume> View<V> {
    fn one(&self, one: &V::One) -> V::One {
        self.map.as_ref().map_or(*one, |map| V::map_one(map, one))
    }

    /// Maps the volumes in a slot, unless that was done in this query or they stay as they are.
    #[inline(always)]
    fn look<S: Simd>(&mut self, simd: S, query: u32, slot: usize, tree: &impl Walkable<Kind = V>) {
        if self.map.is_none() || self.stamps.get(slot) == Some(&query) {
            return;
        }
        if self.stamps.len() <= slot {
            self.grow(slot);
        }
        let Some(map) = &self.map else { return };
        let mut room = V::default();
        tree.volumes(slot, &mut room).map_all(simd, map, &mut self.mapped[slot]);
        self.stamps[slot] = query;
    }

    #[cold]
    fn grow(&mut self, slot: usize) {
        self.stamps.resize(slot + 1, 0);
        self.mapped.resize(slot + 1, V::default());
    }

    /// The volumes in a slot that was looked at.
    #[inline(always)]
    fn volumes<'a>(&'a self, slot: usize, tree: &'a impl Walkable<Kind = V>, room: &'a mut V) -> &'a V {
        match self.map {
            Some(_) => &self.mapped[slot],
            None => tree.volumes(slot, room),
        }
    }
}

impl<V: Volume> Default for Culls<V> {
    fn default() -> Self {
        Self {
            culls: Vec::new(),
            len: 0,
            query: 0,
        }
    }
}

impl<V: Volume> Culls<V> {
    /// Forgets the query before.
    pub(crate) fn begin(&mut self) {
        self.len = 0;
        self.query = self.query.wrapping_add(1);
        if self.query == 0 {
            self.query = 1;
            for cull in &mut self.culls {
                cull.a.stamps.fill(0);
                cull.b.stamps.fill(0);
            }
        }
    }

    /// Adds a frame; one that is beyond `f32` would cull nothing and is left out. Says if two volumes may share a point as
    /// far as this frame can tell.
    pub(crate) fn push(&mut self, frames: &Frames, a: &V::One, b: &V::One) -> bool {
        let map = |frame: &Option<_>| match frame {
            Some(frame) => V::map(frame).map(Some),
            None => Some(None),
        };
        let (Some(map_a), Some(map_b)) = (map(&frames.a), map(&frames.b)) else {
            return true;
        };
        if self.len == self.culls.len() {
            self.culls.push(Cull {
                a: View::default(),
                b: View::default(),
                stretch: 0.0,
            });
        }
        let cull = &mut self.culls[self.len];
        (cull.a.map, cull.b.map, cull.stretch) = (map_a, map_b, frames.stretch);
        self.len += 1;
        V::overlap(&cull.a.one(a), &cull.b.one(b))
    }

    /// A lower bound of the distance in A's space between two volumes, 0 or less where no frame parts them.
    pub(crate) fn gap(&self, a: &V::One, b: &V::One) -> f64 {
        let gap = |cull: &Cull<V>| V::gap(&cull.a.one(a), &cull.b.one(b)) * cull.stretch;
        self.culls[..self.len].iter().map(gap).fold(0.0, f64::max)
    }

    /// Whether two volumes may share a point.
    pub(crate) fn overlap(&self, a: &V::One, b: &V::One) -> bool {
        let overlap = |cull: &Cull<V>| V::overlap(&cull.a.one(a), &cull.b.one(b));
        self.culls[..self.len].iter().all(overlap)
    }

    /// Which volumes in an opened group's slot of one side, out of `mask`, may share a point with a node of the other.
    #[inline(always)]
    pub(super) fn overlap_mask<S: Simd, T: Walkable<Kind = V>>(
        &mut self,
        simd: S,
        side: Side,
        (own, slot, mut mask): (&T, usize, u8),
        (other, node): (&T, NodeRef),
    ) -> u8 {
        let query = self.query;
        let (other_slot, lane) = (node.slot as usize, usize::from(node.place.lane));
        for cull in &mut self.culls[..self.len] {
            let (own_view, other_view) = match side {
                Side::A => (&mut cull.a, &mut cull.b),
                Side::B => (&mut cull.b, &mut cull.a),
            };
            own_view.look(simd, query, slot, own);
            other_view.look(simd, query, other_slot, other);
            let (mut room, mut other_room) = (V::default(), V::default());
            let volumes = own_view.volumes(slot, own, &mut room);
            let other = other_view.volumes(other_slot, other, &mut other_room);
            mask &= volumes.overlap_mask(simd, &other.get(lane));
            if mask == 0 {
                break;
            }
        }
        mask
    }
}

impl<V: Volume> Culls<V> {
    /// For each lane of `rows` in an opened group's slot of A, which volumes in a slot of B, out of `mask`, may share a point
    /// with it.
    #[inline(always)]
    pub(super) fn overlap_rows<S: Simd, T: Walkable<Kind = V>>(
        &mut self,
        simd: S,
        (a, slot_a, mut rows): (&T, usize, u8),
        (b, slot_b, mask): (&T, usize, u8),
        masks: &mut [u8; LANES],
    ) {
        let query = self.query;
        *masks = [mask; LANES];
        for cull in &mut self.culls[..self.len] {
            cull.a.look(simd, query, slot_a, a);
            cull.b.look(simd, query, slot_b, b);
            let (mut room_a, mut room_b) = (V::default(), V::default());
            let volumes_a = cull.a.volumes(slot_a, a, &mut room_a);
            let volumes_b = cull.b.volumes(slot_b, b, &mut room_b);
            let mut left = rows;
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                let met = masks[lane] & volumes_b.overlap_mask(simd, &volumes_a.get(lane));
                masks[lane] = met;
                rows &= !(u8::from(met == 0) << lane);
            }
            if rows == 0 {
                break;
            }
        }
    }
}

impl<V: Volume> Culls<V> {
    /// How far each volume in an opened group's slot of one side reaches into a node of the other, about; both were compared.
    #[inline(always)]
    pub(super) fn depths<S: Simd, T: Walkable<Kind = V>>(
        &self,
        simd: S,
        side: Side,
        (own, slot): (&T, usize),
        (other, other_slot, lane): (&T, usize, usize),
        depths: &mut [f32; LANES],
    ) {
        let Some(cull) = self.culls[..self.len].first() else {
            return;
        };
        let (own_view, other_view) = match side {
            Side::A => (&cull.a, &cull.b),
            Side::B => (&cull.b, &cull.a),
        };
        let (mut room, mut other_room) = (V::default(), V::default());
        let volumes = own_view.volumes(slot, own, &mut room);
        let other = other_view.volumes(other_slot, other, &mut other_room);
        volumes.depths(simd, &other.get(lane), depths);
    }
}

/// [`Culls`] of the kind of volume that was compared last.
#[derive(Debug, Default)]
pub(crate) struct AnyCulls(Option<Box<dyn Any + Send + Sync>>);

impl AnyCulls {
    /// Those of a kind.
    pub(crate) fn of<V: Volume>(&mut self) -> &mut Culls<V> {
        if !self.0.as_ref().is_some_and(|culls| culls.is::<Culls<V>>()) {
            self.0 = Some(Box::new(Culls::<V>::default()));
        }
        match self.0.as_mut().and_then(|culls| culls.downcast_mut()) {
            Some(culls) => culls,
            None => unreachable!("it was just made of this kind"),
        }
    }
}

/// The products of both bodies' axes, along which boxes that meet in every frame may still be apart.
#[derive(Debug)]
pub(crate) struct CrossCull {
    axes: CrossAxes,
    target: Side,
}

impl CrossCull {
    /// In the space of a body that can be inverted; `None` if neither can. `a` and `b` are the bodies' whole bounds.
    pub(crate) fn new(frames: &Frames, a: &Aabb, b: &Aabb) -> Option<Self> {
        let (frame, bounds, target) = match (&frames.a, &frames.b) {
            (None, Some(a_from_b)) => (a_from_b, a, Side::A),
            (Some(b_from_a), None) => (b_from_a, b, Side::B),
            _ => return None,
        };
        Some(Self {
            axes: CrossAxes::new(frame, bounds),
            target,
        })
    }

    /// Which of eight boxes of one side, out of `mask`, may meet a box of the other.
    pub(crate) fn overlap_mask(&self, level: Level, side: Side, boxes: &BoxLanes, other: &Aabb, mask: u8) -> u8 {
        let side = if side == self.target {
            FrameSide::Target
        } else {
            FrameSide::Source
        };
        with_simd!(level, simd => self.axes.overlap_mask(simd, side, boxes, other, mask))
    }
}
