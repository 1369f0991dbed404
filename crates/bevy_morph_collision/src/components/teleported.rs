//! Says that an entity was put somewhere else.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;

/// Says that an entity was put somewhere else: it has not moved through what is in between.
///
/// - [Continuous](crate::components::MorphCollider::continuous) colliders do not sweep through everything in between.
/// - In physics (`MorphPhysicsCollider`), a surface pushes out what it overlaps at its new place, but throws and
///   carries nothing.
///
/// Insert it in the frame in which you move the entity:
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// # fn respawn(mut commands: Commands, player: Single<Entity, With<MorphCollider>>) {
/// commands.entity(*player).insert((Transform::from_xyz(0.0, 5.0, 0.0), MorphTeleported));
/// # }
/// # App::new().add_systems(Update, respawn);
/// ```
///
/// It counts for the colliders on the entity and on its descendants, and for colliders whose [body](crate::components::MorphColliderOf) one of
/// these is. In the next run, their pairs are only compared where they are then, and the plugin removes the component.
///
/// Physics notices the insertion, so it does not matter when the component is removed, nor whether collision detection is paused
/// or runs in another schedule. For a surface, the component also covers a change of weights or joints in the same frame.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphTeleported;

/// An entity with all its descendants.
pub(crate) fn with_descendants(entity: Entity, children: &Query<&'static Children>) -> EntityHashSet {
    let mut all = EntityHashSet::default();
    all.insert(entity);
    all.extend(children.iter_descendants(entity));
    all
}
