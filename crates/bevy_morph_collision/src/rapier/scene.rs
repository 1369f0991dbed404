//! Scenes whose meshes come into physics by themselves.

use bevy::prelude::*;

use super::MorphRapierCollider;
use crate::physics::scene::{PhysicsScene, passive};
use crate::scene::MorphColliderScene;

/// Put this on the root of a scene: every part of its [`MorphColliderScene`] is in physics, with a [`MorphRapierCollider`].
///
/// Which meshes those are, that component says: all that deform, or those with certain names. Without one of your own there is one whose parts are
/// [`Passive`](crate::MorphCollisionMode::Passive): physics alone looks at them. Meshes that come later are found too.
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
/// Edit it at any time: parts whose collider you did not change follow. A [`MorphRapierCollider`] that was on a part before stays yours. Removing
/// the component, or whatever makes a mesh no part any more, takes the others out of physics.
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
