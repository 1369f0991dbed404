//! The shape on the screen is the shape that the core library computes.

use bevy::ecs::system::RunSystemOnce;
use bevy::math::Affine3A;
use bevy::mesh::skinning::SkinnedMeshInverseBindposes;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::{dolphin, pass_through_body_at};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::view::stage::StageCamera;

use crate::support::{alone, character, drawn, is_covered, is_drawn, offscreen, scene, skeleton};

const SIZE: (u32, u32) = (480, 360);

/// Draws a mesh at weights that it has from the start, and compares the picture with the core library, in both
/// directions.
fn compare(mesh: MorphMesh, weights: &[f32], eye: Vec3, place: Transform) {
    compare_once_seen(mesh, weights, &[], eye, place, Visibility::Visible);
}

/// The same with a mesh that is hidden for its first frames, depending on `first`.
///
/// A mesh with a skin follows joints with these matrices.
fn compare_once_seen(
    mesh: MorphMesh,
    weights: &[f32],
    joints: &[Affine3A],
    eye: Vec3,
    place: Transform,
    first: Visibility,
) {
    let _alone = alone();
    let (own, joints) = (weights.to_vec(), joints.to_vec());
    let demo = scene(eye, move |app| {
        app.add_systems(
            Startup,
            move |mut commands: Commands,
                  mut meshes: ResMut<Assets<Mesh>>,
                  mut materials: ResMut<Assets<StandardMaterial>>,
                  mut bind_poses: ResMut<Assets<SkinnedMeshInverseBindposes>>| {
                let drawn = drawn(&mesh, own.clone(), &mut meshes, &mut materials);
                let skeleton = skeleton(&joints, &mut bind_poses, &mut commands);
                let mut body = commands.spawn((drawn, MorphCollider::default(), place, first));
                if mesh.skin.is_some() {
                    body.insert(skeleton);
                }
            },
        );
    });
    let mut demo = offscreen(demo, SIZE);
    demo.advance(3);
    let appear = |mut hidden: Query<&mut Visibility, With<MorphCollider>>| {
        hidden
            .iter_mut()
            .for_each(|mut visibility| *visibility = Visibility::Visible);
    };
    demo.app_mut().world_mut().run_system_once(appear).unwrap();
    demo.advance(3);
    let picture = demo.picture().unwrap();

    let near = |x: f32, y: f32| {
        let around = |v: f32, size: u32| {
            (v.floor() as i64 - 1..=v.floor() as i64 + 1).map(move |v| v.clamp(0, i64::from(size) - 1) as u32)
        };
        around(x, SIZE.0).flat_map(move |x| around(y, SIZE.1).map(move |y| (x, y)))
    };
    let (vertices, pixels) = demo
        .app_mut()
        .world_mut()
        .run_system_once(
            |camera: Single<(&Camera, &GlobalTransform), With<StageCamera>>,
             collider: Single<Entity, With<MorphCollider>>,
             spatial: MorphSpatialQuery| {
                let (camera, eye) = *camera;
                let vertices: Vec<Vec2> = spatial
                    .posed_vertices(*collider)
                    .unwrap()
                    .into_iter()
                    .map(|vertex| camera.world_to_viewport(eye, vertex).unwrap())
                    .collect();
                let mut pixels = Vec::new();
                for y in 0..SIZE.1 {
                    for x in 0..SIZE.0 {
                        let ray = camera
                            .viewport_to_world(eye, Vec2::new(x as f32 + 0.5, y as f32 + 0.5))
                            .unwrap();
                        let hit = spatial.cast_ray(ray.origin, ray.direction, 100.0, &MorphQueryFilter::default());
                        pixels.push(((x, y), hit.is_some()));
                    }
                }
                (vertices, pixels)
            },
        )
        .unwrap();

    for vertex in &vertices {
        assert!(
            near(vertex.x, vertex.y).any(|(x, y)| is_drawn(&picture, x, y)),
            "a vertex at {vertex} is not drawn"
        );
    }
    let (mut covered, mut narrow) = (0, 0);
    for ((x, y), hit) in pixels {
        let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
        let says = |wanted: bool| near(px, py).any(|(x, y)| is_drawn(&picture, x, y) == wanted);
        // A gap narrower than a pixel, as between toes, is drawn as an edge: partly covered.
        let gap = !hit && near(px, py).any(|(x, y)| !is_covered(&picture, x, y));
        assert!(
            says(hit) || gap,
            "pixel {x} {y}: the core says {hit}, and nothing around it is drawn so"
        );
        covered += u32::from(hit);
        narrow += u32::from(!says(hit));
    }
    assert!(narrow * 1000 <= covered, "{narrow} pixels are off, of {covered}");
    assert!(covered > 2000, "the model covers {covered} pixels");
}

#[test]
fn a_dolphin_at_rest() {
    compare(dolphin(1), &[0.0, 0.0], Vec3::new(0.5, 0.7, 2.2), Transform::default());
}

#[test]
fn a_dolphin_in_a_stroke_turned_and_stretched() {
    let place = Transform::from_xyz(0.1, -0.1, 0.0)
        .with_rotation(Quat::from_euler(EulerRot::XYZ, 0.4, 0.8, -0.3))
        .with_scale(Vec3::new(1.2, 0.8, 1.1));
    compare(dolphin(1), &[0.2, 0.9], Vec3::new(0.2, 0.5, 2.2), place);
}

#[test]
fn weights_below_zero_and_above_one() {
    compare(
        pass_through_body_at(3),
        &[1.7, -0.4],
        Vec3::new(0.0, 1.0, 4.0),
        Transform::default(),
    );
}

/// Bevy 0.20 draws such a mesh at rest; `MorphBoundsPlugin` fixes that.
#[test]
fn what_comes_into_view_later_is_drawn_as_it_is_morphed() {
    let eye = Vec3::new(0.0, 1.0, 4.0);
    let star = [1.0, 0.0];
    compare_once_seen(
        pass_through_body_at(3),
        &star,
        &[],
        eye,
        Transform::default(),
        Visibility::Hidden,
    );
}

/// The place of the mesh's own entity does not matter, because it is drawn where its joints are.
#[test]
fn a_character_that_crouches_and_talks() {
    for (seconds, turn) in [(0.0, 0.0), (1.1, 0.6), (1.5, -1.9)] {
        let (mesh, weights, joints) = character(seconds);
        let turn = Affine3A::from_rotation_y(turn);
        let joints: Vec<Affine3A> = joints.into_iter().map(|joint| turn * joint).collect();
        let elsewhere = Transform::from_xyz(0.3, -0.2, 0.1).with_rotation(Quat::from_rotation_z(0.4));
        let eye = Vec3::new(0.3, 0.4, 2.6);
        compare_once_seen(mesh, &weights, &joints, eye, elsewhere, Visibility::Visible);
    }
}
