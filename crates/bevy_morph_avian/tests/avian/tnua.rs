//! Characters of `bevy-tnua`.

use avian3d::prelude::*;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use bevy_morph_avian::prelude::*;
use bevy_tnua::builtins::TnuaBuiltinWalkConfig;
use bevy_tnua::prelude::*;
use bevy_tnua::{
    TnuaGhostSensor, TnuaMotor, TnuaProximitySensor, TnuaProximitySensorOutput, TnuaRigidBodyTracker, TnuaSensorOf,
    TnuaSystems,
};
use morph_collision_workspace::physics::{settle, sheet};

use crate::log::start;
use crate::support::{DT, place, run, set_weights, spawn, unfinished, velocity};

#[derive(TnuaScheme)]
#[scheme(basis = TnuaBuiltinWalk)]
enum Controls {}

/// What `bevy-tnua-avian3d` does for a character with a ray: it reads the body, casts, and moves the body.
fn backend(app: &mut App, schedule: InternedScheduleLabel) {
    let systems = (
        (track, cast).chain().in_set(TnuaPipelineSystems::Sensors),
        apply.in_set(TnuaPipelineSystems::Motors),
    );
    app.configure_sets(schedule, TnuaSystems.before(PhysicsStepSystems::First))
        .add_systems(schedule, systems);
}

fn track(
    mut bodies: Query<(
        &Position,
        &Rotation,
        &LinearVelocity,
        &AngularVelocity,
        &mut TnuaRigidBodyTracker,
    )>,
    gravity: Res<Gravity>,
) {
    for (position, rotation, linear, angular, mut tracker) in &mut bodies {
        *tracker = TnuaRigidBodyTracker {
            translation: position.0,
            rotation: rotation.0,
            velocity: linear.0,
            angvel: angular.0,
            gravity: gravity.0,
        };
    }
}

fn cast(
    mut sensors: Query<(&mut TnuaProximitySensor, &TnuaSensorOf)>,
    owners: Query<(&Position, &Rotation)>,
    bodies: Query<(&LinearVelocity, &AngularVelocity)>,
    space: SpatialQuery,
) {
    for (mut sensor, of) in &mut sensors {
        let (position, rotation) = owners.get(of.0).unwrap();
        let origin = position.0 + *rotation * sensor.cast_origin;
        let filter = SpatialQueryFilter::from_excluded_entities([of.0]);
        let hit = space.cast_ray(origin, sensor.cast_direction, sensor.cast_range, true, &filter);
        sensor.output = hit.map(|hit| {
            let (linear, angular) = bodies.get(hit.entity).map_or_else(|_| default(), |(v, w)| (v.0, w.0));
            TnuaProximitySensorOutput {
                entity: hit.entity,
                proximity: hit.distance,
                normal: Dir3::new(hit.normal).unwrap(),
                entity_linvel: linear,
                entity_angvel: angular,
            }
        });
    }
}

fn apply(mut bodies: Query<(&TnuaMotor, Forces)>) {
    for (motor, mut forces) in &mut bodies {
        *forces.linear_velocity_mut() += motor.lin.boost;
        forces.apply_linear_acceleration(motor.lin.acceleration);
    }
}

/// A sheet, and a character that floats on it. Tnua's systems run in `schedule`.
fn on_a_sheet(schedule: impl ScheduleLabel, with_ours: bool) -> (App, Entity, Entity) {
    let schedule = schedule.intern();
    let mut app = unfinished();
    if with_ours {
        app.add_plugins(MorphTnuaPlugin::new(schedule));
    }
    app.add_plugins(TnuaControllerPlugin::<Controls>::new(schedule));
    backend(&mut app, schedule);
    start(&mut app);
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let config = ControlsConfig {
        basis: TnuaBuiltinWalkConfig {
            speed: 1.0,
            float_height: 1.0,
            ..default()
        },
    };
    let config = app.world_mut().resource_mut::<Assets<ControlsConfig>>().add(config);
    let parts = (
        RigidBody::Dynamic,
        Collider::capsule(0.3, 1.0),
        LockedAxes::ROTATION_LOCKED,
        TnuaController::<Controls>::default(),
        TnuaConfig::<Controls>(config),
        Transform::from_xyz(-1.0, 1.0, 0.05),
    );
    let character = app.world_mut().spawn(parts).id();
    run(&mut app, 60);
    let height = place(&app, character).y;
    assert!((height - 1.0).abs() < 0.05, "it floats at {height}");
    (app, surface, character)
}

