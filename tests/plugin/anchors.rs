//! Entities that stick to a morphing surface.

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::support::{
    Edits, add_mesh, app, cube, fixed_app, move_to, set_weight, settle, spawn, stretching_cube, touches,
};

/// A stretching cube, and the index of its triangle that faces +X.
fn cube_and_side() -> (App, Entity, u32) {
    cube_and_side_in(app())
}

fn cube_and_side_in(mut app: App) -> (App, Entity, u32) {
    let mesh = add_mesh(&mut app, &stretching_cube());
    let cube = spawn(&mut app, &mesh, 0.0);
    settle(&mut app);
    let shape = stretching_cube();
    let faces_x = |t: &[u32; 3]| t.iter().all(|&corner| shape.positions[corner as usize].x > 0.0);
    let side = shape.triangles.iter().position(faces_x).expect("a cube has that side");
    (app, cube, side as u32)
}

fn place_of(app: &App, entity: Entity) -> Vec3 {
    app.world().get::<GlobalTransform>(entity).unwrap().translation()
}

#[test]
fn a_hat_goes_with_the_morph_and_with_the_body_in_the_same_frame() {
    let (mut app, cube, side) = cube_and_side();
    let anchor = MorphSurfaceAnchor::new(cube, side, Vec3::splat(1.0 / 3.0)).with_offset(0.25);
    let hat = app.spawn(anchor);
    let feather = app.spawn((Transform::from_xyz(0.0, 0.5, 0.0), ChildOf(hat)));
    for (weight, x) in [(0.0, 0.0), (1.0, 0.0), (-0.25, 2.0), (2.0, -3.0)] {
        set_weight(&mut app, cube, weight);
        move_to(&mut app, cube, x);
        app.update();
        let surface = x + 0.5 + weight;
        assert!(
            (place_of(&app, hat).x - (surface + 0.25)).abs() < 1e-5,
            "{:?}",
            place_of(&app, hat)
        );
        // +Y of the hat points out of the surface: +X.
        assert!(
            (place_of(&app, feather).x - (surface + 0.75)).abs() < 1e-5,
            "{:?}",
            place_of(&app, feather)
        );
    }
}

#[test]
fn a_child_of_the_body_is_placed_relative_to_it() {
    let (mut app, cube, side) = cube_and_side();
    let mut anchor = MorphSurfaceAnchor::new(cube, side, Vec3::X);
    anchor.align = false;
    let scaled = Transform::from_xyz(1.0, 2.0, 3.0)
        .with_rotation(Quat::from_rotation_y(0.7))
        .with_scale(Vec3::splat(2.0));
    app.insert(cube, scaled);
    let decal = (anchor, Transform::from_scale(Vec3::splat(0.1)), ChildOf(cube));
    let decal = app.spawn(decal);
    set_weight(&mut app, cube, 0.5);
    app.update();
    app.update();
    let shape = stretching_cube();
    let corner = shape.triangles[side as usize][0];
    let expected = shape.posed(&[0.5])[corner as usize];
    let local = app.world().get::<Transform>(decal).unwrap();
    assert!(local.translation.distance(expected) < 1e-5, "{local:?}");
    assert_eq!((local.scale, local.rotation), (Vec3::splat(0.1), Quat::IDENTITY));
    assert!(place_of(&app, decal).distance(scaled.transform_point(expected)) < 1e-5);
}

#[test]
fn an_anchor_without_a_surface_stays_where_it_is() {
    let (mut app, cube, _) = cube_and_side();
    let nobody = app.world_mut().spawn_empty().id();
    let at = Transform::from_xyz(7.0, 8.0, 9.0);
    for anchor in [
        MorphSurfaceAnchor::new(cube, 999, Vec3::X),
        MorphSurfaceAnchor::new(nobody, 0, Vec3::X),
    ] {
        let stuck = app.spawn((anchor, at));
        app.update();
        assert_eq!(app.world().get::<Transform>(stuck), Some(&at));
    }
}

