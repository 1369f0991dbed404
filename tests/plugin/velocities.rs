//! The velocity of surfaces where rays hit them.

use std::time::Duration;

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::STEP;

use crate::support::{Edits, add_mesh, app, cube, fixed_app, move_to, set_weight, settle, spawn, stretching_cube};

const PER_FRAME: f32 = 1.0 / 60.0;

/// The velocity at the hit of a ray straight down, and at the closest point. Both are the same.
fn below(app: &mut App, x: f32) -> Option<Vec3> {
    let system = move |spatial: MorphSpatialQuery| {
        let (from, filter) = (Vec3::new(x, 4.0, 0.1), MorphQueryFilter::default());
        let hit = spatial.cast_ray(from, Dir3::NEG_Y, 100.0, &filter).unwrap();
        let closest = spatial.project_point(hit.point, 1.0, &filter).unwrap();
        let velocity = hit.velocity(&spatial);
        let of_closest = closest.velocity(&spatial);
        let difference = velocity.unwrap_or_default().distance(of_closest.unwrap_or_default());
        assert!(difference < 1e-3 && velocity.is_some() == of_closest.is_some());
        velocity
    };
    app.world_mut().run_system_once(system).unwrap()
}

#[track_caller]
fn assert_near(velocity: Option<Vec3>, expected: Vec3) {
    let velocity = velocity.expect("it was there before");
    assert!(velocity.distance(expected) < 1e-3, "{velocity}, not {expected}");
}

#[test]
fn it_is_the_motion_of_the_entity_and_the_morph_together() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &stretching_cube());
    let cube = spawn(&mut app, &mesh, 0.0);
    set_weight(&mut app, cube, 0.0);
    settle(&mut app);
    app.update();
    assert_near(below(&mut app, 0.1), Vec3::ZERO);
    move_to(&mut app, cube, 2.0 * PER_FRAME);
    app.update();
    assert_near(below(&mut app, 0.1), Vec3::X * 2.0);
    // Its end at +X moves by 6 per second, the half-way point half as fast.
    set_weight(&mut app, cube, 6.0 * PER_FRAME);
    app.update();
    let middle = 2.0 * PER_FRAME + 3.0 * PER_FRAME;
    assert_near(below(&mut app, middle), Vec3::X * 3.0);
    set_weight(&mut app, cube, 0.0);
    move_to(&mut app, cube, 0.0);
    app.update();
    assert_near(below(&mut app, 0.0), Vec3::X * -5.0);
    // At rest again, queried a second time.
    app.update();
    assert_near(below(&mut app, 0.0), Vec3::ZERO);
    assert_near(below(&mut app, 0.3), Vec3::ZERO);
}

#[test]
fn it_is_none_where_there_is_nothing_to_compare_with() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let cube = spawn(&mut app, &mesh, 0.0);
    while app
        .world_mut()
        .run_system_once(move |spatial: MorphSpatialQuery| spatial.bounds(cube).is_none())
        .unwrap()
    {
        app.update();
    }
    assert_eq!(below(&mut app, 0.1), None, "this is its first run");
    app.update();
    assert_near(below(&mut app, 0.1), Vec3::ZERO);
    // Disabled for a run, then back at another place.
    app.insert(cube, MorphColliderDisabled);
    app.update();
    app.remove::<MorphColliderDisabled>(cube);
    move_to(&mut app, cube, 0.2);
    app.update();
    assert_eq!(below(&mut app, 0.1), None, "it was not there in the run before");
    // The same holds for an entity that was disabled without being queried.
    app.update();
    app.insert(cube, bevy::ecs::entity_disabling::Disabled);
    app.update();
    app.remove::<bevy::ecs::entity_disabling::Disabled>(cube);
    app.update();
    assert_eq!(below(&mut app, 0.1), None, "nor then");
    app.update();
    // No time passes.
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    move_to(&mut app, cube, 0.0);
    app.update();
    app.update();
    assert_eq!(below(&mut app, 0.1), None, "no time has passed");
    app.insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
    // Another mesh.
    let other = add_mesh(&mut app, &stretching_cube());
    app.insert(cube, Mesh3d(other));
    settle(&mut app);
    app.update();
    assert_near(below(&mut app, 0.1), Vec3::ZERO);
    let no_triangle = move |spatial: MorphSpatialQuery| {
        let nobody = spatial.surface_velocity(Entity::PLACEHOLDER, 0, Vec3::X);
        (nobody, spatial.surface_velocity(cube, 1_000_000, Vec3::X))
    };
    let answers = app.world_mut().run_system_once(no_triangle).unwrap();
    assert_eq!(answers, (None, None));
}

#[test]
fn a_swapped_mesh_has_no_velocity_in_its_first_run() {
    let mut app = app();
    let (small, large) = (add_mesh(&mut app, &cube()), add_mesh(&mut app, &stretching_cube()));
    let swapped = spawn(&mut app, &small, 0.0);
    // Its tree is kept ready.
    spawn(&mut app, &large, 50.0);
    settle(&mut app);
    app.update();
    app.insert(swapped, Mesh3d(large));
    app.update();
    assert_eq!(below(&mut app, 0.1), None);
    app.update();
    assert_near(below(&mut app, 0.1), Vec3::ZERO);
}

#[test]
fn in_a_fixed_schedule_it_is_per_second_of_that_schedule() {
    for (frames, ticks) in [(2, 1), (1, 3)] {
        let mut app = fixed_app(frames, ticks);
        let mesh = add_mesh(&mut app, &cube());
        let cube = spawn(&mut app, &mesh, 0.0);
        settle(&mut app);
        for _ in 0..6 {
            app.update();
        }
        let timestep = Time::<Fixed>::default().timestep().as_secs_f32();
        app.add_systems(FixedUpdate, move |mut places: Query<&mut Transform>| {
            places.get_mut(cube).unwrap().translation.x += 0.01;
        });
        for _ in 0..4 {
            app.update();
        }
        let x = app.world().get::<Transform>(cube).unwrap().translation.x;
        assert_near(below(&mut app, x), Vec3::X * 0.01 / timestep);
    }
}
