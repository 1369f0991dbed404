//! Where the weights, joints and names of surfaces come from.

use bevy::ecs::system::SystemParam;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use super::drawn::Live;
use super::follow::Following;
use crate::posing::{BindPoses, Skeletons};

/// What a surface is drawn with, as components.
type Shown<'a> = (
    &'a GlobalTransform,
    Option<&'a MeshMorphWeights>,
    Option<&'a SkinnedMesh>,
);

/// Where the weights, joints and names of surfaces come from.
#[derive(SystemParam)]
pub(crate) struct Sources<'w, 's> {
    pub(crate) shared: Query<'w, 's, &'static MorphWeights>,
    pub(crate) globals: Query<'w, 's, &'static GlobalTransform>,
    pub(crate) bind_poses: Option<Res<'w, BindPoses>>,
    pub(crate) skeletons: Local<'s, Skeletons>,
    pub(crate) names: Query<'w, 's, NameOrEntity>,
}

impl Sources<'_, '_> {
    /// What a surface is drawn with now.
    pub(crate) fn live(&mut self, following: &Following, place: &GlobalTransform, skin: Option<&SkinnedMesh>) -> Live {
        let skin = skin.filter(|_| following.is_skinned());
        let bind_poses = self.bind_poses.as_deref();
        let drawn = &following.drawn;
        drawn.live(place, skin, &mut self.skeletons, bind_poses, &self.globals)
    }

    /// Records what a frame is drawn with, at a time of the clock of physics.
    pub(crate) fn record(&mut self, following: &mut Following, (place, weights, skin): Shown, time: f64) {
        let live = self.live(following, place, skin);
        following.record(time, &live, (weights, &self.shared));
    }

    /// Lets a surface notice what changes while no steps come.
    pub(crate) fn rest(&mut self, following: &mut Following, (place, weights, skin): Shown) {
        let live = self.live(following, place, skin);
        following.rest(&live, (weights, &self.shared));
    }

    #[cfg(feature = "rapier")]
    pub(crate) fn name(&self, entity: Entity) -> String {
        self.names.get(entity).map(|name| name.to_string()).unwrap_or_default()
    }
}
