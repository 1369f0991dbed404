//! Triangles in the order of their tree, in which neighbours are near each other.

use std::sync::{Arc, Weak};

use bevy::prelude::Resource;
use morph_collision::MorphBvh;

/// Where each triangle stands in the order of its tree; shared by all that show the mesh.
pub(super) type TreeOrder = Vec<u32>;

/// The orders of all trees that are in use.
#[derive(Resource, Default)]
pub(super) struct TreeOrders(Vec<(Weak<MorphBvh>, Weak<TreeOrder>)>);

impl TreeOrders {
    pub(super) fn of(&mut self, bvh: &Arc<MorphBvh>) -> Arc<TreeOrder> {
        self.0.retain(|(_, order)| order.strong_count() > 0);
        let known = self.0.iter().find(|(of, _)| of.as_ptr() == Arc::as_ptr(bvh));
        if let Some(order) = known.and_then(|(_, order)| order.upgrade()) {
            return order;
        }
        let mut order = vec![0; bvh.model().triangle_count()];
        let triangles = bvh.subtrees(usize::MAX).into_iter().flatten();
        for (place, &triangle) in (0..).zip(triangles) {
            order[triangle as usize] = place;
        }
        let order = Arc::new(order);
        self.0.push((Arc::downgrade(bvh), Arc::downgrade(&order)));
        order
    }
}
