//! Surfaces that the game puts somewhere else.

use bevy::ecs::component::Mutable;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;

use super::follow::Following;
use crate::body::{MorphColliderOf, body_of};
use crate::continuous::{MorphTeleported, with_descendants};

/// A surface in the physics of one engine.
pub(crate) trait PhysicsSurface: Component<Mutability = Mutable> {
    /// Where it is and was.
    fn following(&mut self) -> &mut Following;
}

/// Notices a [`MorphTeleported`] as soon as it is inserted. The collision run removes it, at a time that has nothing to do with
/// the steps of physics.
pub(crate) fn put_elsewhere<S: PhysicsSurface>(
    marked: On<Insert<MorphTeleported>>,
    mut surfaces: Query<(Entity, &mut S, Option<&MorphColliderOf>), Allow<Disabled>>,
    children: Query<&'static Children>,
) {
    let elsewhere = with_descendants(marked.entity, &children);
    for (entity, mut surface, of) in &mut surfaces {
        if elsewhere.contains(&entity) || elsewhere.contains(&body_of(entity, of)) {
            surface.following().drawn.put();
        }
    }
}
