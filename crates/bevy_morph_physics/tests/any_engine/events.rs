//! The engine's own events about surfaces.

use bevy::prelude::*;
use morph_collision_workspace::physics::engine::Engine;
use morph_collision_workspace::physics::{settle, sheet};

use crate::support::{
    CollidingEntities, DT, Log, Method, Sensor, app, ball, body, colliding, cuboid, flying, listening, pair, place,
    put, set_weights, spawn,
};

#[test]
fn a_contact_starts_and_ends_once_however_far_it_slides() {
    for on_surface in [true, false] {
        let mut app = app();
        let surface = spawn(&mut app, &sheet(32), ());
        settle(&mut app);
        let cuboid = body(&mut app, cuboid(Vec3::splat(0.3)), Vec3::new(-2.0, 0.31, 0.05));
        let listener = if on_surface { surface } else { cuboid };
        for entity in [surface, cuboid] {
            app.world_mut().entity_mut(entity).insert(CollidingEntities::default());
        }
        app.world_mut().entity_mut(listener).insert(listening());
        Method::Ours.make_slippery(&mut app, cuboid);
        app.world_mut().entity_mut(cuboid).insert(flying(Vec3::X * 3.0));
        let mut log = Log::default();
        log.run(&mut app, 60, |app, i| {
            set_weights(app, surface, &[0.2 * (i as f32 * DT).sin(), 0.3 * DT * i as f32]);
        });
        assert!(place(&app, cuboid).x > 0.5, "{}", place(&app, cuboid));
        assert_eq!((&log.started, &log.ended), (&vec![pair(surface, cuboid)], &vec![]));
        assert_eq!(colliding(&app, surface), [cuboid]);
        assert_eq!(colliding(&app, cuboid), [surface]);
        put(&mut app, cuboid, Vec3::new(0.0, 3.0, 0.0));
        log.run(&mut app, 3, |_, _| {});
        assert_eq!(log.ended, [pair(surface, cuboid)]);
        assert_eq!((colliding(&app, surface), colliding(&app, cuboid)), (vec![], vec![]));
    }
}

#[test]
fn a_sensor_surface_reports_and_lets_through() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), (Sensor, listening()));
    settle(&mut app);
    let ball = body(&mut app, ball(0.3), Vec3::new(0.0, 1.0, 0.05));
    let mut log = Log::default();
    log.run(&mut app, 60, |app, i| {
        set_weights(app, surface, &[0.1 * (0.3 * i as f32).sin(), 0.0]);
    });
    let once = vec![pair(surface, ball)];
    assert_eq!((log.started, log.ended), (once.clone(), once));
    assert!(place(&app, ball).y < -1.0);
}
