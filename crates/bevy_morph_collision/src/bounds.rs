//! Culling: the [`Aabb`] of morphing meshes.

use bevy::app::AnimationSystems;
use bevy::asset::AssetEventSystems;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{NoAutoAabb, NoFrustumCulling, VisibilitySystems, calculate_bounds};
use bevy::ecs::entity::EntityHashMap;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use crate::import::MorphTrees;
use crate::lent_poses::LentPoses;
use crate::plugin::TreesPlugin;

/// Keeps the [`Aabb`] of morphing meshes around what is drawn, every frame. Bevy itself keeps that of the rest pose, so that
/// meshes vanish at the edge of the screen.
///
/// Works with or without [`MorphCollisionPlugin`](crate::MorphCollisionPlugin), for every mesh with [`MeshMorphWeights`],
/// whether it collides or not. A box is conservative, from the blended root of the mesh's tree, in `O(active targets)` per
/// mesh; it is written only where it differs. Until the tree of a mesh is built, the mesh keeps the box that Bevy gave it. A mesh that
/// cannot be used keeps it for good, and the log says why.
///
/// Bevy's opt-outs are heeded: [`NoAutoAabb`] and [`NoFrustumCulling`]. Skinned meshes are left to Bevy, as their bones move
/// them out of any box of ours. Opting in again, or enabling an entity again, works at any time.
///
/// It also repairs a bug of Bevy 0.20: a morphing mesh that comes into view for the first time since it was loaded is drawn in its
/// rest pose until something else about it changes.
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphBoundsPlugin;

/// Where [`MorphBoundsPlugin`] works, in [`PostUpdate`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MorphBoundsSystems {
    /// After Bevy has calculated bounds, before it checks visibility.
    Bounds,
    /// After Bevy has checked visibility.
    Redraw,
}

impl Plugin for MorphBoundsPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<TreesPlugin>() {
            app.add_plugins(TreesPlugin);
        }
        app.insert_resource(crate::import::Culls);
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

/// Looks at all meshes in every frame: an entity may have been disabled or opted out until now, and its tree may have been dropped.
fn request_trees_to_cull(culled: Query<(Entity, &Mesh3d), Culled>, mut trees: ResMut<MorphTrees>) {
    for (entity, mesh) in &culled {
        let key = (mesh.id(), None);
        if !trees.is_known(key) {
            trees.request(key, entity);
        }
    }
}

/// Gives morphing meshes a box around what they are drawn as.
fn update_bounds(
    mut meshes: Query<(&Mesh3d, &MeshMorphWeights, &mut Aabb), Culled>,
    shared: Query<&MorphWeights>,
    trees: Res<MorphTrees>,
    mut poses: Local<LentPoses>,
) {
    poses.drop_unused();
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
        let pose = poses.lend(key, tree);
        if pose.set_weights(weights).is_err() {
            // Nobody knows what is drawn with such weights: the box stays.
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
