//! Scenes whose meshes take part in physics automatically.

use bevy::prelude::*;

use super::MorphRapierCollider;
use crate::components::MorphColliderScene;
use crate::physics::scene::{PhysicsScene, passive};

/// Gives every part of a [`MorphColliderScene`] a [`MorphRapierCollider`]. Put it on the root of the scene.
///
/// The [`MorphColliderScene`] decides which meshes are parts: all that deform, or those with certain names. If you do not add one
/// yourself, a default one is added whose parts are [`Passive`](crate::MorphCollisionMode::Passive), so that only physics uses
/// them. Meshes that appear later are found too.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
///     let scene = assets.load("jellyfish.glb#Scene0");
///     commands.spawn((WorldAssetRoot(scene), MorphRapierScene::default()));
/// }
/// # App::new().add_systems(Startup, spawn);
/// ```
///
/// You can edit it at any time; parts whose collider you did not change follow. If a part already had a [`MorphRapierCollider`],
/// it stays yours. The other colliders are removed when you remove this component or when a mesh stops being a part.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphColliderScene = passive())]
pub struct MorphRapierScene {
    /// The collider of each part.
    pub collider: MorphRapierCollider,
}

impl PhysicsScene for MorphRapierScene {
    type Collider = MorphRapierCollider;

    fn collider(&self) -> MorphRapierCollider {
        self.collider
    }
}
