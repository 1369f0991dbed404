//! What needs contacts of surfaces besides the bodies that they push.

use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::rapier::dynamics::RigidBody;
use bevy_rapier3d::rapier::geometry::{ActiveCollisionTypes, Collider};
use bevy_rapier3d::rapier::pipeline::ActiveEvents;

use super::world::World;

/// Everything that needs contacts of surfaces even without movers nearby.
pub(crate) struct ContactListeners {
    /// Where colliders with hooks, which receive entities, may be when Rapier looks for pairs.
    hooked: Vec<Aabb>,
    /// Whether Rapier looks for pairs only once.
    once: bool,
    /// Whether there are colliders on no dynamic body that want events, or soft bodies, which collide with the surface as a
    /// whole.
    pub(crate) listens: bool,
}

impl ContactListeners {
    /// `once` says whether Rapier does a single step without substeps.
    pub(crate) fn of(world: &World, margin: f32, once: bool) -> Self {
        let body = |collider: &Collider| collider.parent().and_then(|body| world.bodies.get(body));
        let listens = |collider: &Collider| {
            collider.active_events().contains(ActiveEvents::COLLISION_EVENTS)
                && !collider
                    .active_collision_types()
                    .difference(ActiveCollisionTypes::default())
                    .is_empty()
                && !body(collider).is_some_and(RigidBody::is_dynamic)
        };
        let whereabouts = |collider: &Collider| {
            let Some(body) = body(collider) else {
                return collider.compute_aabb();
            };
            // If the game moved the body, its colliders follow only in the step.
            let in_body = collider.position_wrt_parent().copied().unwrap_or_default();
            let at = |isometry| collider.shape().compute_aabb(&(isometry * in_body));
            at(*body.position())
                .merged(&at(*body.next_position()))
                .loosened(body.soft_ccd_prediction())
        };
        let hooked = world.colliders.iter().map(|(_, collider)| collider);
        let hooked = hooked.filter(|collider| !collider.active_hooks().is_empty());
        Self {
            hooked: hooked
                .map(|collider| whereabouts(collider).loosened(margin + collider.contact_skin()))
                .collect(),
            once,
            listens: !world.soft_bodies.is_empty() || world.colliders.iter().any(|(_, collider)| listens(collider)),
        }
    }

    /// Whether a hook may be called for something in a box.
    pub(crate) fn hooks_near(&self, bounds: &Aabb) -> bool {
        let mut hooked = self.hooked.iter();
        // In later substeps, anything may be anywhere.
        hooked.any(|hooked| !self.once || hooked.intersects(bounds))
    }
}
