//! Surfaces that the game teleports.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use bevy_morph_collision::components::{MorphColliders, MorphTeleported};

use super::interface::Engine;
use super::surface::PhysicsSurface;

/// Notices a [`MorphTeleported`] as soon as it is inserted. The collision run removes it, at a time that has nothing to do with
/// the steps of physics.
pub(super) fn note_teleport<E: Engine>(
    marked: On<Insert<MorphTeleported>>,
    mut surfaces: Query<&mut PhysicsSurface<E>, Allow<Disabled>>,
    bodies: Query<&MorphColliders, Allow<Disabled>>,
    children: Query<&'static Children>,
) {
    let teleported = std::iter::once(marked.entity).chain(children.iter_descendants(marked.entity));
    for entity in teleported {
        let colliders = bodies.get(entity).into_iter().flat_map(RelationshipTarget::iter);
        for surface in std::iter::once(entity).chain(colliders) {
            if let Ok(mut surface) = surfaces.get_mut(surface) {
                surface.moving.drawn.teleport();
            }
        }
    }
}
