//! Debug drawing of the collision state on top of the rendered scene.

use bevy::gizmos::config::{GizmoConfigGroup, GizmoConfigStore};
use bevy::gizmos::gizmos::Gizmos;
use bevy::gizmos::{AppGizmoBuilder, GizmoAsset};
use bevy::math::{Affine3A, DVec3, Mat3A};
use bevy::prelude::*;
use morph_collision::{Body, WorldFromModel};

use crate::app::{MorphCollisionSystems, missing};
use crate::components::MorphUnit;
use crate::contacts::MorphCollisions;
use crate::state::{ColliderState, Form};

/// Draws tree boxes, contacts and touching triangles, as configured in [`MorphGizmos`].
///
/// It needs [`MorphCollisionPlugin`](crate::plugins::MorphCollisionPlugin) and Bevy's `GizmoPlugin` (part of `DefaultPlugins`). If one is
/// missing, an error is logged, unless this plugin came with [`MorphPlugins`](crate::plugins::MorphPlugins). The lines are Bevy gizmos, so
/// they are visible only with a renderer with `bevy_gizmos_render`.
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphGizmosPlugin;

/// What [`MorphGizmosPlugin`] draws. This is a Bevy gizmo config group; change it in `GizmoConfigStore`.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy::gizmos::config::GizmoConfigStore;
/// # use bevy_morph_collision::debug::MorphGizmos;
/// fn look_deeper(mut store: ResMut<GizmoConfigStore>) {
///     store.config_mut::<MorphGizmos>().1.depth = Some(3);
/// }
/// # bevy::ecs::system::assert_is_system(look_deeper);
/// ```
#[derive(GizmoConfigGroup, Reflect, Clone, Debug, PartialEq)]
#[reflect(Default)]
pub struct MorphGizmos {
    /// Draws the boxes of each collider's nodes at this depth below the root, and of leaves above it. The boxes are refitted for
    /// drawing. `None` draws no boxes.
    pub depth: Option<usize>,
    /// The colour of nodes that a query had already refitted for the current weights.
    pub refitted: Color,
    /// The colour of nodes refitted only for drawing.
    pub resting: Color,
    /// The colour of touching triangles' outlines; `None` draws none.
    pub triangles: Option<Color>,
    /// The colour of contact points and normals; `None` draws none.
    pub contacts: Option<Color>,
    /// The length of drawn normals, in world units.
    #[reflect(@MorphUnit::Length)]
    pub normal_length: f32,
}

impl Default for MorphGizmos {
    fn default() -> Self {
        Self {
            depth: None,
            refitted: Color::srgb(1.0, 0.5, 0.1),
            resting: Color::srgb(0.3, 0.5, 0.9),
            triangles: Some(Color::srgb(1.0, 0.1, 0.1)),
            contacts: Some(Color::srgb(1.0, 1.0, 0.2)),
            normal_length: 0.1,
        }
    }
}

impl Plugin for MorphGizmosPlugin {
    fn build(&self, app: &mut App) {
        app.init_gizmo_group::<MorphGizmos>()
            .register_type::<MorphGizmos>()
            .add_systems(
                PostUpdate,
                draw.after(MorphCollisionSystems::Events)
                    .run_if(resource_exists::<MorphCollisions>)
                    .run_if(resource_exists::<CanDraw>),
            );
    }

    fn finish(&self, app: &mut App) {
        if !app.world().contains_resource::<MorphCollisions>() {
            missing(
                app,
                "MorphGizmosPlugin draws nothing without MorphCollisionPlugin: add it to the app",
            );
        }
        if app.world().contains_resource::<Assets<GizmoAsset>>() {
            app.init_resource::<CanDraw>();
        } else {
            missing(
                app,
                "MorphGizmosPlugin draws nothing without Bevy's GizmoPlugin: add it to the app",
            );
            // Without it, Bevy's systems for this gizmo group panic.
            app.init_resource::<Assets<GizmoAsset>>();
        }
    }
}

/// Bevy's `GizmoPlugin` is there. Without it nobody would free what is drawn in each frame.
#[derive(Resource, Default)]
struct CanDraw;

/// Draws everything that the settings ask for.
fn draw(
    mut gizmos: Gizmos<MorphGizmos>,
    store: Res<GizmoConfigStore>,
    collisions: Res<MorphCollisions>,
    mut colliders: Query<(&mut ColliderState, &GlobalTransform)>,
) {
    let (config, style) = store.config::<MorphGizmos>();
    if !config.enabled {
        return;
    }
    if let Some(depth) = style.depth {
        for (mut state, place) in &mut colliders {
            let ColliderState {
                pose: Some(pose),
                placed: Some(_),
                ..
            } = &mut *state
            else {
                continue;
            };
            pose.get_mut().visit_nodes(|node| {
                if node.depth == depth || node.is_leaf {
                    let color = if node.was_cached { style.refitted } else { style.resting };
                    let cube = Transform::from_translation(node.bounds.center()).with_scale(node.bounds.size());
                    let place = node.world_from_bounds.as_ref().map_or(*place, in_world);
                    gizmos.cube(place * cube, color);
                }
                node.depth < depth
            });
        }
    }
    for contact in collisions.iter() {
        if let Some(color) = style.triangles {
            for pair in &contact.triangles {
                let sides = [
                    (contact.collider1, pair.triangle_a),
                    (contact.collider2, pair.triangle_b),
                ];
                for (collider, triangle) in sides {
                    let state = colliders.get_mut(collider).ok();
                    if let Some([a, b, c]) = state.and_then(|(mut state, _)| corners(&mut state, triangle)) {
                        gizmos.linestrip([a, b, c, a], color);
                    }
                }
            }
        }
        if let Some(color) = style.contacts {
            let deepest = [contact.point];
            let others = contact.points.iter().map(|point| point.point);
            for point in deepest.into_iter().chain(others.skip(1)) {
                gizmos.arrow(point, point + contact.normal * style.normal_length, color);
            }
        }
    }
}

/// The transform for the box of a skinned mesh's node.
fn in_world(place: &WorldFromModel) -> GlobalTransform {
    let origin = place.transform_point(Vec3::ZERO);
    let [x, y, z] = Vec3::AXES.map(|axis| (place.transform_point(axis) - origin).as_vec3a());
    let matrix3 = Mat3A::from_cols(x, y, z);
    let translation = origin.as_vec3a();
    GlobalTransform::from(Affine3A { matrix3, translation })
}

/// The corners of a triangle of a mesh; `None` for shapes.
fn corners(state: &mut ColliderState, triangle: u32) -> Option<[Vec3; 3]> {
    let ColliderState { pose, placed, .. } = state;
    let Form::Mesh(place) = &placed.as_ref()?.form else {
        return None;
    };
    let corners = Body::new(pose.as_mut()?.get_mut(), place).triangle(triangle)?;
    Some(corners.map(DVec3::as_vec3))
}
