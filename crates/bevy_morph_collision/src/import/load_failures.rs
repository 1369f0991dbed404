//! Meshes that Bevy could not load count as failed.

use bevy::prelude::*;

use super::complaints::Complaints;
use super::mesh_tree::MeshTree;
use super::tree_key::TreeKey;
use super::trees::MorphTrees;

/// Gives up on requested meshes that cannot be loaded, and takes up again those that were loaded after all, such as on a second try.
///
/// Costs nothing unless a mesh is waited for or has failed to load.
pub(crate) fn follow_load_failures(
    mut trees: ResMut<MorphTrees>,
    meshes: Res<Assets<Mesh>>,
    complaints: Complaints,
    mut failed: Local<Vec<TreeKey>>,
) {
    if trees.waiting.is_empty() && failed.is_empty() {
        return;
    }
    let MorphTrees {
        of_mesh,
        waiting,
        stale,
        ..
    } = trees.bypass_change_detection();
    failed.retain(|key| {
        let is_loaded = meshes.contains(key.mesh);
        if is_loaded {
            of_mesh.remove(key);
            *stale = true;
        }
        !is_loaded && of_mesh.contains_key(key)
    });
    waiting.retain(|&(key, asked_by)| {
        let Some(error) = complaints.names.load_error(key.mesh) else {
            return true;
        };
        let mut entry = MeshTree::new(asked_by);
        entry.fail(key.mesh, error, &complaints);
        of_mesh.insert(key, entry);
        failed.push(key);
        false
    });
}
