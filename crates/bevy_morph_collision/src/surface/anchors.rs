//! Entities that stick to a deforming surface.

use bevy::ecs::system::{SystemChangeTick, SystemParam};
use bevy::math::Affine3A;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use morph_collision::{Body, Pose, SurfaceAnchor, WorldFromModel};

use crate::components::{MorphCollider, MorphShape, MorphTreeOptions, MorphUnit};
use crate::import::{MorphTrees, TreeKey};
use crate::posing::{AllSkins, BindPoses, LentPoses, Skeletons, take_weights};
use crate::spatial::MorphRayHit;
use crate::state::{ColliderState, Preparation};

/// Attaches this entity to a point of a collider's surface, so that it follows as the mesh morphs and moves. Use it for decals,
/// hats or particles.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn put_on_hat(spatial: MorphSpatialQuery, mut commands: Commands) {
///     let from_above = spatial.cast_ray(Vec3::Y * 10.0, Dir3::NEG_Y, 20.0, &MorphQueryFilter::default());
///     if let Some(hit) = from_above {
///         commands.spawn(MorphSurfaceAnchor::at(&hit).with_offset(0.01));
///     }
/// }
/// # App::new().add_systems(Update, put_on_hat);
/// ```
///
/// The entity follows the drawn surface. It is placed in [`PostUpdate`], with the weights, joints and [`GlobalTransform`] with
/// which the mesh is drawn in this frame. This does not depend on the schedule of collision detection, and also works while that
/// is [paused](crate::components::MorphCollisionSettings::paused) and while the collider has
/// [`MorphColliderDisabled`](crate::components::MorphColliderDisabled). If weights or joints cannot be used, the anchor uses the last valid
/// ones of the collider.
///
/// The plugin writes the entity's [`Transform`], relative to its parent if it has one, and the [`GlobalTransform`]s of the entity
/// and all its descendants, so they are correct in the same frame. The scale is kept. Nothing is written if
///
/// - the triangle does not exist;
/// - `collider` is not a collider, has a [`MorphShape`], or is disabled by Bevy's `Disabled`;
/// - the mesh's tree is not built yet.
///
/// The default names [`Entity::PLACEHOLDER`], which does not exist, and the middle of triangle 0.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(Transform)]
pub struct MorphSurfaceAnchor {
    /// The collider whose mesh the entity follows.
    #[entities]
    pub collider: Entity,
    /// The triangle's number in the mesh.
    pub triangle: u32,
    /// The barycentric coordinates of the point in the triangle.
    pub barycentrics: Vec3,
    /// The distance from the surface along its normal, in world units.
    #[reflect(@MorphUnit::Length)]
    pub offset: f32,
    /// Whether the entity turns with the surface: +Y points along the normal and +X along the triangle's first edge.
    pub align: bool,
}

impl Default for MorphSurfaceAnchor {
    fn default() -> Self {
        Self::new(Entity::PLACEHOLDER, 0, Vec3::splat(1.0 / 3.0))
    }
}

impl MorphSurfaceAnchor {
    /// Creates an anchor on the surface that turns with it.
    #[must_use]
    pub fn new(collider: Entity, triangle: u32, barycentrics: Vec3) -> Self {
        Self {
            collider,
            triangle,
            barycentrics,
            offset: 0.0,
            align: true,
        }
    }

    /// Creates an anchor at the hit point of a ray.
    #[must_use]
    pub fn at(hit: &MorphRayHit) -> Self {
        Self::new(hit.entity, hit.triangle, hit.barycentrics)
    }

    /// Sets the distance from the surface.
    #[must_use]
    pub fn with_offset(mut self, offset: f32) -> Self {
        self.offset = offset;
        self
    }
}

/// The surfaces of colliders as drawn in this frame.
///
/// Colliders keep the weights and transforms of the last collision run because spatial queries and the next run need them, so
/// anchors have their own poses.
#[derive(SystemParam)]
pub(crate) struct DrawnSurfaces<'w, 's> {
    colliders: Query<
        'w,
        's,
        (
            &'static Mesh3d,
            Option<&'static MorphTreeOptions>,
            Option<&'static SkinnedMesh>,
            Option<&'static MeshMorphWeights>,
            &'static ColliderState,
        ),
        (With<MorphCollider>, Without<MorphShape>),
    >,
    shared: Query<'w, 's, &'static MorphWeights>,
    trees: Res<'w, MorphTrees>,
    bind_poses: Option<Res<'w, BindPoses>>,
    poses: Local<'s, LentPoses>,
    skeletons: ResMut<'w, Skeletons>,
    skins: AllSkins<'w, 's>,
    rest: Local<'s, Vec<f32>>,
}

