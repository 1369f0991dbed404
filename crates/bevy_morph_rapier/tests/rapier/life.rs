//! Bodies on surfaces over time: blending, sleeping, waiting and jumps.

use std::path::Path;
use std::time::Duration;

use bevy::ecs::schedule::ScheduleLabel;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_models::generated::rigid;
use morph_collision_workspace::app::headless;
use morph_collision_workspace::physics::{DT, body, settle, sheet};

use crate::any_engine::moving::{stretch, stretching};
use crate::log::start;
use crate::support::{app, ball_on_sheet, diagnostics, place, run, set_weights, spawn, velocity};

/// A ball on a sheet that rises at 0.5/s by the clock, in an app that already sets when physics steps.
fn rising(mut app: App, frame: f32, frames: usize) -> (f32, f32, f32) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(frame)));
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let ball = body(&mut app, Collider::ball(0.3), Vec3::new(0.1, 0.31, 0.05));
    run(&mut app, (1.0 / frame) as usize);
    let mut height = 0.0;
    for _ in 0..frames {
        height += 0.5 * frame;
        set_weights(&mut app, surface, &[height, 0.0]);
        run(&mut app, 1);
    }
    (place(&app, ball).y - 0.3 - height, velocity(&app, ball).y, height)
}

#[test]
fn every_mode_of_time_carries() {
    let modes = [
        (TimestepMode::Fixed { dt: DT, substeps: 4 }, DT),
        (
            TimestepMode::Variable {
                max_dt: 0.1,
                time_scale: 1.0,
                substeps: 1,
            },
            1.0 / 45.0,
        ),
        (
            TimestepMode::Interpolated {
                dt: 1.0 / 120.0,
                time_scale: 1.0,
                substeps: 1,
            },
            1.0 / 30.0,
        ),
    ];
    for (mode, frame) in modes {
        let mut app = app();
        app.insert_resource(mode);
        let (gap, speed, _) = rising(app, frame, 60);
        // Interpolated physics may be up to a step ahead.
        assert!(gap.abs() < 1e-2, "{mode:?}: gap {gap}");
        assert!((speed - 0.5).abs() < 0.025, "{mode:?}: velocity {speed}");
    }
}

#[test]
fn paused_physics_waits() {
    let (mut app, surface, ball) = ball_on_sheet();
    let pause = |app: &mut App, active: bool| {
        let mut configurations = app.world_mut().query::<&mut RapierConfiguration>();
        configurations
            .single_mut(app.world_mut())
            .unwrap()
            .physics_pipeline_active = active;
    };
    pause(&mut app, false);
    set_weights(&mut app, surface, &[0.1, 0.0]);
    run(&mut app, 10);
    assert!((place(&app, ball).y - 0.3).abs() < 1e-2);
    pause(&mut app, true);
    run(&mut app, 60);
    assert!((place(&app, ball).y - 0.4).abs() < 1e-2, "{}", place(&app, ball));
}

#[test]
fn a_rigid_mesh_is_a_surface_like_any_other() {
    let mut app = app();
    let surface = spawn(&mut app, &rigid::box_mesh(Vec3::new(2.0, 0.5, 2.0)), ());
    settle(&mut app);
    let ball = body(&mut app, Collider::ball(0.3), Vec3::new(0.1, 0.9, 0.05));
    run(&mut app, 60);
    assert!((place(&app, ball).y - 0.8).abs() < 1e-2, "{}", place(&app, ball));
    assert_eq!(diagnostics(&app).blended, 0);
    assert!(app.world().get::<Collider>(surface).is_some());
}

/// The number of pairs of systems that conflict without an order, over all schedules.
fn ambiguities(app: &mut App) -> usize {
    start(app);
    app.update();
    let schedules = app.world().resource::<Schedules>();
    let conflicts = schedules
        .iter()
        .map(|(_, schedule)| schedule.graph().conflicting_systems().len());
    conflicts.sum()
}

