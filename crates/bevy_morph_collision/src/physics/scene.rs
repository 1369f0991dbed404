//! Scenes whose parts take part in physics automatically: one component on the root, for any engine.

use bevy::ecs::component::Mutable;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;

use crate::components::{MorphCollider, MorphColliderScene, MorphCollisionMode};
use crate::setup::ScenePart;

/// A component on the root of a scene that adds each part to the physics of one engine.
pub(crate) trait PhysicsScene: Component {
    /// The component that adds a mesh to physics.
    type Collider: Component<Mutability = Mutable> + Copy + PartialEq;

    /// The collider of each part.
    fn collider(&self) -> Self::Collider;
}

/// A scene whose parts only physics uses.
pub(crate) fn passive() -> MorphColliderScene {
    MorphColliderScene {
        collider: MorphCollider::new(MorphCollisionMode::Passive),
        ..default()
    }
}

/// What a scene gave to one of its parts.
#[derive(Component)]
pub(crate) struct Given<C: Component>(C);

/// Gives the parts of scenes the collider of their scene, and removes it from entities that are no longer parts.
pub(crate) fn give_to_parts<S: PhysicsScene>(
    mut commands: Commands,
    mut parts: Query<
        (
            Entity,
            Option<&ScenePart>,
            Option<&mut S::Collider>,
            Option<&mut Given<S::Collider>>,
        ),
        (Or<(With<ScenePart>, With<Given<S::Collider>>)>, Allow<Disabled>),
    >,
    scenes: Query<&S, Allow<Disabled>>,
) {
    for (entity, part, collider, given) in &mut parts {
        let scene = part.and_then(|part| scenes.get(part.root).ok());
        match (scene.map(S::collider), given) {
            (Some(wanted), None) => {
                if collider.is_none() {
                    commands.entity(entity).try_insert((wanted, Given(wanted)));
                }
            }
            (Some(wanted), Some(mut given)) => {
                if given.0 != wanted {
                    let unchanged = collider.filter(|collider| **collider == given.0);
                    if let Some(mut collider) = unchanged {
                        *collider = wanted;
                    }
                    given.0 = wanted;
                }
            }
            (None, Some(_)) => {
                commands
                    .entity(entity)
                    .try_remove::<(S::Collider, Given<S::Collider>)>();
            }
            (None, None) => {}
        }
    }
}
