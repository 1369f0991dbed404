//! Boxes of two bodies, compared in common frames.

use fearless_simd::Simd;

use crate::bounds::{Aabb, BoxLanes, BoxMap, Frames, LANES};
use crate::pose::{NodeRef, Posed};

/// One of the two bodies of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    A,
    B,
}

/// The frames of a query, and the boxes mapped to them so far. The next query reuses the memory.
#[derive(Debug, Default)]
pub(crate) struct Culls {
    culls: Vec<Cull>,
    /// How many of `culls` this query uses.
    len: usize,
    query: u32,
}

/// One frame.
#[derive(Debug, Default)]
struct Cull {
    a: View,
    b: View,
}

/// One body's boxes in a frame: unchanged, or mapped, each group once per query.
#[derive(Debug, Default)]
struct View {
    map: Option<BoxMap>,
    /// By slot of the pose's cache.
    mapped: Vec<BoxLanes>,
    /// By slot: the last query that mapped it.
    stamps: Vec<u32>,
}

impl View {
    fn one(&self, one: &Aabb) -> Aabb {
        self.map.as_ref().map_or(*one, |map| map.one(one))
    }

    /// Maps the boxes of a slot if this query has not done so yet.
    #[inline(always)]
    fn prepare<S: Simd>(&mut self, simd: S, query: u32, slot: usize, tree: &Posed<'_>) {
        if self.map.is_none() || self.stamps.get(slot) == Some(&query) {
            return;
        }
        if self.stamps.len() <= slot {
            self.grow(slot);
        }
        let Some(map) = &self.map else { return };
        map.all(simd, tree.boxes(slot), &mut self.mapped[slot]);
        self.stamps[slot] = query;
    }

    #[cold]
    fn grow(&mut self, slot: usize) {
        self.stamps.resize(slot + 1, 0);
        self.mapped.resize(slot + 1, BoxLanes::default());
    }

    /// The boxes of a prepared slot.
    #[inline(always)]
    fn boxes<'a>(&'a self, slot: usize, tree: &'a Posed<'_>) -> &'a BoxLanes {
        match self.map {
            Some(_) => &self.mapped[slot],
            None => tree.boxes(slot),
        }
    }
}

impl Culls {
    /// Starts a query, without frames.
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

    /// Adds a frame; returns whether two boxes overlap in it. Ignores frames beyond the range of `f32`, which would cull nothing.
    pub(crate) fn push(&mut self, frames: &Frames, a: &Aabb, b: &Aabb) -> bool {
        let map = |frame: &Option<_>| match frame {
            Some(frame) => BoxMap::new(frame).map(Some),
            None => Some(None),
        };
        let (Some(map_a), Some(map_b)) = (map(&frames.a), map(&frames.b)) else {
            return true;
        };
        if self.len == self.culls.len() {
            self.culls.push(Cull::default());
        }
        let cull = &mut self.culls[self.len];
        (cull.a.map, cull.b.map) = (map_a, map_b);
        self.len += 1;
        cull.a.one(a).overlaps(&cull.b.one(b))
    }

    /// Whether two boxes overlap in every frame.
    pub(crate) fn overlap(&self, a: &Aabb, b: &Aabb) -> bool {
        let overlap = |cull: &Cull| cull.a.one(a).overlaps(&cull.b.one(b));
        self.culls[..self.len].iter().all(overlap)
    }

    /// The boxes in an opened slot of one side, out of a mask, that overlap a node of the other side in every frame.
    #[inline(always)]
    pub(super) fn overlap_mask<S: Simd>(
        &mut self,
        simd: S,
        side: Side,
        (own, slot, mut mask): (&Posed<'_>, usize, u8),
        (other, node): (&Posed<'_>, NodeRef),
    ) -> u8 {
        let query = self.query;
        let (other_slot, lane) = (node.slot as usize, usize::from(node.id.lane));
        for cull in &mut self.culls[..self.len] {
            let (own_view, other_view) = match side {
                Side::A => (&mut cull.a, &mut cull.b),
                Side::B => (&mut cull.b, &mut cull.a),
            };
            own_view.prepare(simd, query, slot, own);
            other_view.prepare(simd, query, other_slot, other);
            let other = other_view.boxes(other_slot, other).get(lane);
            mask &= own_view.boxes(slot, own).overlap_mask(simd, &other);
            if mask == 0 {
                break;
            }
        }
        mask
    }

    /// For each lane of a slot of A, out of `rows`: the boxes in a slot of B, out of a mask, that overlap it in every frame.
    #[inline(always)]
    pub(super) fn overlap_rows<S: Simd>(
        &mut self,
        simd: S,
        (a, slot_a, mut rows): (&Posed<'_>, usize, u8),
        (b, slot_b, mask): (&Posed<'_>, usize, u8),
        masks: &mut [u8; LANES],
    ) {
        let query = self.query;
        *masks = [mask; LANES];
        for cull in &mut self.culls[..self.len] {
            cull.a.prepare(simd, query, slot_a, a);
            cull.b.prepare(simd, query, slot_b, b);
            let (boxes_a, boxes_b) = (cull.a.boxes(slot_a, a), cull.b.boxes(slot_b, b));
            let mut left = rows;
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                let met = masks[lane] & boxes_b.overlap_mask(simd, &boxes_a.get(lane));
                masks[lane] = met;
                rows &= !(u8::from(met == 0) << lane);
            }
            if rows == 0 {
                break;
            }
        }
    }

    /// Roughly how deep each box in an opened slot of one side overlaps a node of the other side. Both were tested before.
    #[inline(always)]
    pub(super) fn depths<S: Simd>(
        &self,
        simd: S,
        side: Side,
        (own, slot): (&Posed<'_>, usize),
        (other, other_slot, lane): (&Posed<'_>, usize, usize),
        depths: &mut [f32; LANES],
    ) {
        let Some(cull) = self.culls[..self.len].first() else {
            return;
        };
        let (own_view, other_view) = match side {
            Side::A => (&cull.a, &cull.b),
            Side::B => (&cull.b, &cull.a),
        };
        let other = other_view.boxes(other_slot, other).get(lane);
        own_view.boxes(slot, own).depths(simd, &other, depths);
    }
}