/// A schedule of the game's own.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
struct Own;

#[test]
fn the_plugin_adds_no_ambiguous_order_of_systems() {
    let in_frames = |app: &mut App, plugin: RapierPhysicsPlugin| _ = app.add_plugins(plugin);
    let in_steps = |app: &mut App, plugin: RapierPhysicsPlugin| _ = app.add_plugins(plugin.in_fixed_schedule());
    // Whether steps are fixed is not known before the first one.
    let in_own = |app: &mut App, plugin: RapierPhysicsPlugin| {
        app.init_schedule(Own)
            .add_systems(FixedUpdate, |world: &mut World| world.run_schedule(Own))
            .add_plugins(plugin.in_schedule(Own));
    };
    let found = |app: &mut App| _ = app.add_plugins(MorphRapierPlugin);
    let named = |app: &mut App| _ = app.add_plugins(MorphRapierPlugin.in_schedule(FixedUpdate));
    type Added = (&'static str, fn(&mut App, RapierPhysicsPlugin), fn(&mut App));
    let schedules: [Added; 3] = [
        ("in frames", in_frames, found),
        ("in steps", in_steps, named),
        ("in a schedule of its own", in_own, found),
    ];
    for (name, add_rapier, add_ours) in schedules {
        let rapier = || {
            let mut app = headless(Path::new("."));
            add_rapier(&mut app, RapierPhysicsPlugin::default());
            app
        };
        let before = ambiguities(&mut rapier());
        let mut ours = rapier();
        add_ours(&mut ours);
        assert_eq!(ambiguities(&mut ours), before, "{name}");
    }
}

#[test]
fn physics_in_the_fixed_schedule_carries() {
    let mut app = headless(Path::new("."));
    app.add_plugins((
        RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
        MorphRapierPlugin.in_schedule(FixedUpdate),
    ))
    .insert_resource(TimestepMode::Fixed {
        dt: 1.0 / 64.0,
        substeps: 1,
    })
    // One frame in three has two steps.
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 48.0)));
    start(&mut app);
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let ball = body(&mut app, Collider::ball(0.3), Vec3::new(0.1, 0.31, 0.05));
    run(&mut app, 60);
    let rise = move |mut weights: Query<&mut MeshMorphWeights>, time: Res<Time>, mut height: Local<f32>| {
        *height += 0.5 * time.delta_secs();
        let weights_now = vec![*height, 0.0];
        *weights.get_mut(surface).unwrap() = MeshMorphWeights::Value { weights: weights_now };
    };
    app.add_systems(FixedUpdate, rise.before(PhysicsSet::SyncBackend));
    run(&mut app, 60);
    let speed = velocity(&app, ball).y;
    assert!((speed - 0.5).abs() < 0.025, "velocity {speed}");
}

#[test]
fn a_morphing_body_sleeps_when_nothing_morphs() {
    let mut app = app();
    app.world_mut()
        .spawn((Collider::cuboid(5.0, 1.0, 5.0), Transform::from_xyz(0.0, -1.0, 0.0)));
    let mut cube = rigid::box_mesh(Vec3::splat(0.5));
    cube.targets = vec![cube.positions.iter().map(|p| Vec3::Y * p.y).collect()];
    let parts = (
        RigidBody::Dynamic,
        Velocity::default(),
        Sleeping::default(),
        Transform::from_xyz(0.0, 0.6, 0.0),
    );
    let jelly = spawn(&mut app, &cube, parts);
    settle(&mut app);
    run(&mut app, 120);
    let asleep = |app: &App| app.world().get::<Sleeping>(jelly).unwrap().sleeping;
    assert!(asleep(&app) && (place(&app, jelly).y - 0.5).abs() < 1e-2);
    set_weights(&mut app, jelly, &[0.1]);
    run(&mut app, 1);
    assert!(!asleep(&app));
}

