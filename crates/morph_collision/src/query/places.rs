//! What a query of two bodies begins with.

use super::neighbourhood::Neighbourhood;
use super::pairs::SeparatingAxes;
use super::patches::Patches;
use crate::bounds::{Volume, WorldFromModel, are_below_resolution, visit_frames};
use crate::traverse::{CrossCull, Culls, Walkable};

/// Where the two bodies of a query stand.
pub(super) struct Places<'a> {
    pub(super) world_from_a: &'a WorldFromModel,
    pub(super) world_from_b: &'a WorldFromModel,
}

impl Places<'_> {
    /// Prepares what compares nodes. Says whether the roots may meet, and gives the further axes if they are wanted and there
    /// are any.
    pub(super) fn begin_culls<V: Volume, T: Walkable<Kind = V>>(
        &self,
        a: &mut T,
        b: &mut T,
        axes: SeparatingAxes,
        culls: &mut Culls<V>,
    ) -> (bool, Option<CrossCull>) {
        let (root_a, root_b) = (a.root(), b.root());
        let (root_a, root_b) = (a.volume(root_a), b.volume(root_b));
        let (bounds_a, bounds_b) = (V::bounds(&root_a), V::bounds(&root_b));
        let (mut roots_meet, mut cross) = (true, None);
        culls.begin();
        visit_frames(self.world_from_a, &bounds_a, self.world_from_b, &bounds_b, |frames| {
            // One that parts the bodies is enough.
            roots_meet = culls.push(frames, &root_a, &root_b);
            if roots_meet && axes == SeparatingAxes::Full && cross.is_none() {
                cross = CrossCull::new(frames, &bounds_a, &bounds_b);
            }
            roots_meet
        });
        (roots_meet, cross)
    }

    /// Whether both bodies are too small for where they stand, or for how far they are posed from their rest, to be culled.
    pub(super) fn are_collapsed<T: Walkable>(&self, a: &mut T, b: &mut T) -> bool {
        let bounds = |tree: &mut T| {
            let root = tree.root();
            let bounds = T::Kind::bounds(&tree.volume(root));
            let rounding = f64::from(tree.rounding(bounds.size().max_element()));
            (bounds, rounding)
        };
        let [(bounds_a, rounding_a), (bounds_b, rounding_b)] = [bounds(a), bounds(b)];
        are_below_resolution([
            (self.world_from_a, &bounds_a, rounding_a),
            (self.world_from_b, &bounds_b, rounding_b),
        ])
    }

    /// Prepares what reads leaves.
    pub(super) fn begin_leaves<T: Walkable>(&self, a: &mut T, b: &mut T, [leaves_a, leaves_b]: [&mut Patches; 2]) {
        let root = a.root();
        let bounds = T::Kind::bounds(&a.volume(root));
        // Near both bodies when they touch.
        let size = self.world_from_a.scale() * f64::from(bounds.size().max_element());
        let neighbourhood = Neighbourhood::new(self.world_from_a.translation(), size);
        leaves_a.begin(a.topology().leaf_count(), self.world_from_a, neighbourhood);
        leaves_b.begin(b.topology().leaf_count(), self.world_from_b, neighbourhood);
    }

    pub(super) fn a_from_b_scale(&self) -> f32 {
        (self.world_from_b.scale() / self.world_from_a.scale()) as f32
    }
}
