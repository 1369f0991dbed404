//! Bodies: entities that group several colliders.

use bevy::prelude::*;

/// The body that a collider is part of: any entity, usually the root of its scene.
///
/// Colliders of one body never collide with each other. [`MorphBodyCollisionStart`](crate::events::MorphBodyCollisionStart) and
/// [`MorphBodyCollisionEnd`](crate::events::MorphBodyCollisionEnd) report bodies instead of their colliders. A collider without this
/// component is a body of its own.
///
/// This is a Bevy relationship: the body lists its colliders in [`MorphColliders`]. When the body is despawned or loses that
/// component, its colliders become bodies of their own. A collider cannot name itself. Bodies do not nest: if a body is itself
/// part of another body, that has no effect on its colliders.
///
/// The reflected default names [`Entity::PLACEHOLDER`], which does not exist: Bevy logs a warning and removes the component.
#[derive(Component, FromTemplate, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, FromWorld, Default, Clone, PartialEq)]
#[relationship(relationship_target = MorphColliders)]
pub struct MorphColliderOf {
    /// The body.
    #[entities]
    pub body: Entity,
}

impl Default for MorphColliderOf {
    fn default() -> Self {
        Self {
            body: Entity::PLACEHOLDER,
        }
    }
}

/// The colliders of a body, in the order in which they joined.
///
/// Bevy adds, updates and removes this component when [`MorphColliderOf`] changes on the colliders. Despawning the body does not
/// despawn its colliders.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[relationship_target(relationship = MorphColliderOf)]
pub struct MorphColliders(#[entities] Vec<Entity>);

impl std::ops::Deref for MorphColliders {
    type Target = [Entity];

    fn deref(&self) -> &[Entity] {
        &self.0
    }
}

/// Makes an entity the body of the colliders below it that come from
/// [`every_deforming_mesh`](crate::components::MorphCollisionSettings::every_deforming_mesh).
///
/// Put it on the characters of a level that is a single glTF file or built by hand. It has no effect on colliders created by you
/// or by a [`MorphColliderScene`](crate::components::MorphColliderScene): their [`MorphColliderOf`] names their body.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphBodyRoot;

/// The body of a collider.
pub(crate) fn body_of(collider: Entity, of: Option<&MorphColliderOf>) -> Entity {
    of.map_or(collider, |of| of.body)
}

/// Makes a collider part of a body. If the body is the collider itself, it becomes a body of its own.
pub(crate) fn give_body(collider: &mut EntityCommands, body: Entity) {
    if body == collider.id() {
        collider.try_remove::<MorphColliderOf>();
    } else {
        collider.try_insert(MorphColliderOf { body });
    }
}
