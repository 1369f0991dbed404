//! What Rapier's sensors and queries see inside a solid surface.

use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{body, settle};

use crate::any_engine::solid::{SLAB, floating, with_slab};
use crate::support::{Log, ask, pair, put, run, shapes, slab, spawn};

#[test]
fn a_solid_sensor_sees_what_is_wholly_inside() {
    for solid in [false, true] {
        for shape in shapes() {
            let (mut app, mouth) = with_slab(SLAB, solid, (Sensor, ActiveEvents::COLLISION_EVENTS));
            let mut log = Log::default();
            let body = floating(&mut app, shape, Vec3::new(0.1, 0.05, 0.05));
            log.run(&mut app, 5, |_, _| {});
            let expected = if solid { vec![pair(mouth, body)] } else { Vec::new() };
            assert_eq!(log.started, expected);
            // Bodies are not driven out of a sensor.
            let sees = move |context: &RapierContext| context.intersection_pair(mouth, body) == Some(true);
            assert_eq!(ask(&mut app, sees), solid);
            log.run(&mut app, 5, |app, _| put(app, body, Vec3::new(0.1, 3.0, 0.05)));
            assert_eq!(log.ended, expected);
        }
    }
}

#[test]
fn a_sensor_inside_sees_a_solid_surface() {
    for solid in [false, true] {
        let (mut app, surface) = with_slab(SLAB, solid, ());
        let sensor = (
            Collider::ball(0.2),
            Sensor,
            ActiveCollisionTypes::all(),
            Transform::from_xyz(0.1, 0.05, 0.05),
        );
        let sensor = app.world_mut().spawn(sensor).id();
        run(&mut app, 3);
        let sees = move |context: &RapierContext| context.intersection_pair(surface, sensor) == Some(true);
        assert_eq!(ask(&mut app, sees), solid);
        // The same if that changes while nothing moves.
        app.world_mut().entity_mut(surface).insert(MorphPhysicsCollider {
            solid: !solid,
            ..default()
        });
        run(&mut app, 3);
        assert_eq!(ask(&mut app, sees), !solid);
    }
}

#[test]
fn a_solid_surface_inside_another_shape_and_another_surface_inside_it_are_seen() {
    let (mut app, _) = with_slab(Vec3::new(8.0, 8.0, 8.0), true, (Sensor, ActiveCollisionTypes::all()));
    let inner = spawn(&mut app, &slab(SLAB), ActiveCollisionTypes::all());
    settle(&mut app);
    run(&mut app, 3);
    let count = move |context: &RapierContext| context.intersection_pairs_with(inner).filter(|pair| pair.2).count();
    assert_eq!(ask(&mut app, count), 1);
}

#[test]
fn queries_see_the_inside() {
    for solid in [false, true] {
        let (mut app, surface) = with_slab(SLAB, solid, ());
        let middle = Vec3::new(0.1, 0.05, 0.05);
        let found = ask(&mut app, move |context| {
            let filter = QueryFilter::default();
            let mut points = Vec::new();
            context.intersect_point(middle, filter, |entity, _| {
                points.push(entity);
                true
            });
            let mut shapes = Vec::new();
            context.intersect_shape(middle, Quat::IDENTITY, &Collider::ball(0.2), filter, |entity, _| {
                shapes.push(entity);
                true
            });
            let ray = |solid| context.cast_ray(middle, Vec3::Y, 10.0, solid, filter).unwrap();
            let projected = |solid| context.project_point(middle, 10.0, solid, filter).unwrap();
            (
                points,
                shapes,
                [ray(true).1, ray(false).1],
                [true, false].map(|solid| (projected(solid).1.point, projected(solid).1.is_inside)),
            )
        });
        let (points, shapes, rays, projected) = found;
        let seen = if solid { vec![surface] } else { Vec::new() };
        assert_eq!((&points, &shapes), (&seen, &seen));
        assert_eq!(rays, [if solid { 0.0 } else { 0.45 }, 0.45]);
        let boundary = Vec3::new(0.1, 0.5, 0.05);
        let first = if solid { middle } else { boundary };
        for ((point, is_inside), expected) in projected.into_iter().zip([first, boundary]) {
            assert!(
                point.distance(expected) < 1e-5 && is_inside == solid,
                "{point} {is_inside}"
            );
        }
    }
}

#[test]
fn what_is_beside_a_solid_surface_is_not_seen() {
    let (mut app, mouth) = with_slab(SLAB, true, (Sensor, ActiveEvents::COLLISION_EVENTS));
    let turned = Transform::from_rotation(Quat::from_rotation_z(0.7));
    app.world_mut().entity_mut(mouth).insert(turned);
    // Inside its bounding box, but outside the shape.
    let ball = body(&mut app, Collider::ball(0.1), Vec3::new(-1.3, 1.0, 0.0));
    app.world_mut().entity_mut(ball).insert(GravityScale(0.0));
    let mut log = Log::default();
    log.run(&mut app, 5, |_, _| {});
    assert!(log.started.is_empty());
    log.run(&mut app, 5, |app, _| put(app, ball, Vec3::new(1.0, 0.8, 0.0)));
    assert_eq!(log.started, [pair(mouth, ball)]);
}
