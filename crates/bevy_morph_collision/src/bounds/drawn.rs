//! Boxes around drawn meshes.

use std::sync::Arc;

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{DynamicSkinnedMeshBounds, NoAutoAabb, NoFrustumCulling};
use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::query::QueryItem;
use bevy::ecs::system::SystemParam;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use morph_collision::{JointMatrices, MorphBvh, Pose, WorldFromModel};

use super::changes::BoundsChanges;
use super::culled::Culled;
use super::local::{UNBOUNDED, around, around_in};
use crate::import::{MorphTrees, TreeKey};
use crate::posing::{CurrentSkeletons, LentPoses, drawn_weights};
use crate::state::{ColliderState, LockedPose};

/// Marks meshes that had [`DynamicSkinnedMeshBounds`] before the plugin took over their box. Bevy would otherwise write the box
/// too.
#[derive(Component)]
pub(super) struct HadDynamicBounds;

/// A mesh and the components that determine how it is drawn.
type DrawnMesh = (
    Entity,
    &'static Mesh3d,
    Option<&'static MeshMorphWeights>,
    Option<&'static SkinnedMesh>,
    &'static GlobalTransform,
    &'static mut Aabb,
    (Has<DynamicSkinnedMeshBounds>, Has<HadDynamicBounds>),
);

/// Poses of meshes as drawn now.
#[derive(SystemParam)]
pub(super) struct DrawnMeshes<'w, 's> {
    shared: Query<'w, 's, &'static MorphWeights>,
    trees: Res<'w, MorphTrees>,
    colliders: Query<'w, 's, &'static ColliderState>,
    poses: Local<'s, LentPoses>,
    skeletons: CurrentSkeletons<'w, 's>,
    rest: Local<'s, Vec<f32>>,
    /// For skinned meshes, the input of their last box: all entities of a mesh share one pose, so the pose does not keep it.
    cached: Local<'s, EntityHashMap<CachedBounds>>,
}

/// What determines the box of a skinned mesh.
struct Drawn<'a> {
    tree: &'a Arc<MorphBvh>,
    weights: &'a [f32],
    joints: &'a JointMatrices,
    world_from_entity: &'a GlobalTransform,
}

/// The box of a skinned mesh, and the input from which it was computed.
pub(super) struct CachedBounds {
    tree: Arc<MorphBvh>,
    weights: Vec<f32>,
    joints: JointMatrices,
    world_from_entity: GlobalTransform,
    aabb: Aabb,
    is_used: bool,
}

impl DrawnMeshes<'_, '_> {
    fn begin(&mut self) {
        self.poses.drop_unused();
        self.skeletons.notice();
        self.cached.retain(|_, cached| std::mem::take(&mut cached.is_used));
    }

    /// Updates the box of a mesh.
    fn update(
        &mut self,
        (entity, mesh, weights, skin, world_from_entity, mut aabb, (has_dynamic, had_dynamic)): QueryItem<DrawnMesh>,
        commands: &mut Commands,
    ) {
        let key = TreeKey::of(mesh, None, skin);
        if self.trees.up_to_date(key).is_none() {
            if had_dynamic {
                give_back_to_bevy(commands, entity);
            }
            return;
        }
        // Otherwise the box stays the same.
        let Some(wanted) = self.bounds(entity, key, weights, skin, world_from_entity) else {
            return;
        };
        if *aabb != wanted {
            *aabb = wanted;
        }
        if has_dynamic {
            let mut entity = commands.entity(entity);
            entity.try_remove::<DynamicSkinnedMeshBounds>();
            entity.try_insert(HadDynamicBounds);
        }
    }