#[test]
fn an_anchor_at_rest_is_not_written() {
    let (mut app, cube, side) = cube_and_side();
    app.spawn(MorphSurfaceAnchor::new(cube, side, Vec3::splat(1.0 / 3.0)));
    app.update();
    app.update();
    #[derive(Resource, Default)]
    struct Written(usize);
    app.init_resource::<Written>().add_systems(
        Last,
        |moved: Query<(), (With<MorphSurfaceAnchor>, Changed<Transform>)>, mut written: ResMut<Written>| {
            written.0 += moved.iter().count();
        },
    );
    app.update();
    let first = app.world().resource::<Written>().0;
    for _ in 0..3 {
        app.update();
    }
    assert_eq!(app.world().resource::<Written>().0, first);
    set_weight(&mut app, cube, 1.0);
    app.update();
    assert_eq!(app.world().resource::<Written>().0, first + 1);
}

#[test]
fn on_a_stretched_or_mirrored_body_up_is_still_along_the_normal() {
    let (mut app, cube, side) = cube_and_side();
    for scale in [
        Vec3::new(1.0, 3.0, 1.0),
        Vec3::new(-1.0, 1.0, 2.0),
        Vec3::new(0.5, -2.0, -1.0),
    ] {
        let body = Transform::from_xyz(1.0, 2.0, 3.0)
            .with_rotation(Quat::from_euler(EulerRot::XYZ, 0.4, 0.9, -0.3))
            .with_scale(scale);
        app.insert(cube, body);
        // A parent that stretches across the surface's directions.
        let parent = Transform::from_rotation(Quat::from_rotation_z(0.8)).with_scale(scale.yzx());
        let parent = app.spawn(parent);
        for parent in [cube, parent] {
            let anchor = MorphSurfaceAnchor::new(cube, side, Vec3::splat(1.0 / 3.0));
            let hat = app.spawn((anchor, ChildOf(parent)));
            app.update();
            let shape = stretching_cube();
            let corners = shape.triangles[side as usize].map(|corner| shape.positions[corner as usize]);
            let [a, b, c] = corners.map(|corner| body.transform_point(corner));
            let normal = (b - a).cross(c - a).normalize();
            let place = app.world().get::<GlobalTransform>(hat).unwrap().affine();
            let up = place.transform_vector3(Vec3::Y).normalize();
            assert!(up.distance(normal) < 1e-4, "{up} is not {normal} at {scale}");
            assert!(Vec3::from(place.translation).distance((a + b + c) / 3.0) < 1e-4);
            let local = app.world().get::<Transform>(hat).unwrap();
            assert!((local.rotation.length() - 1.0).abs() < 1e-5 && local.scale == Vec3::ONE);
            app.world_mut().despawn(hat);
        }
    }
}

#[test]
fn an_anchor_below_an_anchor_is_right_in_the_same_frame() {
    let (mut app, cube, side) = cube_and_side();
    let at = |barycentrics| MorphSurfaceAnchor::new(cube, side, barycentrics);
    // The lower one is spawned first.
    let below = app.spawn(at(Vec3::X));
    let above = app.spawn(at(Vec3::Y));
    app.insert(below, ChildOf(above));
    for weight in [0.5, 1.5, -0.25] {
        set_weight(&mut app, cube, weight);
        app.update();
        let shape = stretching_cube();
        let [first, second, _] = shape.triangles[side as usize].map(|corner| shape.posed(&[weight])[corner as usize]);
        assert!(place_of(&app, above).distance(second) < 1e-5);
        assert!(place_of(&app, below).distance(first) < 1e-5);
    }
}

/// An anchor in the middle of the side that faces +X, which is at `x + 0.5 + weight`.
fn spawn_hat(app: &mut App, cube: Entity, side: u32) -> Entity {
    let anchor = MorphSurfaceAnchor::new(cube, side, Vec3::splat(1.0 / 3.0));
    app.spawn(anchor)
}

/// Moves and morphs the cube a little further with each frame, and checks that the hat keeps up.
fn keeps_up(app: &mut App, cube: Entity, hat: Entity) {
    for frame in 0..20 {
        let (weight, x) = (0.05 * frame as f32, -0.125 * frame as f32);
        set_weight(app, cube, weight);
        move_to(app, cube, x);
        app.update();
        let (hat, surface) = (place_of(app, hat).x, x + 0.5 + weight);
        assert!((hat - surface).abs() < 1e-5, "frame {frame}: {hat} is not {surface}");
    }
}

