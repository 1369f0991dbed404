//! Questions about the contacts of bodies.

use super::collisions::MorphCollisions;
use super::contact::MorphContact;
use bevy::prelude::*;

/// Bodies are the entities that [`MorphColliderOf`](crate::components::MorphColliderOf) names, and all colliders without that component.
impl MorphCollisions {
    /// Whether any colliders of two bodies touch. The order of the bodies does not matter.
    #[must_use]
    pub fn contains_bodies(&self, a: Entity, b: Entity) -> bool {
        !self.bodies.between(a, b).is_empty()
    }

    /// The contacts between the colliders of two bodies, in ascending order of the colliders. The order of the bodies does not
    /// matter; each contact keeps its own order.
    pub fn collisions_between_bodies(&self, a: Entity, b: Entity) -> impl Iterator<Item = &MorphContact> {
        let colliders = self.bodies.between(a, b).iter().map(|(_, colliders)| colliders);
        colliders.filter_map(|colliders| self.current.get(colliders))
    }

    /// The contacts of all colliders of a body, in ascending order of the colliders. Takes time for these contacts only.
    pub fn collisions_with_body(&self, body: Entity) -> impl Iterator<Item = &MorphContact> {
        let others = self.bodies_colliding_with(body);
        let contacts = others.flat_map(move |other| self.collisions_between_bodies(body, other));
        let mut contacts: Vec<&MorphContact> = contacts.collect();
        contacts.sort_unstable_by_key(|contact| contact.pair());
        contacts.into_iter()
    }

    /// The bodies that touch a body, each once, in ascending order. Takes time for these bodies only.
    pub fn bodies_colliding_with(&self, body: Entity) -> impl Iterator<Item = Entity> {
        self.bodies.with(body)
    }

    /// Groups the contacts by bodies.
    pub(super) fn pair_bodies(&mut self) {
        let passed = self.changes.passed_in_run();
        self.bodies.replace(self.current.values(), passed);
    }
}
