//! Poses all vertices side by side and fits all boxes to them, in one pass over the tree.

use fearless_simd::Simd;

use super::posed::Posed;
use crate::bounds::with_simd;

impl Posed<'_> {
    /// Replaces all cached boxes with tight ones. Vertices that are posed already are not posed again. Cost: `O(n)`.
    pub(super) fn refit(&mut self) {
        self.boxes.next_epoch();
        with_simd!(self.level, simd => self.fit_all(simd));
    }

    #[inline(always)]
    fn fit_all<S: Simd>(&mut self, simd: S) {
        let (topology, tree) = (self.topology, self.skin_tree());
        let (vertices, widening) = match (tree, &mut self.skin) {
            (Some(tree), Some((_, skinning))) => {
                self.blended.vertices += skinning.pose_all(simd, tree);
                (skinning.vertices.local(), skinning.widening())
            }
            _ => {
                self.blended.vertices += self.vertices.blend_all(simd, self.model, self.weights);
                (self.vertices.points(), 0.0)
            }
        };
        self.blended.volumes += topology.node_count() as u64;
        let groups = 0..topology.group_count();
        self.fitted.fit(simd, topology, groups, vertices, widening, self.boxes);
    }
}
