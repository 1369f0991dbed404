//! Scenes whose parts take part in physics automatically.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use bevy_morph_collision::components::{MorphCollider, MorphColliderScene, MorphCollisionMode};
use bevy_morph_collision::physics_api::ScenePart;

use super::collider::MorphPhysicsCollider;
use super::engine_check::check_engine;

/// Gives every part of a [`MorphColliderScene`] a [`MorphPhysicsCollider`]. Put it on the root of the scene.
///
/// The [`MorphColliderScene`] decides which meshes are parts: all that deform, or those with certain names. If you do not add one
/// yourself, a default one is added whose parts are [`Passive`](MorphCollisionMode::Passive), so that only physics uses
/// them. Meshes that appear later are found too.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_physics::prelude::*;
/// fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
///     let scene = assets.load("jellyfish.glb#Scene0");
///     commands.spawn((WorldAssetRoot(scene), MorphPhysicsScene::default()));
/// }
/// # App::new().add_systems(Startup, spawn);
/// ```
///
/// If the root also has a rigid body, all parts are colliders of that body.
///
/// You can edit it at any time; parts whose collider you did not change follow. If a part already had a [`MorphPhysicsCollider`],
/// it stays yours. The other colliders are removed when you remove this component or when a mesh stops being a part.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphColliderScene = passive())]
#[component(on_add = check_engine::<Self>)]
pub struct MorphPhysicsScene {
    /// The collider of each part.
    pub collider: MorphPhysicsCollider,
}

/// A scene whose parts only physics uses.
fn passive() -> MorphColliderScene {
    MorphColliderScene {
        collider: MorphCollider::new(MorphCollisionMode::Passive),
        ..default()
    }
}

/// The collider that a scene gave to one of its parts.
#[derive(Component)]
pub struct FromScene(MorphPhysicsCollider);

/// Gives the parts of scenes the collider of their scene, and removes it from entities that are no longer parts.
pub fn add_to_parts(
    mut commands: Commands,
    mut parts: Query<
        (
            Entity,
            Option<&ScenePart>,
            Option<&mut MorphPhysicsCollider>,
            Option<&mut FromScene>,
        ),
        (Or<(With<ScenePart>, With<FromScene>)>, Allow<Disabled>),
    >,
    scenes: Query<&MorphPhysicsScene, Allow<Disabled>>,
) {
    for (entity, part, collider, from_scene) in &mut parts {
        let scene = part.and_then(|part| scenes.get(part.root).ok());
        match (scene.map(|scene| scene.collider), from_scene) {
            (Some(wanted), None) => {
                if collider.is_none() {
                    commands.entity(entity).try_insert((wanted, FromScene(wanted)));
                }
            }
            (Some(wanted), Some(mut from_scene)) => {
                if from_scene.0 != wanted {
                    let unchanged = collider.filter(|collider| **collider == from_scene.0);
                    if let Some(mut collider) = unchanged {
                        *collider = wanted;
                    }
                    from_scene.0 = wanted;
                }
            }
            (None, Some(_)) => {
                commands
                    .entity(entity)
                    .try_remove::<(MorphPhysicsCollider, FromScene)>();
            }
            (None, None) => {}
        }
    }
}