impl DrawnSurfaces<'_, '_> {
    /// The pose with which a collider's mesh is drawn, with the current transforms of its joints.
    fn pose(&mut self, collider: Entity, global_of: impl Fn(Entity) -> Option<Affine3A>) -> Option<&mut Pose> {
        let (mesh, settings, skin, weights, state) = self.colliders.get(collider).ok()?;
        let key = TreeKey::of(mesh, settings, skin);
        let tree = self.trees.tree(key)?;
        let pose = self.poses.lend(key, tree);
        if !pose.weights().is_empty() && take_weights(pose, weights, &self.shared, &mut self.rest).is_err() {
            pose.set_weights(state.pose.as_ref()?.lock().weights()).ok()?;
        }
        if pose.joints().is_some() {
            let skeleton = self.skeletons.of(skin?, self.bind_poses.as_deref(), global_of);
            match skeleton.problem() {
                None => pose.set_joints(skeleton.matrices()?).ok()?,
                Some(_) => {
                    let last_good = state.pose.as_ref().filter(|_| state.has_joints)?.lock();
                    pose.set_joints(last_good.joints()?).ok()?
                }
            };
        }
        Some(pose)
    }
}

/// Moves every anchored entity to its place, ancestors before descendants.
pub(crate) fn move_anchors(
    anchors: Query<(Entity, &MorphSurfaceAnchor, Option<&ChildOf>)>,
    mut surfaces: DrawnSurfaces,
    mut transforms: ParamSet<(
        Query<Ref<GlobalTransform>>,
        Query<(&mut Transform, &mut GlobalTransform)>,
    )>,
    parents: Query<&ChildOf>,
    children: Query<&Children>,
    mut preparation: ResMut<Preparation>,
    ticks: SystemChangeTick,
) {
    if anchors.is_empty() {
        return;
    }
    let start = Instant::now();
    surfaces.poses.drop_unused();
    surfaces
        .skeletons
        .notice(&transforms.p0(), &surfaces.skins, ticks.this_run());
    let mut transforms = transforms.p1();
    let mut anchored: Vec<_> = anchors.iter().collect();
    anchored.sort_by_cached_key(|&(entity, ..)| (parents.iter_ancestors(entity).count(), entity));
    for (entity, anchor, parent) in anchored {
        let Ok((_, world_from_collider)) = transforms.get(anchor.collider) else {
            continue;
        };
        let global_of = |joint: Entity| Some(transforms.get(joint).ok()?.1.affine());
        let pose = surfaces.pose(anchor.collider, global_of);
        let Some(world) = pose.and_then(|pose| place(anchor, pose, world_from_collider)) else {
            continue;
        };
        let parent = parent.and_then(|parent| transforms.get(parent.parent()).ok());
        let world_from_parent = parent.map_or(GlobalTransform::IDENTITY, |(_, world)| *world);
        let Ok((mut local, mut global)) = transforms.get_mut(entity) else {
            continue;
        };
        let parent_from_world = world_from_parent.affine().inverse();
        let mut next = *local;
        next.translation = parent_from_world.transform_point3(world.point);
        if let Some([tangent, normal]) = world.axes {
            // The parent may be scaled or mirrored. It maps the entity's +Y to the normal.
            let [x, y] = [tangent, normal].map(|axis| parent_from_world.transform_vector3(axis));
            let y = y.normalize_or_zero();
            let x = (x - y * y.dot(x)).normalize_or_zero();
            next.rotation = Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y))).normalize();
        }
        if next != *local && next.is_finite() {
            *local = next;
            *global = world_from_parent * next;
            let below = *global;
            spread(entity, below, &children, &mut transforms);
            // It may be a joint, and joints may be below it.
            surfaces.skeletons.outdate();
        }
    }
    preparation.anchors += start.elapsed();
}

/// The position of an anchor, and the surface's tangent and normal if the anchor turns with them.
struct Anchored {
    point: Vec3,
    axes: Option<[Vec3; 2]>,
}

fn place(anchor: &MorphSurfaceAnchor, pose: &mut Pose, world_from_collider: &GlobalTransform) -> Option<Anchored> {
    let world_from_model = match pose.joints() {
        // Its joints place it.
        Some(_) => WorldFromModel::IDENTITY,
        None => WorldFromModel::new(world_from_collider.affine()).ok()?,
    };
    let on_surface = SurfaceAnchor {
        triangle: anchor.triangle,
        barycentrics: anchor.barycentrics.as_dvec3().to_array(),
    };
    let Some(frame) = on_surface.frame(Body::new(pose, &world_from_model)) else {
        // A triangle without area has a position but no normal.
        let point = on_surface.point(Body::new(pose, &world_from_model))?.as_vec3();
        return Some(Anchored { point, axes: None });
    };
    Some(Anchored {
        point: (frame.point + frame.normal * f64::from(anchor.offset)).as_vec3(),
        axes: anchor.align.then(|| [frame.tangent.as_vec3(), frame.normal.as_vec3()]),
    })
}

/// Updates global transforms below an entity that moved after transform propagation.
fn spread(
    entity: Entity,
    world: GlobalTransform,
    children: &Query<&Children>,
    transforms: &mut Query<(&mut Transform, &mut GlobalTransform)>,
) {
    for child in children.get(entity).into_iter().flatten().copied() {
        if let Ok((local, mut global)) = transforms.get_mut(child) {
            *global = world * *local;
            let below = *global;
            spread(child, below, children, transforms);
        }
    }
}
