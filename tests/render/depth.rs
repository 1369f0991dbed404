//! The overlay lies on the surface that the GPU blends: moved slightly towards the camera all of it is visible, moved slightly
//! away none is.

use bevy::math::Affine3A;
use bevy::mesh::skinning::SkinnedMeshInverseBindposes;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::pass_through_body_at;
use morph_collision_workspace::view::Demo;
use morph_collision_workspace::view::overlay::Overlay;

use crate::support::{alone, character, count, drawn, is_red, offscreen, scene, skeleton};

const EYE: Vec3 = Vec3::new(0.4, 0.6, 4.0);

/// How far it is moved, in world units. The bodies are 2 across, and a pixel is about 0.01.
const LITTLE: f32 = 0.0005;

#[test]
fn the_overlay_lies_on_the_drawn_surface() {
    let _alone = alone();
    let demo = scene(EYE, |app| {
        app.add_systems(
            Startup,
            |mut commands: Commands,
             mut meshes: ResMut<Assets<Mesh>>,
             mut materials: ResMut<Assets<StandardMaterial>>| {
                let mesh = pass_through_body_at(4);
                for (side, weights) in [(-1.0, vec![0.7, 0.2]), (1.0, vec![0.1, 0.6])] {
                    let drawn = drawn(&mesh, weights, &mut meshes, &mut materials);
                    let turned = Quat::from_rotation_y(0.7 * side);
                    let place = Transform::from_xyz(0.35 * side, 0.0, 0.0).with_rotation(turned);
                    commands.spawn((drawn, MorphCollider::default(), place));
                }
            },
        );
    });
    lies_on_the_surface(demo);
}

/// Two characters that stand in each other.
#[test]
fn the_overlay_lies_on_characters_that_are_skinned_and_morphed() {
    let _alone = alone();
    let demo = scene(EYE, |app| {
        app.add_systems(
            Startup,
            |mut commands: Commands,
             mut meshes: ResMut<Assets<Mesh>>,
             mut materials: ResMut<Assets<StandardMaterial>>,
             mut bind_poses: ResMut<Assets<SkinnedMeshInverseBindposes>>| {
                for (side, seconds) in [(-1.0, 0.0), (1.0, 0.3)] {
                    let (mesh, weights, joints) = character(seconds);
                    let drawn = drawn(&mesh, weights, &mut meshes, &mut materials);
                    let turned = Quat::from_rotation_y(0.5 * side);
                    let aside = Vec3::new(0.08 * side, 0.0, 0.0);
                    let aside = Affine3A::from_scale_rotation_translation(Vec3::splat(1.9), turned, aside);
                    let joints: Vec<Affine3A> = joints.into_iter().map(|joint| aside * joint).collect();
                    let skeleton = skeleton(&joints, &mut bind_poses, &mut commands);
                    commands.spawn((drawn, MorphCollider::default(), Transform::default(), skeleton));
                }
            },
        );
    });
    lies_on_the_surface(demo);
}

fn lies_on_the_surface(demo: Demo) {
    let mut demo = offscreen(demo, (480, 360));
    let mut red = |towards: f32| {
        demo.app_mut().world_mut().resource_mut::<Overlay>().offset = EYE.normalize() * towards;
        demo.advance(1);
        count(&demo.picture().unwrap(), is_red)
    };
    let (on_it, nearer, farther) = (red(0.0), red(LITTLE), red(-LITTLE));
    assert!(on_it > 200, "{on_it} pixels of overlay");
    println!("{on_it} pixels of overlay on the surface, {nearer} before it, {farther} behind");
    // Where the bodies intersect at a small angle, a small offset changes what the other body covers.
    assert!(
        on_it.abs_diff(nearer) * 20 < nearer,
        "{on_it} on the surface, {nearer} before it"
    );
    assert!(
        farther * 50 < on_it,
        "{farther} pixels are seen through the surface, of {on_it}"
    );
}
