//! Whether the trees and the boxes of drawn meshes may have to change.

use bevy::camera::primitives::Aabb;
use bevy::ecs::system::{SystemChangeTick, SystemParam};
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use super::culled::Culled;
use crate::app::{Rows, any_changed, has, ran_long_ago};
use crate::import::MorphTrees;
use crate::posing::SharedWeightChanges;

/// Whether meshes may need other trees since the system last ran.
#[derive(SystemParam)]
pub(super) struct TreeChanges<'w, 's> {
    meshes: Query<'w, 's, (Entity, Ref<'static, Mesh3d>, Option<Ref<'static, SkinnedMesh>>), Culled>,
    rows: Local<'s, Rows>,
    version: Local<'s, u64>,
    ticks: SystemChangeTick,
}

impl TreeChanges<'_, '_> {
    pub(super) fn any(&mut self, trees: &MorphTrees) -> bool {
        let (Ok(mut meshes), Ok(lists)) = (self.meshes.contiguous_iter(), self.meshes.contiguous_iter()) else {
            return true;
        };
        let is_same = self
            .rows
            .replace(lists.map(|(entities, _, skin)| (entities, has([skin.is_some()]))));
        let is_other_version = std::mem::replace(&mut *self.version, trees.version()) != trees.version();
        !is_same
            || is_other_version
            || trees.is_stale()
            || ran_long_ago(&self.ticks)
            || meshes.any(|(_, mesh, skin)| any_changed(Some(&mesh)) || any_changed(skin.as_ref()))
    }
}

/// What determines the tree of a mesh, and its box, which others may overwrite.
type Drawn = (
    Entity,
    Ref<'static, Mesh3d>,
    Ref<'static, Aabb>,
    Option<Ref<'static, MeshMorphWeights>>,
    Option<Ref<'static, SkinnedMesh>>,
);

/// Whether boxes of meshes without joints may have to change since the system last ran. Joints are other entities, and not looked at here.
#[derive(SystemParam)]
pub(super) struct BoundsChanges<'w, 's> {
    meshes: Query<'w, 's, Drawn, Culled>,
    shared: SharedWeightChanges<'w, 's>,
    rows: Local<'s, Rows>,
    /// The version of the trees, if none was being built.
    version: Local<'s, Option<u64>>,
}

impl BoundsChanges<'_, '_> {
    /// Always true while trees are being built.
    pub(super) fn any(&mut self, trees: &MorphTrees) -> bool {
        let are_shared_new = self.shared.any();
        let (Ok(mut meshes), Ok(lists)) = (self.meshes.contiguous_iter(), self.meshes.contiguous_iter()) else {
            return true;
        };
        let lists = lists.map(|(entities, _, _, weights, skin)| (entities, has([weights.is_some(), skin.is_some()])));
        let is_same = self.rows.replace(lists);
        let version = (trees.building() == 0).then(|| trees.version());
        let is_other_version = std::mem::replace(&mut *self.version, version) != version || version.is_none();
        !is_same
            || is_other_version
            || are_shared_new
            || meshes.any(|(_, mesh, aabb, weights, skin)| {
                let is_new = any_changed(Some(&mesh)) || any_changed(Some(&aabb)) || any_changed(weights.as_ref());
                skin.is_none() && is_new
            })
    }
}
