//! Meshes that Bevy could not load count as failed.

use bevy::prelude::*;

use super::complaints::Complaints;
use super::error::ImportError;
use super::mesh_tree::MeshTree;
use super::tree_key::TreeKey;
use super::trees::MorphTrees;

/// The trees whose meshes could not be loaded.
#[derive(Resource, Default)]
pub(crate) struct LoadFailures(Vec<TreeKey>);

/// Whether a mesh is waited for, or could not be loaded.
pub(crate) fn any_may_fail(trees: Res<MorphTrees>, failures: Res<LoadFailures>) -> bool {
    !trees.waiting.is_empty() || !failures.0.is_empty()
}

/// Gives up on requested meshes that cannot be loaded, and takes up again those that were loaded after all, such as on a second try.
pub(crate) fn update_load_failures(
    mut trees: ResMut<MorphTrees>,
    mut failures: ResMut<LoadFailures>,
    meshes: Res<Assets<Mesh>>,
    complaints: Complaints,
) {
    let MorphTrees {
        of_mesh,
        waiting,
        stale,
        ..
    } = trees.bypass_change_detection();
    failures.0.retain(|key| {
        let is_loaded = meshes.contains(key.mesh);
        if is_loaded {
            of_mesh.remove(key);
            *stale = true;
        }
        !is_loaded && of_mesh.contains_key(key)
    });
    waiting.retain(|&(key, asked_by)| {
        let Some(error) = complaints.names.load_error(key.mesh).map(ImportError::NotLoaded) else {
            return true;
        };
        let mut entry = MeshTree::new(asked_by);
        entry.fail(key.mesh, error, &complaints);
        of_mesh.insert(key, entry);
        failures.0.push(key);
        false
    });
}
