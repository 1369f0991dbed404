//! Boxes around drawn meshes.

use std::sync::Arc;

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{DynamicSkinnedMeshBounds, NoAutoAabb, NoFrustumCulling};
use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::system::SystemParam;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use morph_collision::{JointMatrices, MorphBvh, Pose, WorldFromModel};

use super::changes::BoundsChanges;
use super::culled::Culled;
use super::local::{UNBOUNDED, around, around_in};
use crate::import::{MorphTrees, TreeKey};
use crate::posing::{BindPoses, LentPoses, Skeletons, take_weights};

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
    globals: Query<'w, 's, &'static GlobalTransform>,
    trees: Res<'w, MorphTrees>,
    bind_poses: Option<Res<'w, BindPoses>>,
    poses: Local<'s, LentPoses>,
    skeletons: Local<'s, Skeletons>,
    rest: Local<'s, Vec<f32>>,
    /// For skinned meshes, the input of their last box: all entities of a mesh share one pose, so the pose does not keep it.
    cached: Local<'s, EntityHashMap<CachedBounds>>,
}

/// The box of a skinned mesh, and the input from which it was computed.
pub(super) struct CachedBounds {
    joints: JointMatrices,
    weights: Vec<f32>,
    tree: Arc<MorphBvh>,
    world_from_entity: GlobalTransform,
    aabb: Aabb,
    is_used: bool,
}

impl DrawnMeshes<'_, '_> {
    fn begin(&mut self) {
        self.poses.drop_unused();
        self.skeletons.begin();
        self.cached.retain(|_, cached| std::mem::take(&mut cached.is_used));
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
        let pose = self.poses.lend(key, tree);
        if !pose.weights().is_empty() {
            take_weights(pose, weights, &self.shared, &mut self.rest).ok()?;
        }
        if pose.joints().is_none() {
            return Some(around(&pose.bounds()));
        }
        let globals = &self.globals;
        let global_of = |joint: Entity| Some(globals.get(joint).ok()?.affine());
        let skeleton = self.skeletons.of(skin?, self.bind_poses.as_deref(), global_of);
        if skeleton.problem().is_some() {
            return None;
        }
        let joints = skeleton.matrices()?;
        if let Some(cached) = self.cached.get_mut(&entity) {
            cached.is_used = true;
            if cached.is_same(pose, joints, world_from_entity) {
                return Some(cached.aabb);
            }
        }
        pose.set_joints(joints).ok()?;
        let aabb = match WorldFromModel::new(world_from_entity.affine()) {
            Ok(affine) => around_in(&pose.local_bounds(&affine), world_from_entity),
            Err(_) => UNBOUNDED,
        };
        match self.cached.get_mut(&entity) {
            Some(cached) => cached.set(pose, joints, world_from_entity, aabb),
            None => {
                let computed = CachedBounds::new(pose, joints, world_from_entity, aabb);
                self.cached.insert(entity, computed);
            }
        }
        Some(aabb)
    }
}

impl CachedBounds {
    fn new(pose: &Pose, joints: &JointMatrices, world_from_entity: &GlobalTransform, aabb: Aabb) -> Self {
        Self {
            joints: joints.clone(),
            weights: pose.weights().to_vec(),
            tree: pose.bvh().clone(),
            world_from_entity: *world_from_entity,
            aabb,
            is_used: true,
        }
    }

    /// Like [`CachedBounds::new`], with the memory that is there.
    fn set(&mut self, pose: &Pose, joints: &JointMatrices, world_from_entity: &GlobalTransform, aabb: Aabb) {
        self.joints.clone_from(joints);
        pose.weights().clone_into(&mut self.weights);
        self.tree.clone_from(pose.bvh());
        self.world_from_entity = *world_from_entity;
        self.aabb = aabb;
    }

    fn is_same(&self, pose: &Pose, joints: &JointMatrices, world_from_entity: &GlobalTransform) -> bool {
        Arc::ptr_eq(&self.tree, pose.bvh())
            && self.world_from_entity == *world_from_entity
            && self.weights == pose.weights()
            && self.joints == *joints
    }
}

/// Updates the boxes of deforming meshes so that they contain what is drawn. If nothing else has changed, looks only at skinned meshes.
pub(super) fn update_bounds(
    mut meshes: ParamSet<(BoundsChanges, Query<DrawnMesh, Culled>)>,
    mut drawn: DrawnMeshes,
    mut commands: Commands,
) {
    let only_skinned = !meshes.p0().any(&drawn.trees);
    drawn.begin();
    for (entity, mesh, weights, skin, world_from_entity, mut aabb, (has_dynamic, had_dynamic)) in &mut meshes.p1() {
        if only_skinned && skin.is_none() {
            continue;
        }
        let key = TreeKey::of(mesh, None, skin);
        if drawn.trees.up_to_date(key).is_none() {
            if had_dynamic {
                give_back_to_bevy(&mut commands, entity);
            }
            continue;
        }
        // Otherwise the box stays the same.
        let Some(wanted) = drawn.bounds(entity, key, weights, skin, world_from_entity) else {
            continue;
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
