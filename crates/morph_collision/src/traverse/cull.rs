use fearless_simd::Simd;

use super::rule::{Opened, PairRule};
use crate::bounds::{Aabb, BoxLanes, BoxMap, Frames, LANES, with_simd};
use crate::pose::{NodeRef, Posed};

/// One of the two bodies of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    A,
    B,
}

/// The rule of pair queries: selects node pairs whose boxes overlap in every frame.
///
/// Holds the frames of a query, and the boxes mapped to them so far. The next query reuses the memory.
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

impl Cull {
    fn overlap(&self, a: &Aabb, b: &Aabb) -> bool {
        self.a.one(a).overlaps(&self.b.one(b))
    }

    /// The view of a side, then the other one.
    #[inline(always)]
    fn views(&mut self, side: Side) -> (&mut View, &mut View) {
        match side {
            Side::A => (&mut self.a, &mut self.b),
            Side::B => (&mut self.b, &mut self.a),
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
        cull.overlap(a, b)
    }
}

impl PairRule for Culls {
    type Key = ();

    /// By [`Culls::push`].
    const ROOTS_ARE_TESTED: bool = true;

    const OPENS_BOTH: bool = true;

    fn start(&mut self, a: &Aabb, b: &Aabb) -> Option<()> {
        let mut culls = self.culls[..self.len].iter();
        culls.all(|cull| cull.overlap(a, b)).then_some(())
    }

    #[inline(always)]
    fn children(
        &mut self,
        side: Side,
        (own, opened): (&Posed<'_>, Opened),
        (other, node): (&Posed<'_>, NodeRef),
        _keys: &mut [(); LANES],
    ) -> u8 {
        let (other_slot, lane) = (node.slot as usize, usize::from(node.id.lane));
        let mut mask = opened.mask;
        with_simd!(own.level, simd => for cull in &mut self.culls[..self.len] {
            let (own_view, other_view) = cull.views(side);
            own_view.prepare(simd, self.query, opened.slot, own);
            other_view.prepare(simd, self.query, other_slot, other);
            let other = other_view.boxes(other_slot, other).get(lane);
            mask &= own_view.boxes(opened.slot, own).overlap_mask(simd, &other);
            if mask == 0 {
                break;
            }
        });
        mask
    }

    #[inline(always)]
    fn both(&mut self, (tree_a, a): (&Posed<'_>, Opened), (tree_b, b): (&Posed<'_>, Opened)) -> [u8; LANES] {
        let mut rows = a.mask;
        let mut masks = [b.mask; LANES];
        with_simd!(tree_a.level, simd => for cull in &mut self.culls[..self.len] {
            cull.a.prepare(simd, self.query, a.slot, tree_a);
            cull.b.prepare(simd, self.query, b.slot, tree_b);
            let (boxes_a, boxes_b) = (cull.a.boxes(a.slot, tree_a), cull.b.boxes(b.slot, tree_b));
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
        });
        masks
    }

    #[inline(always)]
    fn depths(&mut self, side: Side, own: (&Posed<'_>, usize), other: (&Posed<'_>, NodeRef)) -> [f32; LANES] {
        let mut depths = [0.0; LANES];
        if let Some(cull) = self.culls[..self.len].first_mut() {
            let ((own, slot), (other, node)) = (own, other);
            let (own_view, other_view) = cull.views(side);
            let other = other_view
                .boxes(node.slot as usize, other)
                .get(usize::from(node.id.lane));
            with_simd!(own.level, simd => own_view.boxes(slot, own).depths(simd, &other, &mut depths));
        }
        depths
    }
}
