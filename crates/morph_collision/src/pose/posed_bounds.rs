//! The bounds of a posed body, in its own space and in the world.

use super::blend::max_widening;
use super::placed_body::PlacedBody;
use super::posed::Posed;
use crate::bounds::{Aabb, BoxLanes, BoxMap, PlacedBounds, with_simd, world_map};
use crate::tree::{ChildKind, Source};

impl Posed<'_> {
    /// The group from which the body's bounds are computed: that of the root's children; the root's own group if it is a leaf, or if
    /// vertices would have to be posed for the boxes of its children.
    pub(super) fn top_group(&self) -> usize {
        match (self.topology.group(0).child(0).kind(), &self.skin) {
            (ChildKind::Leaf(_), _) => 0,
            (ChildKind::Group(group), None) => group,
            (ChildKind::Group(group), Some((tables, _))) => match tables.chunks.source(group) {
                Source::Outer(_) => group,
                Source::Chunk(_) => 0,
            },
        }
    }

    /// Whether the boxes that the body's bounds are computed from are cached.
    pub(super) fn is_top_open(&self) -> bool {
        self.is_open(self.top_group())
    }

    /// The slot and the number of the top group's children.
    fn top(&mut self) -> (usize, usize) {
        let group = self.top_group();
        (self.open(group), self.topology.group(group).children().len())
    }

    /// A box around the posed mesh in model space: the hull of the root's children, which is tighter than the root's box.
    pub(crate) fn bounds(&mut self) -> Aabb {
        let (slot, children) = self.top();
        with_simd!(self.level, simd => self.boxes(slot).hull(simd, children))
    }

    /// A box in world space; infinite if coordinates exceed the range of `f32`.
    pub(super) fn world_bounds(&mut self) -> Aabb {
        let map = world_map(&self.placed_body().placed);
        self.mapped_bounds(map)
    }

    fn mapped_bounds(&mut self, map: Option<BoxMap>) -> Aabb {
        let Some(map) = map else {
            return Aabb::UNBOUNDED;
        };
        let (slot, children) = self.top();
        let mut mapped = BoxLanes::default();
        with_simd!(self.level, simd => {
            map.all(simd, self.boxes(slot), &mut mapped);
            mapped.hull(simd, children)
        })
    }

    /// By how much boxes may be widened for rounding if the posed mesh is much smaller than the base; otherwise 0.
    ///
    /// `size` is the size of the posed mesh. docs/numerics.md, "Collapsed bodies", says why 0 is right for larger meshes.
    #[inline]
    pub(crate) fn rounding(&self, size: f32) -> f32 {
        if self.is_skinned() {
            return self.skin.as_ref().map_or(0.0, |(_, skinning)| skinning.widening());
        }
        // Not measured; it only saves ordinary bodies the pass over the targets.
        const MUCH: f32 = 512.0;
        if size * MUCH > self.model.base_reach() {
            return 0.0;
        }
        max_widening(self.model, self.weights)
    }

    /// Places the body, or returns the cached result if it has not moved: several queries per frame ask for the same.
    pub(crate) fn placed_body(&mut self) -> &PlacedBody {
        if !self.placed_body.is_at(self.world_from_model) {
            let world_from_model = self.world_from_model;
            let bounds = self.bounds();
            let magnitude = bounds.magnitude().as_dvec3();
            let placed = match &self.skin {
                None => PlacedBounds::new(world_from_model, magnitude),
                Some((_, skinning)) => PlacedBounds::with_error(world_from_model, magnitude, skinning.error()),
            };
            let (size, linear) = (bounds.size().as_dvec3(), world_from_model.linear());
            let sides = [linear.x_axis * size.x, linear.y_axis * size.y, linear.z_axis * size.z];
            let rounding = f64::from(self.rounding(bounds.size().max_element()));
            *self.placed_body = PlacedBody {
                is_current: true,
                root: self.topology.group(0).child(0),
                bounds,
                size: sides.iter().fold(0.0, |size, side| side.abs().max_element().max(size)),
                slack: placed.error() + rounding * world_from_model.scale(),
                placed,
            };
        }
        self.placed_body
    }
}