#[test]
fn a_hat_follows_in_every_frame_when_collisions_are_found_in_a_fixed_schedule() {
    for (frames_per_tick, ticks_per_frame) in [(1, 1), (3, 1), (1, 2)] {
        let (mut app, cube, side) = cube_and_side_in(fixed_app(frames_per_tick, ticks_per_frame));
        let hat = spawn_hat(&mut app, cube, side);
        keeps_up(&mut app, cube, hat);
    }
}

#[test]
fn a_hat_follows_what_is_drawn_while_collisions_are_paused_or_its_collider_is_disabled() {
    let (mut app, cube, side) = cube_and_side();
    let hat = spawn_hat(&mut app, cube, side);
    app.settings().paused = true;
    keeps_up(&mut app, cube, hat);
    app.settings().paused = false;
    app.insert(cube, MorphColliderDisabled);
    app.update();
    keeps_up(&mut app, cube, hat);
}

#[test]
fn following_between_ticks_takes_nothing_from_collisions() {
    let (mut app, cube_, side) = cube_and_side_in(fixed_app(4, 1));
    let rigid = add_mesh(&mut app, &cube());
    let other = spawn(&mut app, &rigid, 1.75);
    let hat = spawn_hat(&mut app, cube_, side);
    #[derive(Resource, Default)]
    struct Ticks(u32);
    app.init_resource::<Ticks>()
        .add_systems(FixedUpdate, |mut ticks: ResMut<Ticks>| ticks.0 += 1);
    settle(&mut app);
    for _ in 0..8 {
        app.update();
    }
    let ticks = |app: &App| app.world().resource::<Ticks>().0;
    let reach = |app: &mut App| {
        let cast = move |spatial: MorphSpatialQuery| {
            let filter = MorphQueryFilter::from_excluded_entities([other]);
            let hit = spatial.cast_ray(Vec3::new(9.0, 0.1, 0.2), Dir3::NEG_X, 100.0, &filter);
            hit.map(|hit| 9.0 - hit.distance)
        };
        app.world_mut()
            .run_system_once(cast)
            .unwrap()
            .expect("the cube is there")
    };
    let mut between = 0;
    let mut found = 0.0;
    for round in 0..6 {
        let weight = [1.0, 0.0][round % 2];
        set_weight(&mut app, cube_, weight);
        let mut tick = ticks(&app);
        for _ in 0..4 {
            app.update();
            assert!((place_of(&app, hat).x - (0.5 + weight)).abs() < 1e-5);
            if ticks(&app) == tick {
                // Contacts and queries agree, because both are from the last run.
                between += 1;
            } else {
                // In a game, animation comes after the tick of its frame; the test sets weights
                // before it.
                found = weight;
                tick = ticks(&app);
            }
            assert!((reach(&mut app) - (0.5 + found)).abs() < 1e-5, "round {round}");
            assert_eq!(touches(&app, cube_, other), found == 1.0, "round {round}");
        }
        assert_eq!(found, weight, "there was a tick");
    }
    assert!(between > 6);
}

#[test]
fn an_anchor_to_a_shape_or_to_a_mesh_without_a_tree_is_not_written() {
    let (mut app, cube_, side) = cube_and_side();
    let shape = (MorphShape::default(), Transform::from_xyz(3.0, 0.0, 0.0));
    let shape = app.spawn(shape);
    app.insert(cube_, MorphShape::default());
    let unloaded = app.world().resource::<Assets<Mesh>>().reserve_handle();
    let unloaded = spawn(&mut app, &unloaded, 0.0);
    let at = Transform::from_xyz(7.0, 8.0, 9.0);
    for collider in [shape, cube_, unloaded] {
        let hat = spawn_hat(&mut app, collider, side);
        app.insert(hat, at);
        app.update();
        app.update();
        assert_eq!(app.world().get::<Transform>(hat), Some(&at));
    }
    app.remove::<MorphShape>(cube_);
    let hat = spawn_hat(&mut app, cube_, side);
    keeps_up(&mut app, cube_, hat);
}

#[test]
fn bad_weights_leave_a_hat_where_the_last_good_ones_put_it() {
    let (mut app, cube, side) = cube_and_side();
    let hat = spawn_hat(&mut app, cube, side);
    set_weight(&mut app, cube, 0.75);
    app.update();
    set_weight(&mut app, cube, f32::NAN);
    move_to(&mut app, cube, 2.0);
    app.update();
    assert!((place_of(&app, hat).x - 3.25).abs() < 1e-5, "{:?}", place_of(&app, hat));
}