#[test]
fn a_floating_character_is_carried() {
    for schedule in [PhysicsSchedule.intern(), FixedUpdate.intern()] {
        for (rise, slide, walk) in [
            (0.0, 1.0, 0.0),
            (1.0, 0.0, 0.0),
            (0.5, 1.0, 1.0),
            (-0.5, 0.5, 0.0),
            (0.0, 0.0, 1.0),
        ] {
            let (mut app, surface, character) = on_a_sheet(schedule, true);
            let mut controller = app.world_mut().get_mut::<TnuaController<Controls>>(character).unwrap();
            controller.basis.desired_motion = Vec3::Z * walk;
            let begin = place(&app, character);
            for i in 1..=120 {
                let time = DT * i as f32;
                set_weights(&mut app, surface, &[rise * time, slide * time]);
                run(&mut app, 1);
            }
            let case = format!("{schedule:?}: rises at {rise}, slides at {slide}, walks at {walk}");
            let controller = app.world().get::<TnuaController<Controls>>(character).unwrap();
            assert_eq!(controller.basis_memory.standing_on_entity(), Some(surface), "{case}");
            let expected = Vec3::new(slide, rise, walk);
            let now = velocity(&app, character);
            assert!(now.distance(expected) < 0.01, "{case}: moves at {now}");
            // Tnua feels that the surface starts one step late, and accelerates.
            let moved = place(&app, character) - begin;
            assert!(moved.distance(2.0 * expected) < 0.1, "{case}: moved by {moved}");
        }
    }
}

#[test]
fn without_the_plugin_a_surface_slides_away_below_a_floating_character() {
    let (mut app, surface, character) = on_a_sheet(PhysicsSchedule, false);
    for i in 1..=60 {
        set_weights(&mut app, surface, &[0.0, DT * i as f32]);
        run(&mut app, 1);
    }
    let x = place(&app, character).x;
    assert!((x + 1.0).abs() < 1e-3, "{x}");
}

/// The velocity that a sensor gets for a hit at `(x, 0, 0)`, as an output and as a ghost, if Tnua's backend has written `Vec3::Z`. `frame` runs a
/// frame.
fn sensed(app: &mut App, x: f32, entity: Entity, mut frame: impl FnMut(&mut App)) -> Vec3 {
    let at = Transform::from_xyz(0.0, 2.0, 0.0).with_scale(Vec3::splat(0.5));
    let owner = app
        .world_mut()
        .spawn((RigidBody::Static, Collider::sphere(0.1), at))
        .id();
    let hit = TnuaProximitySensorOutput {
        entity,
        proximity: 1.0,
        normal: Dir3::Y,
        entity_linvel: Vec3::Z,
        entity_angvel: Vec3::ZERO,
    };
    let sensor = TnuaProximitySensor {
        // The owner's scale halves it.
        cast_origin: Vec3::new(2.0 * x, -2.0, 0.0),
        output: Some(hit.clone()),
        ..default()
    };
    let sensor = (sensor, TnuaGhostSensor(vec![hit]), TnuaSensorOf(owner));
    let sensor = app.world_mut().spawn(sensor).id();
    frame(app);
    frame(app);
    let output = app.world().get::<TnuaProximitySensor>(sensor).unwrap().output.clone();
    let ghosts = &app.world().get::<TnuaGhostSensor>(sensor).unwrap().0;
    let (output, ghost) = (output.unwrap().entity_linvel, ghosts[0].entity_linvel);
    assert_eq!(output, ghost);
    output
}

#[test]
fn a_sensor_gets_the_velocity_of_the_point_that_it_hits() {
    let mut app = unfinished();
    app.add_plugins(MorphTnuaPlugin::new(FixedUpdate));
    start(&mut app);
    // Stretches along X.
    let mut mesh = sheet(16);
    mesh.targets[1] = mesh.positions.iter().map(|at| Vec3::X * at.x).collect();
    let surface = spawn(&mut app, &mesh, ());
    let carried = spawn(&mut app, &mesh, (RigidBody::Dynamic, GravityScale(0.0)));
    app.world_mut()
        .entity_mut(carried)
        .insert(Transform::from_xyz(0.0, 50.0, 0.0));
    let floor = (RigidBody::Static, Collider::cuboid(8.0, 1.0, 8.0));
    let floor = app.world_mut().spawn((floor, Transform::from_xyz(0.0, -5.0, 0.0))).id();
    settle(&mut app);
    let mut time = 0.0;
    let mut frame = |app: &mut App| {
        time += DT;
        for surface in [surface, carried] {
            set_weights(app, surface, &[0.0, 0.3 * time]);
        }
        run(app, 1);
        1.0 + 0.3 * time
    };
    for x in [-2.0, 0.5, 3.0] {
        let mut stretched = 0.0;
        let velocity = sensed(&mut app, x, surface, |app| stretched = frame(app));
        let expected = Vec3::X * 0.3 * x / stretched;
        assert!(velocity.distance(expected) < 0.02, "at {x}: {velocity}, not {expected}");
    }
    // What is no surface, or is on a dynamic body, keeps what the backend wrote.
    for other in [floor, carried] {
        let velocity = sensed(&mut app, 1.0, other, |app| {
            frame(app);
        });
        assert_eq!(velocity, Vec3::Z);
    }
}
