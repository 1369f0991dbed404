//! Surfaces near which nothing is.

use bevy::prelude::*;
use bevy_morph_collision::components::MorphTeleported;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::physics::{settle, sheet};

use crate::support::{
    DT, DYNAMIC, GravityScale, app, ball, body, diagnostics, flying, place, run, set_weights, spawn, velocity,
};

/// A sheet that is turned, so that its box has two corners without triangles.
fn slope() -> MorphMesh {
    let mut mesh = sheet(16);
    let turn = Quat::from_rotation_z(0.7);
    for position in &mut mesh.positions {
        *position = turn * *position;
    }
    mesh
}

/// What happens while a ball comes to the slope.
#[derive(Clone, Copy, Debug)]
enum Event {
    Nothing,
    /// The surface is put elsewhere in this frame.
    Teleport(usize),
    /// Time stands still for some frames from this one on.
    Pause(usize),
}

/// The places and velocities of a ball that comes to a slope which moves all the time. If a `guard` hovers in an empty corner of the
/// slope's box, the slope cannot sleep.
fn fly(guard: bool, speed: f32, event: Event) -> (Vec<[Vec3; 2]>, Vec<u32>) {
    let mut app = app();
    let slope = spawn(&mut app, &slope(), Transform::default());
    settle(&mut app);
    let hovering = |velocity: Vec3| (DYNAMIC, GravityScale(0.0), flying(velocity));
    let start = Vec3::new(0.05, 6.0, 0.03);
    let ball_at = (
        ball(0.1),
        Transform::from_translation(start),
        hovering(Vec3::NEG_Y * speed),
    );
    let ball_in_flight = app.world_mut().spawn(ball_at).id();
    if guard {
        let corner = Transform::from_xyz(2.2, -2.0, 0.0);
        app.world_mut().spawn((ball(0.05), corner, hovering(Vec3::ZERO)));
    }
    let (mut states, mut awake, mut time) = (Vec::new(), Vec::new(), 0.0_f32);
    let frames = (8.0 / speed / DT) as usize;
    for frame in 0..frames.max(30) {
        time += DT;
        match event {
            Event::Teleport(at) if frame == at => {
                let place = Transform::from_xyz(0.0, 0.3, 0.0);
                app.world_mut().entity_mut(slope).insert((place, MorphTeleported));
            }
            Event::Pause(at) if frame == at => app.world_mut().resource_mut::<Time<Virtual>>().pause(),
            Event::Pause(at) if frame == at + 10 => app.world_mut().resource_mut::<Time<Virtual>>().unpause(),
            _ => {}
        }
        set_weights(&mut app, slope, &[0.2 * (3.0 * time).sin(), 0.2 * (2.0 * time).cos()]);
        run(&mut app, 1);
        states.push([place(&app, ball_in_flight), velocity(&app, ball_in_flight)]);
        awake.push(diagnostics(&app).awake);
    }
    (states, awake)
}

#[test]
fn a_surface_wakes_as_if_it_had_never_slept() {
    for (speed, event) in [
        (3.0, Event::Nothing),
        // So fast that it is swept.
        (60.0, Event::Nothing),
        (20.0, Event::Teleport(8)),
        (20.0, Event::Teleport(10)),
        (20.0, Event::Pause(7)),
        (20.0, Event::Pause(12)),
    ] {
        let (slept, awake) = fly(false, speed, event);
        let (guarded, always) = fly(true, speed, event);
        let touched = slept
            .iter()
            .any(|[_, velocity]| velocity.distance(Vec3::NEG_Y * speed) > 0.1);
        assert!(touched, "the ball misses: {speed}, {event:?}");
        assert!(awake[0] == 0 && awake.contains(&1), "{awake:?}");
        assert!(always[3..].iter().all(|&count| count == 1), "{always:?}");
        for (frame, (slept, guarded)) in slept.iter().zip(&guarded).enumerate() {
            assert_eq!(slept, guarded, "in frame {frame}: {speed}, {event:?}");
        }
    }
}

#[test]
fn one_of_many_surfaces_is_awake() {
    let mut app = app();
    let mesh = sheet(8);
    let at = |i: usize| Transform::from_xyz(20.0 * i as f32, 0.0, 0.0);
    let surfaces: Vec<Entity> = (0..100).map(|i| spawn(&mut app, &mesh, at(i))).collect();
    settle(&mut app);
    let guest = body(&mut app, ball(0.3), at(40).translation + Vec3::Y * 0.35);
    for i in 1..=30 {
        for &surface in &surfaces {
            set_weights(&mut app, surface, &[0.2 * DT * i as f32, 0.0]);
        }
        run(&mut app, 1);
    }
    let counts = diagnostics(&app);
    assert_eq!((counts.surfaces, counts.moving, counts.awake), (100, 100, 1));
    assert!(
        (velocity(&app, guest).y - 0.2).abs() < 0.02,
        "{}",
        velocity(&app, guest)
    );
    // One of those that sleep.
    app.world_mut().entity_mut(surfaces[7]).despawn();
    run(&mut app, 2);
    let counts = diagnostics(&app);
    assert_eq!((counts.surfaces, counts.awake), (99, 1));
    app.world_mut().entity_mut(guest).despawn();
    run(&mut app, 2);
    assert_eq!(diagnostics(&app).awake, 0);
}

/// What surfaces do in each frame while a player slides over the first of them.
fn walk_over_the_first(surfaces: usize) -> Vec<[u32; 5]> {
    let mut app = app();
    let mesh = sheet(8);
    let at = |i: usize| Transform::from_xyz(20.0 * i as f32, 0.0, 0.0);
    let surfaces: Vec<Entity> = (0..surfaces).map(|i| spawn(&mut app, &mesh, at(i))).collect();
    settle(&mut app);
    let walking = flying(Vec3::new(1.0, 0.0, 0.0));
    let start = Transform::from_xyz(-0.7, 0.3, 0.0);
    app.world_mut()
        .spawn((ball(0.3), start, (DYNAMIC, GravityScale(0.0), walking)));
    let frame = |i: usize| {
        let time = DT * i as f32;
        for &surface in &surfaces {
            set_weights(&mut app, surface, &[0.1 * (3.0 * time).sin(), 0.1 * (2.0 * time).cos()]);
        }
        run(&mut app, 1);
        let counts = diagnostics(&app);
        assert_eq!(counts.surfaces as usize, surfaces.len());
        [
            counts.awake,
            counts.parts,
            counts.blended,
            counts.compared_bodies,
            counts.limited_bodies,
        ]
    };
    (0..60).map(frame).collect()
}

#[test]
fn a_player_wakes_only_the_surface_that_it_walks_over() {
    let alone = walk_over_the_first(1);
    let busy = alone
        .iter()
        .filter(|[awake, parts, blended, ..]| awake.min(parts).min(blended) > &0);
    assert!(busy.count() > 10, "{alone:?}");
    assert_eq!(walk_over_the_first(100), alone);
}