    /// A box around a mesh in the space of its entity. `None` if it is not known what is drawn.
    fn bounds(
        &mut self,
        entity: Entity,
        key: TreeKey,
        weights: Option<&MeshMorphWeights>,
        skin: Option<&SkinnedMesh>,
        world_from_entity: &GlobalTransform,
    ) -> Option<Aabb> {
        let tree = self.trees.up_to_date(key)?;
        let weights = match tree.model().target_count() {
            0 => &[],
            count => drawn_weights(count, weights, &self.shared, &mut self.rest).ok()?,
        };
        let poses = (&self.colliders, &mut *self.poses);
        if tree.model().joint_count().is_none() {
            return ask_pose(poses, entity, key, tree, weights, None, |pose| around(&pose.bounds()));
        }
        let drawn = Drawn {
            tree,
            weights,
            joints: self.skeletons.of(skin?).current_matrices()?,
            world_from_entity,
        };
        if let Some(cached) = self.cached.get_mut(&entity) {
            cached.is_used = true;
            if cached.is_of(&drawn) {
                return Some(cached.aabb);
            }
        }
        let aabb = match WorldFromModel::new(world_from_entity.affine()) {
            Ok(place) => {
                let bounds = match tree.local_bounds(weights, drawn.joints, &place) {
                    Some(bounds) => bounds,
                    None => ask_pose(poses, entity, key, tree, weights, Some(drawn.joints), |pose| {
                        pose.local_bounds(&place)
                    })?,
                };
                around_in(&bounds, world_from_entity)
            }
            Err(_) => UNBOUNDED,
        };
        match self.cached.get_mut(&entity) {
            Some(cached) => cached.set(&drawn, aabb),
            None => _ = self.cached.insert(entity, CachedBounds::new(&drawn, aabb)),
        }
        Some(aabb)
    }
}

/// Asks a pose of a mesh as it is drawn. `None` if the mesh does not accept the weights or joints.
fn ask_pose<R>(
    (colliders, poses): (&Query<&ColliderState>, &mut LentPoses),
    entity: Entity,
    key: TreeKey,
    tree: &Arc<MorphBvh>,
    weights: &[f32],
    joints: Option<&JointMatrices>,
    ask: impl FnOnce(&mut Pose) -> R,
) -> Option<R> {
    // A collider has often been posed like this already.
    let own = colliders.get(entity).ok().and_then(|state| state.pose.as_ref());
    if let Some(mut pose) = own.map(LockedPose::lock)
        && Arc::ptr_eq(pose.bvh(), tree)
        && pose.joints() == joints
        && pose.weights() == weights
    {
        return Some(ask(&mut pose));
    }
    let pose = poses.lend(key, tree);
    pose.set_weights(weights).ok()?;
    if let Some(joints) = joints {
        pose.set_joints(joints).ok()?;
    }
    Some(ask(pose))
}

impl CachedBounds {
    fn new(drawn: &Drawn, aabb: Aabb) -> Self {
        Self {
            tree: drawn.tree.clone(),
            weights: drawn.weights.to_vec(),
            joints: drawn.joints.clone(),
            world_from_entity: *drawn.world_from_entity,
            aabb,
            is_used: true,
        }
    }

    /// Like [`CachedBounds::new`], with the memory that is there.
    fn set(&mut self, drawn: &Drawn, aabb: Aabb) {
        self.tree.clone_from(drawn.tree);
        drawn.weights.clone_into(&mut self.weights);
        self.joints.clone_from(drawn.joints);
        self.world_from_entity = *drawn.world_from_entity;
        self.aabb = aabb;
    }

    fn is_of(&self, drawn: &Drawn) -> bool {
        Arc::ptr_eq(&self.tree, drawn.tree)
            && self.world_from_entity == *drawn.world_from_entity
            && self.weights == drawn.weights
            && self.joints == *drawn.joints
    }
}

/// Updates the boxes of deforming meshes so that they contain what is drawn. If nothing else has changed, looks only at skinned meshes.
pub(super) fn update_bounds(
    mut meshes: ParamSet<(
        BoundsChanges,
        Query<DrawnMesh, Culled>,
        Query<DrawnMesh, (Culled, With<SkinnedMesh>)>,
    )>,
    mut drawn: DrawnMeshes,
    mut commands: Commands,
) {
    let any = meshes.p0().any(&drawn.trees);
    drawn.begin();
    let update = |mesh: QueryItem<DrawnMesh>| drawn.update(mesh, &mut commands);
    if any {
        meshes.p1().iter_mut().for_each(update);
    } else {
        meshes.p2().iter_mut().for_each(update);
    }
}

/// Meshes whose box the plugin no longer updates.
type Left = (
    With<HadDynamicBounds>,
    Or<(With<NoAutoAabb>, With<NoFrustumCulling>, Without<SkinnedMesh>)>,
);

/// Lets Bevy update the boxes of these skinned meshes again.
pub(super) fn give_back(left: Query<Entity, Left>, mut commands: Commands) {
    for entity in &left {
        give_back_to_bevy(&mut commands, entity);
    }
}

fn give_back_to_bevy(commands: &mut Commands, entity: Entity) {
    let mut entity = commands.entity(entity);
    entity.try_remove::<HadDynamicBounds>();
    entity.try_insert(DynamicSkinnedMeshBounds);
}
