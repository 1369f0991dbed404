//! Culling: the [`Aabb`] of deforming meshes.

use bevy::app::AnimationSystems;
use bevy::asset::AssetEventSystems;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{NoAutoAabb, NoFrustumCulling, VisibilitySystems, calculate_bounds};
use bevy::ecs::entity::EntityHashMap;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use super::changes::TreeChanges;
use super::culled::Culled;
use super::drawn::{give_back, update_bounds};
use crate::app::Column;
use crate::import::{MorphTrees, TreeKey};
use crate::setup::TreesPlugin;

/// Updates the [`Aabb`] of morphing and skinned meshes every frame so that it contains what is drawn. Bevy's own box is that of
/// the rest pose, or for skinned meshes one that only accounts for joints, so meshes can vanish at the edge of the screen.
///
/// Works with or without [`MorphCollisionPlugin`](crate::plugins::MorphCollisionPlugin), for every mesh with [`MeshMorphWeights`] or
/// [`SkinnedMesh`], whether it collides or not. The box is conservative: it comes from the topmost boxes of the mesh's
/// tree, or for a skinned mesh from one box per joint. It is only written when it changes. Until the tree of a mesh is built, the mesh keeps the box that Bevy gave it. A mesh that
/// cannot be used keeps Bevy's box permanently, and the log says why.
///
/// Cost per mesh: `O(active targets)`; for a skinned mesh also `O(joints)`. If no joint has moved, each joint is only checked for
/// changes. While nothing about the meshes without joints changes, they cost a few comparisons.
///
/// Bevy transforms the box of a skinned mesh by the mesh's [`GlobalTransform`], although it draws the mesh without it. The plugin
/// therefore computes the box in that space. It is as tight for a character that turns as for one that does not, as long as the
/// mesh's entity turns with it. If the transform cannot be inverted (scale 0), the box is infinite, and the mesh is never culled.
/// While the transform of a joint is NaN or infinite, the box stays the same.
///
/// The plugin respects Bevy's opt-outs, [`NoAutoAabb`] and [`NoFrustumCulling`]. You can opt in again, or enable an entity again,
/// at any time. Meshes whose box this plugin updates lose
/// [`DynamicSkinnedMeshBounds`](bevy::camera::visibility::DynamicSkinnedMeshBounds), Bevy's own update of boxes by joints. They
/// get it back when the plugin stops updating them.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::bounds::MorphBoundsPlugin;
/// # let mut app = App::new();
/// app.add_plugins((DefaultPlugins, MorphBoundsPlugin));
/// ```
///
/// The plugin also works around a bug of Bevy 0.20: a morphing mesh that becomes visible for the first time since it was loaded
/// is drawn in its rest pose until something else about it changes.
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphBoundsPlugin;

/// The system sets of [`MorphBoundsPlugin`], in [`PostUpdate`].
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
        crate::posing::add_skeletons(app);
        app.insert_resource(crate::setup::Culls);
        app.configure_sets(
            PostUpdate,
            (
                MorphBoundsSystems::Bounds
                    .in_set(VisibilitySystems::CalculateBounds)
                    .after(calculate_bounds)
                    .after(AnimationSystems)
                    .after(AssetEventSystems)
                    .after(crate::app::MorphCollisionSystems::Import)
                    .before(VisibilitySystems::CheckVisibility),
                MorphBoundsSystems::Redraw.after(VisibilitySystems::MarkNewlyHiddenEntitiesInvisible),
            ),
        )
        .add_observer(forget_bounds::<MeshMorphWeights>)
        .add_observer(forget_bounds::<SkinnedMesh>)
        .add_systems(
            PostUpdate,
            (
                request_trees_to_cull
                    .in_set(crate::app::MorphCollisionSystems::Import)
                    .after(crate::import::apply_asset_events)
                    .before(crate::import::start_trees)
                    .ambiguous_with(crate::setup::request_trees),
                (update_bounds, give_back).chain().in_set(MorphBoundsSystems::Bounds),
                draw_again.in_set(MorphBoundsSystems::Redraw),
            ),
        );
    }
}

/// Checks all meshes if any may need another tree: an entity may have been disabled or opted out until now, or its tree may have been dropped.
fn request_trees_to_cull(
    culled: Query<(Entity, &Mesh3d, Option<&SkinnedMesh>), Culled>,
    mut changes: TreeChanges,
    mut trees: ResMut<MorphTrees>,
) {
    if !changes.any(&trees) {
        return;
    }
    for (entity, mesh, skin) in &culled {
        let key = TreeKey::of(mesh, None, skin);
        if !trees.is_known(key) {
            trees.request(key, entity);
        }
    }
}

/// Without weights or joints the mesh has another shape, so Bevy has to compute its box again.
fn forget_bounds<C: Component>(
    removed: On<Remove<C>>,
    culled: Query<(), (With<Mesh3d>, Without<NoAutoAabb>, Without<NoFrustumCulling>)>,
    mut commands: Commands,
) {
    if culled.contains(removed.entity) {
        commands.entity(removed.entity).try_remove::<Aabb>();
    }
}

/// Marks morphing meshes that became visible as changed for two more frames, so that Bevy uploads their weights.
fn draw_again(
    mut meshes: Query<(Entity, &ViewVisibility, &mut Aabb), With<MeshMorphWeights>>,
    seen: Query<(Entity, Ref<ViewVisibility>), With<MeshMorphWeights>>,
    mut left: Local<EntityHashMap<u8>>,
) {
    const FRAMES: u8 = 2;
    // Both components are in tables.
    for (entities, visible) in seen.contiguous_iter().into_iter().flatten() {
        let column = Column::changed(&visible);
        left.extend(column.new_rows().map(|row| (entities[row], FRAMES)));
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
