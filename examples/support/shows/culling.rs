//! The boxes that Bevy uses to cull morphing and skinned meshes. On the left, Bevy's own box for the rest pose; on the right, the
//! repaired one.

use std::f32::consts::PI;

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{NoAutoAabb, RenderLayers};
use bevy::camera::{CameraUpdateSystems, RenderTarget, Viewport};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::gizmos::config::{GizmoConfigGroup, GizmoConfigStore};
use bevy::gizmos::{AppGizmoBuilder, gizmos::Gizmos};
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_panorbit_camera::PanOrbitCameraSystemSet;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::models::pass_through_body_at;

use crate::view::Show;
use crate::view::clock::{Clock, started};
use crate::view::models::with_normals;
use crate::view::stage::{Notes, StageCamera};

/// Number of arms that reach into the picture.
const ARMS: usize = 4;

/// Left and right.
#[derive(Component, Clone, Copy, PartialEq, Eq)]
enum Half {
    Bevys,
    Repaired,
}

impl Half {
    fn layer(self) -> RenderLayers {
        RenderLayers::layer(self as usize)
    }
}

/// Index of an arm. Morph targets extend the even ones, joints the odd ones.
#[derive(Component)]
struct Arm(usize);

/// The entity that extends an arm, with the arm's index.
#[derive(Component)]
struct Hand(usize);

/// The camera of the right half.
#[derive(Component)]
struct RightCamera;

#[derive(Default, Reflect, GizmoConfigGroup)]
struct LeftBoxes;

#[derive(Default, Reflect, GizmoConfigGroup)]
struct RightBoxes;

/// Arms that reach into the picture from outside.
#[must_use]
pub fn culling() -> Show {
    Show {
        name: "culling",
        about: "Left: culled by Bevy's own boxes, those of the rest pose. Right: by boxes that follow morph targets and joints.",
        keys: &[("left half", "is where the mouse moves both cameras")],
        eye: Vec3::new(0.0, 0.0, 7.0),
        target: Vec3::ZERO,
        pictures: &[0, 45, 90],
        scene: Box::new(|app| {
            app.init_gizmo_group::<LeftBoxes>()
                .init_gizmo_group::<RightBoxes>()
                .add_systems(Startup, spawn)
                .add_systems(Update, ((reach, sway).run_if(started), tell))
                .add_systems(
                    PostUpdate,
                    boxes.after(bevy::camera::visibility::VisibilitySystems::CheckVisibility),
                )
                .add_systems(
                    PostUpdate,
                    split
                        .after(PanOrbitCameraSystemSet)
                        .before(TransformSystems::Propagate)
                        .before(CameraUpdateSystems),
                );
        }),
    }
}

/// A ball with a target that extends an arm out of it along `-X`.
fn arm() -> MorphMesh {
    let mut mesh = pass_through_body_at(4);
    let directions: Vec<Vec3> = mesh.positions.iter().map(|p| p.normalize_or_zero()).collect();
    mesh.targets = vec![
        directions
            .iter()
            .map(|n| Vec3::NEG_X * 4.0 * (-n.x).max(0.0).powi(8))
            .collect(),
    ];
    mesh.target_names = vec!["reach".into()];
    mesh.positions = directions.iter().map(|n| 0.45 * *n).collect();
    mesh
}

/// The same arm, extended by its second joint.
fn boned_arm(arm: &MorphMesh) -> Mesh {
    let mut rigid = arm.clone();
    rigid.targets.clear();
    let share = |p: &Vec3| {
        let pulled = (-p.x / 0.45).max(0.0).powi(8);
        [1.0 - pulled, pulled, 0.0, 0.0]
    };
    let weights: Vec<[f32; 4]> = arm.positions.iter().map(share).collect();
    let joints = vec![[0_u16, 1, 0, 0]; weights.len()];
    with_normals(&rigid)
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(joints))
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights)
}

