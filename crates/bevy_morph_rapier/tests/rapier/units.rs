//! Surfaces on dynamic bodies in worlds of other units of length.

use std::path::Path;

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::behaviour::scaled;
use morph_collision_workspace::physics::{DT, app_in_unit, body, settle};

use crate::log::run_here;
use crate::support::{place, run, set_weights, slab_cut, spawn, velocity};

const UNITS: [f32; 4] = [0.01, 1.0, 10.0, 100.0];

#[test]
fn a_surface_on_a_dynamic_body_throws_alike_in_every_unit() {
    for unit in UNITS {
        let mut app = app_in_unit(Path::new("."), unit, |_: &mut App| {});
        run_here(&mut app);
        let floor = (
            Collider::cuboid(5.0 * unit, 0.5 * unit, 5.0 * unit),
            Transform::from_xyz(0.0, -0.5 * unit, 0.0),
        );
        app.world_mut().spawn(floor);
        let on_body = (
            RigidBody::Dynamic,
            Transform::from_xyz(0.0, 0.26 * unit, 0.0),
            Velocity::default(),
        );
        let mesh = scaled(slab_cut(Vec3::new(1.0, 0.25, 1.0), 2), unit);
        let slab = spawn(&mut app, &mesh, on_body);
        settle(&mut app);
        let ball = body(&mut app, Collider::ball(0.2 * unit), Vec3::new(0.1, 0.75, 0.05) * unit);
        run(&mut app, 60);
        for i in 1..=60 {
            set_weights(&mut app, slab, &[0.0, 0.5 * DT * i as f32, 0.0, 0.0]);
            run(&mut app, 1);
        }
        let (speed, height) = (velocity(&app, ball).y / unit, place(&app, ball).y / unit);
        println!("unit {unit}: {speed} at {height}");
        assert!((speed - 0.5).abs() < 0.01, "{unit}: {speed}");
        assert!((height - 1.2).abs() < 0.01, "{unit}: at {height}");
    }
}
