//! The pairs of triangles that intersect at rest.

use std::sync::Arc;

use bevy::math::Affine3A;
use bevy::platform::collections::HashMap;
use morph_collision::{JointMatrices, MorphBvh, Pose, SelfQuery, TrianglePair};

/// The maximum number of pairs that are remembered as intersecting at rest.
const MAX_REST_PAIRS: usize = 1 << 20;

/// The pairs of triangles that intersect at rest, for each tree, sorted.
#[derive(Default)]
pub(crate) struct RestPairs(pub(super) HashMap<usize, (Arc<MorphBvh>, Arc<[TrianglePair]>)>);

impl RestPairs {
    pub(super) fn of(&mut self, tree: &Arc<MorphBvh>) -> Arc<[TrianglePair]> {
        // The tree is kept, so no other one gets its address.
        let (_, pairs) = self.0.entry(Arc::as_ptr(tree).addr()).or_insert_with(|| {
            let mut pose = Pose::new(tree.clone());
            let bound = vec![Affine3A::IDENTITY; tree.model().joint_count().unwrap_or(0)];
            if let Ok(bound) = JointMatrices::new(&bound) {
                let _is_rigid = pose.set_joints(&bound);
            }
            let mut pairs = Vec::new();
            // A mesh that is collapsed at rest would list the square of its triangles.
            SelfQuery::new().up_to(&mut pose, MAX_REST_PAIRS, &mut pairs);
            pairs.sort_unstable();
            (tree.clone(), pairs.into())
        });
        pairs.clone()
    }

    /// Drops those of trees that nothing else uses.
    pub(super) fn drop_unused(&mut self) {
        self.0.retain(|_, (tree, _)| Arc::strong_count(tree) > 1);
    }
}