fn spawn(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut bind_poses: ResMut<Assets<SkinnedMeshInverseBindposes>>,
    mut gizmos: ResMut<GizmoConfigStore>,
) {
    let arm = arm();
    let boned = meshes.add(boned_arm(&arm));
    let bind_poses = bind_poses.add(SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2]));
    let mesh = with_normals(&arm);
    let rest = Aabb::from_min_max(Vec3::splat(-0.45), Vec3::splat(0.45));
    let mesh = meshes.add(mesh);
    let colors = [Color::srgb(0.75, 0.5, 0.45), Color::srgb(0.4, 0.6, 0.5)].map(|color| materials.add(color));
    for (half, color) in [Half::Bevys, Half::Repaired].into_iter().zip(colors) {
        for index in 0..ARMS {
            let mut arm = commands.spawn((
                Arm(index),
                half,
                half.layer(),
                MeshMaterial3d(color.clone()),
                Transform::from_xyz(2.4, 1.8 - 1.2 * index as f32, 0.0),
            ));
            if index.is_multiple_of(2) {
                arm.insert((Mesh3d(mesh.clone()), MeshMorphWeights::Value { weights: vec![0.0] }));
            } else {
                let root = arm.id();
                let body = arm.commands_mut().spawn((Transform::default(), ChildOf(root))).id();
                let hand = (Hand(index), Transform::default(), ChildOf(root));
                let hand = arm.commands_mut().spawn(hand).id();
                let skin = SkinnedMesh {
                    inverse_bindposes: bind_poses.clone(),
                    joints: vec![body, hand],
                };
                arm.insert((Mesh3d(boned.clone()), skin));
            }
            if half == Half::Bevys {
                // As Bevy computes it, once, without the plugin.
                arm.insert((NoAutoAabb, rest));
            }
        }
    }
    gizmos.config_mut::<LeftBoxes>().0.render_layers = Half::Bevys.layer();
    gizmos.config_mut::<RightBoxes>().0.render_layers = Half::Repaired.layer();
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
                Half::Repaired.layer(),
            ));
        }
    }
}

fn reach(mut arms: Query<(&Arm, &mut MeshMorphWeights)>, mut hands: Query<(&Hand, &mut Transform)>, clock: Res<Clock>) {
    let share = |index: usize| {
        let phase = clock.frame as f32 / 60.0 + 0.8 * index as f32;
        0.75 + 0.25 * phase.sin()
    };
    for (&Arm(index), mut weights) in &mut arms {
        *weights = MeshMorphWeights::Value {
            weights: vec![share(index)],
        };
    }
    for (&Hand(index), mut place) in &mut hands {
        place.translation.x = -4.0 * share(index);
    }
}

/// Moves all arms aside until the balls they grow out of are out of sight, and back.
fn sway(mut arms: Query<(&Arm, &mut Transform), Without<Hand>>, clock: Res<Clock>) {
    for (&Arm(index), mut place) in &mut arms {
        let phase = PI * clock.frame as f32 / 90.0 + 0.1 * index as f32;
        place.translation.x = 1.8 + 2.0 * (0.5 - 0.5 * phase.cos());
    }
}

fn boxes(arms: Query<(&Half, &Aabb, &GlobalTransform)>, mut left: Gizmos<LeftBoxes>, mut right: Gizmos<RightBoxes>) {
    for (half, aabb, place) in &arms {
        let cube = Transform::from_translation(aabb.center.into()).with_scale((2.0 * aabb.half_extents).into());
        match half {
            Half::Bevys => left.cube(*place * cube, Color::srgb(0.7, 0.2, 0.1)),
            Half::Repaired => right.cube(*place * cube, Color::srgb(0.1, 0.4, 0.2)),
        };
    }
}

fn tell(arms: Query<(&Half, &ViewVisibility)>, mut notes: ResMut<Notes>) {
    let drawn = |wanted: Half| {
        let seen = arms
            .iter()
            .filter(|(half, visible)| **half == wanted && visible.get())
            .count();
        format!("{seen} of {ARMS}")
    };
    notes.0 = vec![
        ("drawn, left", drawn(Half::Bevys)),
        ("drawn, right", drawn(Half::Repaired)),
    ];
}
