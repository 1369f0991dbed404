//! Surfaces that the game puts somewhere else.

use bevy::ecs::component::Mutable;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;

use super::follow::Following;
use crate::components::{MorphColliders, MorphTeleported, with_descendants};

/// A surface in the physics of one engine.
pub(crate) trait PhysicsSurface: Component<Mutability = Mutable> {
    /// Where it is and was.
    fn following(&mut self) -> &mut Following;
}

/// Notices a [`MorphTeleported`] as soon as it is inserted. The collision run removes it, at a time that has nothing to do with
/// the steps of physics.
pub(crate) fn put_elsewhere<S: PhysicsSurface>(
    marked: On<Insert<MorphTeleported>>,
    mut surfaces: Query<&mut S, Allow<Disabled>>,
    bodies: Query<&MorphColliders, Allow<Disabled>>,
    children: Query<&'static Children>,
) {
    for entity in with_descendants(marked.entity, &children) {
        let colliders = bodies.get(entity).into_iter().flat_map(RelationshipTarget::iter);
        for surface in std::iter::once(entity).chain(colliders) {
            if let Ok(mut surface) = surfaces.get_mut(surface) {
                surface.following().drawn.put();
            }
        }
    }
}
