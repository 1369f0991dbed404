//! A picture in two halves: the same view of two sets of models, with the boxes by which each is culled.

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{RenderLayers, VisibilitySystems};
use bevy::camera::{CameraUpdateSystems, RenderTarget, Viewport};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::gizmos::AppGizmoBuilder;
use bevy::gizmos::config::{GizmoConfigGroup, GizmoConfigStore};
use bevy::prelude::*;
use bevy_panorbit_camera::PanOrbitCameraSystemSet;

use super::stage::StageCamera;

/// The half in which a model is drawn; it also needs [`Half::layer`].
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// Boxes are red.
    Left,
    /// Boxes are green.
    Right,
}

impl Half {
    /// What the half's camera sees.
    #[must_use]
    pub fn layer(self) -> RenderLayers {
        RenderLayers::layer(self as usize)
    }
}

/// The camera of the right half.
#[derive(Component)]
struct RightCamera;

#[derive(Default, Reflect, GizmoConfigGroup)]
struct LeftBoxes;

#[derive(Default, Reflect, GizmoConfigGroup)]
struct RightBoxes;

/// Splits the picture, and draws the box of each model that has a [`Half`].
pub fn plugin(app: &mut App) {
    app.init_gizmo_group::<LeftBoxes>()
        .init_gizmo_group::<RightBoxes>()
        .add_systems(Startup, |mut gizmos: ResMut<GizmoConfigStore>| {
            gizmos.config_mut::<LeftBoxes>().0.render_layers = Half::Left.layer();
            gizmos.config_mut::<RightBoxes>().0.render_layers = Half::Right.layer();
        })
        .add_systems(
            PostUpdate,
            (
                boxes.after(VisibilitySystems::CheckVisibility),
                split
                    .after(PanOrbitCameraSystemSet)
                    .before(TransformSystems::Propagate)
                    .before(CameraUpdateSystems),
            ),
        );
}

/// The second camera appears with the first, and sees the same in the other half of the picture.
fn split(
    mut first: Single<(&mut Camera, &Transform, &RenderTarget, &Projection), (With<StageCamera>, Without<RightCamera>)>,
    mut second: Query<(&mut Camera, &mut Transform), (With<RightCamera>, Without<StageCamera>)>,
    lights: Query<Entity, (With<DirectionalLight>, Without<RenderLayers>)>,
    mut commands: Commands,
) {
    for light in &lights {
        commands.entity(light).insert(RenderLayers::from_layers(&[0, 1]));
    }
    let (camera, place, target, projection) = &mut *first;
    let Some(size) = camera.physical_target_size() else {
        return;
    };
    let half = UVec2::new((size.x / 2).max(1), size.y);
    let viewport = |x| {
        Some(Viewport {
            physical_position: UVec2::new(x, 0),
            physical_size: half,
            ..default()
        })
    };
    camera.viewport = viewport(0);
    match second.single_mut() {
        Ok((mut right, mut there)) => {
            right.viewport = viewport(size.x - half.x);
            *there = **place;
        }
        Err(_) => {
            commands.spawn((
                RightCamera,
                Camera3d::default(),
                Camera {
                    order: 1,
                    viewport: viewport(size.x - half.x),
                    ..default()
                },
                (*target).clone(),
                (*projection).clone(),
                **place,
                Tonemapping::None,
                Half::Right.layer(),
            ));
        }
    }
}

fn boxes(arms: Query<(&Half, &Aabb, &GlobalTransform)>, mut left: Gizmos<LeftBoxes>, mut right: Gizmos<RightBoxes>) {
    for (half, aabb, place) in &arms {
        let cube = Transform::from_translation(aabb.center.into()).with_scale((2.0 * aabb.half_extents).into());
        match half {
            Half::Left => left.cube(*place * cube, Color::srgb(0.7, 0.2, 0.1)),
            Half::Right => right.cube(*place * cube, Color::srgb(0.1, 0.4, 0.2)),
        };
    }
}
