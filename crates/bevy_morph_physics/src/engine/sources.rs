//! Where the weights, joints and names of surfaces come from.

use bevy::ecs::system::SystemParam;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::physics_api::CurrentSkeletons;
use morph_collision::JointMatrices;

use crate::moving::MovingSurface;
use crate::time::{Live, SurfaceComponentsItem, WeightSource};

/// Where the weights, joints and names of surfaces come from.
#[derive(SystemParam)]
pub struct Sources<'w, 's> {
    shared: Query<'w, 's, &'static MorphWeights>,
    /// The skeletons of the surfaces.
    pub skeletons: CurrentSkeletons<'w, 's>,
    names: Query<'w, 's, NameOrEntity>,
}

impl Sources<'_, '_> {
    /// The weights of a mesh.
    pub fn weights<'a>(&'a self, component: Option<&'a MeshMorphWeights>) -> WeightSource<'a> {
        WeightSource {
            component,
            shared: &self.shared,
        }
    }

    /// What a surface is drawn with now.
    pub fn live(
        &mut self,
        moving: &mut MovingSurface,
        transform: &GlobalTransform,
        skin: Option<&SkinnedMesh>,
    ) -> Live {
        let skin = skin.filter(|_| moving.is_skinned());
        moving.drawn.live(transform, skin, &mut self.skeletons)
    }

    /// The joints of a skinned mesh, in world space, while all of them are valid.
    pub fn world_from_joints(&mut self, skin: &SkinnedMesh) -> Option<&JointMatrices> {
        self.skeletons.of(skin).current_matrices()
    }

    /// Records what a frame is drawn with, at a time of the clock of physics.
    pub fn record(&mut self, moving: &mut MovingSurface, components: &SurfaceComponentsItem, time: f64) {
        let live = self.live(moving, components.transform, components.skin);
        moving.record(time, &live, &self.weights(components.weights));
    }

    /// Lets a surface notice what changes while no steps come.
    pub fn rest(&mut self, moving: &mut MovingSurface, components: &SurfaceComponentsItem) {
        let live = self.live(moving, components.transform, components.skin);
        moving.rest(&live, &self.weights(components.weights));
    }

    /// What messages call an entity.
    pub fn name(&self, entity: Entity) -> String {
        self.names.get(entity).map(|name| name.to_string()).unwrap_or_default()
    }
}