#[test]
fn a_scaled_surface_at_rest_is_as_large_as_it_looks() {
    let mut app = app();
    app.update();
    let scaled = |at: f32| Transform::from_xyz(at, 0.0, 0.0).with_scale(Vec3::new(2.0, 1.0, 3.0));
    let mesh = rigid::box_mesh(Vec3::splat(0.5));
    let fixed = spawn(&mut app, &mesh, scaled(0.0));
    let mass = ReadColliderMassProperties::default();
    let falling = spawn(
        &mut app,
        &mesh,
        (scaled(10.0), RigidBody::Dynamic, GravityScale(0.0), mass),
    );
    settle(&mut app);
    run(&mut app, 3);
    let hit = crate::support::ask(&mut app, |context| {
        context.cast_ray(Vec3::new(0.9, 5.0, 1.4), -Vec3::Y, 10.0, true, QueryFilter::default())
    });
    assert_eq!(hit.map(|(entity, _)| entity), Some(fixed));
    let mass = app.world().get::<ReadColliderMassProperties>(falling).unwrap().mass;
    assert!((mass - 6.0).abs() < 1e-3, "{mass}");
    // Scales it again.
    app.world_mut().get_mut::<Transform>(falling).unwrap().scale = Vec3::splat(2.0);
    run(&mut app, 3);
    let mass = app.world().get::<ReadColliderMassProperties>(falling).unwrap().mass;
    assert!((mass - 8.0).abs() < 1e-3, "{mass}");
}

#[test]
fn bodies_that_were_there_first_and_bodies_that_are_put_elsewhere_each_have_their_ground() {
    let mut app = app();
    let far = Vec3::new(100.0, 0.0, -50.0);
    let surface = spawn(&mut app, &stretching(), Transform::from_translation(far));
    let small = |app: &mut App, x: f32| {
        let cuboid = body(app, Collider::cuboid(0.1, 0.1, 0.1), far + Vec3::new(x, 0.11, 0.3));
        app.world_mut().entity_mut(cuboid).insert(Sleeping::disabled());
        cuboid
    };
    let cuboids = [-2.0, 1.0, 3.0].map(|x| (x, small(&mut app, x)));
    let thrown = small(&mut app, 0.5);
    settle(&mut app);
    for (x, cuboid) in cuboids {
        app.world_mut().get_mut::<Transform>(cuboid).unwrap().translation = far + Vec3::new(x, 0.11, 0.3);
        *app.world_mut().get_mut::<Velocity>(cuboid).unwrap() = Velocity::zero();
    }
    // From one end to the other.
    app.world_mut().get_mut::<Transform>(thrown).unwrap().translation = far + Vec3::new(-3.5, 0.11, -3.0);
    run(&mut app, 30);
    app.world_mut().get_mut::<Transform>(thrown).unwrap().translation = far + Vec3::new(3.5, 0.11, 3.0);
    stretch(&mut app, surface, &cuboids);
}

#[test]
fn after_a_jump_of_the_surface_each_body_has_its_own_ground_again() {
    let mut app = app();
    let surface = spawn(&mut app, &stretching(), ());
    settle(&mut app);
    let cuboids = [-2.0, 1.0, 3.0].map(|x| {
        let cuboid = body(&mut app, Collider::cuboid(0.1, 0.1, 0.1), Vec3::new(x, 0.11, 0.3));
        app.world_mut().entity_mut(cuboid).insert(Sleeping::disabled());
        (x, cuboid)
    });
    run(&mut app, 10);
    let jump = Vec3::new(50.0, 0.0, 0.0);
    for entity in cuboids.map(|(_, cuboid)| cuboid).into_iter().chain([surface]) {
        app.world_mut().get_mut::<Transform>(entity).unwrap().translation += jump;
    }
    run(&mut app, 30);
    stretch(&mut app, surface, &cuboids);
    assert_eq!(diagnostics(&app).parts, 3);
}
