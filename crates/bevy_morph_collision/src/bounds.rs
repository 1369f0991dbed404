//! Culling: the [`Aabb`] of morphing meshes.

use bevy::app::AnimationSystems;
use bevy::asset::AssetEventSystems;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{NoAutoAabb, NoFrustumCulling, VisibilitySystems, calculate_bounds};
use bevy::ecs::entity::EntityHashMap;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use morph_collision::{MorphBvh, Pose};
use std::sync::Arc;

use crate::import::{MorphTrees, TreeKey};
use crate::plugin::TreesPlugin;

/// Keeps the [`Aabb`] of morphing meshes around what is drawn, every frame: Bevy itself keeps that of the rest pose, so that
/// meshes vanish at the edge of the screen.
///
/// Works with or without [`MorphCollisionPlugin`](crate::MorphCollisionPlugin), for every mesh with [`MeshMorphWeights`],
/// whether it collides or not. A box is conservative, from the blended root of the mesh's tree, in `O(active targets)` per
/// mesh; it is written only where it differs. Bevy's opt-outs are heeded: [`NoAutoAabb`] and [`NoFrustumCulling`]. Skinned meshes are
/// left to Bevy, as their bones move them out of any box of ours. Until the tree of a mesh is built it keeps the box that Bevy gave it.
///
/// It also repairs what Bevy 0.20 draws in its rest pose: a morphing mesh that comes into view for the first time since it was
/// loaded, until something else about it changes.
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphBoundsPlugin;

/// Where [`MorphBoundsPlugin`] works, in [`PostUpdate`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MorphBoundsSystems {
    /// After Bevy has calculated bounds, before it looks what is visible.
    Bounds,
    /// After Bevy has looked what is visible.
    Redraw,
}

impl Plugin for MorphBoundsPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<TreesPlugin>() {
            app.add_plugins(TreesPlugin);
        }
        app.configure_sets(
            PostUpdate,
            (
                MorphBoundsSystems::Bounds
                    .in_set(VisibilitySystems::CalculateBounds)
                    .after(calculate_bounds)
                    .after(AnimationSystems)
                    .after(AssetEventSystems)
                    .after(crate::MorphCollisionSystems::Import)
                    .before(VisibilitySystems::CheckVisibility),
                MorphBoundsSystems::Redraw.after(VisibilitySystems::MarkNewlyHiddenEntitiesInvisible),
            ),
        )
        .add_observer(forget_morphed_bounds)
        .add_systems(
            PostUpdate,
            (
                request_trees_to_cull
                    .in_set(crate::MorphCollisionSystems::Import)
                    .after(crate::import::follow_asset_events)
                    .before(crate::import::start_trees)
                    .ambiguous_with(crate::import::request_trees),
                update_bounds.in_set(MorphBoundsSystems::Bounds),
                draw_again.in_set(MorphBoundsSystems::Redraw),
            ),
        );
    }
}

/// Meshes whose bounds are ours.
type Culled = (
    With<MeshMorphWeights>,
    Without<NoAutoAabb>,
    Without<NoFrustumCulling>,
    Without<SkinnedMesh>,
);

fn request_trees_to_cull(
    anew: Query<(Entity, &Mesh3d), (Culled, Or<(Changed<Mesh3d>, Added<MeshMorphWeights>)>)>,
    all: Query<(Entity, &Mesh3d), Culled>,
    mut trees: ResMut<MorphTrees>,
) {
    if trees.is_stale() {
        all.iter()
            .for_each(|(entity, mesh)| trees.request((mesh.id(), None), entity));
    } else if !anew.is_empty() {
        anew.iter()
            .for_each(|(entity, mesh)| trees.request((mesh.id(), None), entity));
    }
}

/// A pose for each mesh, lent to all entities that show it.
type Poses = HashMap<TreeKey, Pose>;

/// Gives morphing meshes a box around what they are drawn as.
fn update_bounds(
    mut meshes: Query<(&Mesh3d, &MeshMorphWeights, &mut Aabb), Culled>,
    shared: Query<&MorphWeights>,
    trees: Res<MorphTrees>,
    mut poses: Local<Poses>,
) {
    poses.retain(|&(mesh, settings), _| trees.with_settings(mesh, settings).is_some());
    for (mesh, weights, mut aabb) in &mut meshes {
        let key = (mesh.id(), None);
        let Some(tree) = trees.up_to_date(key) else {
            continue;
        };
        let weights = match weights {
            MeshMorphWeights::Value { weights } => weights.as_slice(),
            &MeshMorphWeights::Reference(source) => match shared.get(source) {
                Ok(weights) => weights.weights(),
                Err(_) => continue,
            },
        };
        let pose = current(&mut poses, key, tree);
        if pose.set_weights(weights).is_err() {
            // What is drawn then is anyone's guess.
            continue;
        }
        let bounds = pose.bounds();
        // Bevy's middle and half size round, so they get a little more.
        let slack = 1e-6 * bounds.min.abs().max(bounds.max.abs());
        let wanted = Aabb::from_min_max(bounds.min - slack, bounds.max + slack);
        if *aabb != wanted {
            *aabb = wanted;
        }
    }
}

fn current<'a>(poses: &'a mut Poses, key: TreeKey, tree: &Arc<MorphBvh>) -> &'a mut Pose {
    let pose = poses.entry(key).or_insert_with(|| Pose::new(tree.clone()));
    if !Arc::ptr_eq(pose.bvh(), tree) {
        *pose = Pose::new(tree.clone());
    }
    pose
}

/// Without weights a mesh is drawn at rest: Bevy calculates its box again.
fn forget_morphed_bounds(
    removed: On<Remove<MeshMorphWeights>>,
    culled: Query<(), (With<Mesh3d>, Without<NoAutoAabb>, Without<NoFrustumCulling>)>,
    mut commands: Commands,
) {
    if culled.contains(removed.entity) {
        commands.entity(removed.entity).try_remove::<Aabb>();
    }
}

/// Flags morphing meshes that came into view for two more frames, so that Bevy takes over their weights.
fn draw_again(
    mut meshes: Query<(Entity, &ViewVisibility, &mut Aabb), With<MeshMorphWeights>>,
    came: Query<Entity, (With<MeshMorphWeights>, Changed<ViewVisibility>)>,
    mut left: Local<EntityHashMap<u8>>,
) {
    const FRAMES: u8 = 2;
    for entity in &came {
        left.insert(entity, FRAMES);
    }
    left.retain(|&entity, frames| {
        let Ok((_, visible, mut aabb)) = meshes.get_mut(entity) else {
            return false;
        };
        if visible.get() {
            aabb.set_changed();
        }
        *frames -= 1;
        visible.get() && *frames > 0
    });
}
