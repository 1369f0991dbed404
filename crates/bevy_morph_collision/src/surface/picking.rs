//! Picking of meshes as they are drawn.

use crate::app::missing;
use crate::components::MorphShape;
use crate::contacts::MorphCollisions;
use crate::spatial::{MorphQueryFilter, MorphRayHit, MorphSpatialQuery};
use bevy::camera::Camera;
use bevy::camera::visibility::RenderLayers;
use bevy::picking::PickingSystems;
use bevy::picking::backend::ray::RayMap;
use bevy::picking::backend::{HitData, PointerHits};
use bevy::picking::prelude::Pickable;
use bevy::prelude::*;

/// A Bevy picking backend: pointers hit the meshes of [`MorphCollider`](crate::components::MorphCollider)s with their current morph weights
/// and joints.
///
/// It respects [`Pickable`], [`RenderLayers`] and visibility. Each hit carries a [`MorphPick`]; read it with `HitData::extra_as`.
/// Entities with a [`MorphShape`](crate::components::MorphShape) are not hit, even if they have a mesh.
///
/// It needs [`MorphCollisionPlugin`](crate::plugins::MorphCollisionPlugin) and Bevy's picking plugins (`DefaultPickingPlugins`, part of
/// `DefaultPlugins`). If one is missing, an error is logged, unless this plugin came with [`MorphPlugins`](crate::plugins::MorphPlugins).
///
/// Bevy's own `MeshPickingPlugin` picks morphing and skinned meshes in their rest pose. Leave it out, or set
/// `MeshPickingSettings::require_markers` and mark only meshes that do not deform.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::surface::MorphPick;
/// fn print_what_was_clicked(click: On<PointerClick>) {
///     if let Some(pick) = click.hit.extra_as::<MorphPick>() {
///         println!("triangle {} at {:?}", pick.triangle, pick.uv);
///     }
/// }
/// # let mut world = World::new();
/// # world.add_observer(print_what_was_clicked);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphPickingPlugin;

/// Settings of [`MorphPickingPlugin`].
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphPickingSettings {
    /// Only hits colliders with a [`Pickable`] component.
    pub require_pickable: bool,
    /// Also hits triangles from behind. Use it for double-sided materials.
    pub back_faces: bool,
}

/// What a hit of [`MorphPickingPlugin`] adds to Bevy's [`HitData`].
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphPick {
    /// The triangle's number in its mesh.
    pub triangle: u32,
    /// The barycentric coordinates of the point in the triangle.
    pub barycentrics: Vec3,
    /// The texture coordinates at the point, if the mesh has any.
    pub uv: Option<Vec2>,
    /// The joint that moves the point most, on a skinned mesh; see [`MorphRayHit::joint`].
    pub joint: Option<Entity>,
}

impl From<&MorphRayHit> for MorphPick {
    fn from(hit: &MorphRayHit) -> Self {
        Self {
            triangle: hit.triangle,
            barycentrics: hit.barycentrics,
            uv: hit.uv,
            joint: hit.joint,
        }
    }
}

impl Plugin for MorphPickingPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<MorphPickingSettings>()
            .register_type::<MorphPickingSettings>()
            .register_type::<MorphPick>()
            .add_systems(
                PreUpdate,
                hit_colliders
                    .in_set(PickingSystems::Backend)
                    .run_if(resource_exists::<RayMap>)
                    .run_if(resource_exists::<Messages<PointerHits>>),
            );
    }

    fn finish(&self, app: &mut App) {
        let world = app.world();
        if !world.contains_resource::<MorphCollisions>() {
            missing(
                app,
                "MorphPickingPlugin hits nothing without MorphCollisionPlugin: add it to the app",
            );
        }
        if !world.contains_resource::<RayMap>() || !world.contains_resource::<Messages<PointerHits>>() {
            missing(
                app,
                "MorphPickingPlugin hits nothing without Bevy's DefaultPickingPlugins: add them to the app",
            );
        }
    }
}

/// What decides whether a collider can be picked.
///
/// Shapes are not drawn, so they cannot be picked.
type PickedBy = (
    Option<&'static Pickable>,
    Option<&'static RenderLayers>,
    Option<&'static ViewVisibility>,
);

/// Casts a ray for every pointer and camera.
fn hit_colliders(
    settings: Res<MorphPickingSettings>,
    rays: Res<RayMap>,
    cameras: Query<(&Camera, Option<&RenderLayers>)>,
    colliders: Query<PickedBy, Without<MorphShape>>,
    spatial: MorphSpatialQuery,
    mut hits: MessageWriter<PointerHits>,
) {
    let everything = RenderLayers::default();
    for (&id, &ray) in rays.iter() {
        let Ok((camera, camera_layers)) = cameras.get(id.camera) else {
            continue;
        };
        if !camera.is_active {
            continue;
        }
        let camera_layers = camera_layers.unwrap_or(&everything);
        let mut passed: Vec<Entity> = Vec::new();
        let mut picks = Vec::new();
        // Each collider's first hit, nearest first, up to a collider that blocks everything behind it.
        loop {
            let can_pick = |entity: Entity| {
                let Ok((pickable, layers, visible)) = colliders.get(entity) else {
                    return false;
                };
                pickable.map_or(!settings.require_pickable, |pickable| pickable.is_hoverable)
                    && camera_layers.intersects(layers.unwrap_or(&everything))
                    && visible.is_none_or(|visible| visible.get())
                    && !passed.contains(&entity)
            };
            let filter = MorphQueryFilter {
                only_front: !settings.back_faces,
                ..default()
            };
            let hit = spatial.cast_ray_predicate(ray.origin, ray.direction, f32::INFINITY, &filter, can_pick);
            let Some(hit) = hit else { break };
            let data = HitData::new_with_extra(
                id.camera,
                hit.distance,
                Some(hit.point),
                Some(hit.normal),
                MorphPick::from(&hit),
            );
            picks.push((hit.entity, data));
            passed.push(hit.entity);
            let pickable = colliders.get(hit.entity).ok().and_then(|(pickable, ..)| pickable);
            if pickable.is_none_or(|pickable| pickable.should_block_lower) {
                break;
            }
        }
        if !picks.is_empty() {
            hits.write(PointerHits::new(id.pointer, picks, camera.order as f32));
        }
    }
}
