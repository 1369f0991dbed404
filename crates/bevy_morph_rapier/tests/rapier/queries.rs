//! Compares Rapier's own queries about surfaces with Parry's mesh of the same vertices.

use bevy::prelude::*;
use bevy_rapier3d::parry::math::Pose;
use bevy_rapier3d::parry::query::{
    DefaultQueryDispatcher, PointQuery, QueryDispatcher, Ray, RayCast, details::ShapeCastOptions as ParryOptions,
};
use bevy_rapier3d::parry::shape::{Ball, Cuboid, Shape, TriMesh};
use bevy_rapier3d::prelude::*;
use morph_collision_models::generated::random;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::physics::settle;

use crate::support::{app, ask, global, run, set_weights, spawn, truth};

const WEIGHTS: [f32; 3] = [0.8, -0.5, 1.3];

/// A posed blob, stretched, mirrored and rotated; and its true shape.
fn blob() -> (App, Entity, TriMesh, MorphMesh) {
    let blob = random::random_blob(7, 3, 3, 0.2);
    let place = Transform::from_xyz(0.3, -0.2, 0.1)
        .with_rotation(Quat::from_euler(EulerRot::XYZ, 0.4, -0.3, 1.0))
        .with_scale(Vec3::new(2.0, -1.0, 0.6));
    let mut app = app();
    let entity = spawn(&mut app, &blob, place);
    settle(&mut app);
    set_weights(&mut app, entity, &WEIGHTS);
    run(&mut app, 1);
    let mesh = truth(&blob, &WEIGHTS, &global(&app, entity));
    (app, entity, mesh, blob)
}

/// Points all around, and directions roughly towards the middle.
fn around() -> impl Iterator<Item = (Vec3, Vec3)> {
    (0..200).map(|i| {
        let i = i as f32;
        let from = Vec3::new((1.7 * i).sin(), (2.3 * i + 1.0).sin(), (0.9 * i + 2.0).sin()).normalize() * 4.0;
        let to = Vec3::new((3.1 * i).sin(), (1.3 * i).sin(), (2.9 * i).sin());
        (from, (to - from).normalize() * (0.5 + (i * 0.01)))
    })
}

#[test]
fn rays() {
    let (mut app, entity, mesh, _) = blob();
    let mut hits = 0;
    for (from, direction) in around() {
        let found = ask(&mut app, move |context| {
            context.cast_ray_and_get_normal(from, direction, 20.0, true, QueryFilter::default())
        });
        let ray = Ray::new(from, direction);
        let expected = mesh.cast_local_ray_and_get_normal(&ray, 20.0, true);
        assert_eq!(found.is_some(), expected.is_some(), "{from} {direction}");
        let (Some((hit, found)), Some(expected)) = (found, expected) else {
            continue;
        };
        hits += 1;
        assert_eq!(hit, entity);
        let off = (found.time_of_impact - expected.time_of_impact).abs();
        assert!(off < 1e-4, "{} for {}", found.time_of_impact, expected.time_of_impact);
        assert!(found.normal.distance(expected.normal) < 1e-2, "{found:?} {expected:?}");
        assert_eq!((found.subshape, found.feature), (expected.subshape, expected.feature));
    }
    assert!(hits > 50, "{hits}");
}

#[test]
fn closest_points() {
    let (mut app, entity, mesh, _) = blob();
    for (from, _) in around() {
        let (hit, found) = ask(&mut app, move |context| {
            context.project_point(from, 100.0, true, QueryFilter::default())
        })
        .expect("something is near");
        let expected = mesh.project_local_point(from, true);
        let (found, expected) = (found.point.distance(from), expected.point.distance(from));
        assert!(
            hit == entity && (found - expected).abs() < 1e-4,
            "{found} for {expected}"
        );
    }
}

#[test]
fn shape_casts_intersections_and_distances() {
    let (mut app, entity, mesh, _) = blob();
    let shapes: [(&dyn Shape, Collider); 2] = [
        (&Ball::new(0.2), Collider::ball(0.2)),
        (&Cuboid::new(Vec3::new(0.3, 0.1, 0.2)), Collider::cuboid(0.3, 0.1, 0.2)),
    ];
    let (mut hits, mut overlaps) = (0, 0);
    for (shape, collider) in shapes {
        for (from, direction) in around() {
            let dispatcher = DefaultQueryDispatcher;
            let options = ParryOptions::with_max_time_of_impact(10.0);
            let at = Pose::from_translation(from);
            let expected = dispatcher.cast_shapes(&at, direction, &mesh, shape, options).unwrap();
            let moving = collider.clone();
            let found = ask(&mut app, move |context| {
                let options = ShapeCastOptions::with_max_time_of_impact(10.0);
                let filter = QueryFilter::default();
                context.cast_shape(from, Quat::IDENTITY, direction, &moving, options, filter)
            });
            assert_eq!(found.is_some(), expected.is_some(), "{from} {direction}");
            if let (Some((hit, found)), Some(expected)) = (found, expected) {
                hits += 1;
                let off = (found.time_of_impact - expected.time_of_impact).abs();
                assert!(hit == entity && off < 1e-2, "{found:?} for {expected:?}");
            }

            let at = from * 0.3;
            let place = Pose::from_translation(at);
            let expected = dispatcher.intersection_test(&place, &mesh, shape).unwrap().intersecting;
            let there = collider.clone();
            let found = ask(&mut app, move |context| {
                let mut found = Vec::new();
                let filter = QueryFilter::default();
                context.intersect_shape(at, Quat::IDENTITY, &there, filter, |entity, _| {
                    found.push(entity);
                    true
                });
                found
            });
            overlaps += usize::from(expected);
            assert_eq!(found, if expected { vec![entity] } else { vec![] }, "{at}");

            for at in [at, from, from * 10.0] {
                let place = Pose::from_translation(at);
                let expected = dispatcher.distance(&place, &mesh, shape).unwrap().distance;
                let there = collider.clone();
                let found = ask(&mut app, move |context| {
                    context.distance_to_shape(at, Quat::IDENTITY, &there, QueryFilter::default())
                });
                let (hit, found) = found.expect("there is something at some distance");
                assert!(
                    hit == entity && (found - expected).abs() < 1e-3,
                    "{found} for {expected}"
                );
            }
        }
    }
    assert!(hits > 100 && overlaps > 20, "{hits} {overlaps}");
}

#[test]
fn a_query_is_answered_once_with_a_body_on_the_surface() {
    use morph_collision_workspace::physics::{DT, body, sheet};
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let ball = body(&mut app, Collider::ball(0.5), Vec3::new(0.1, 0.5, 0.05));
    for i in 1..30 {
        set_weights(&mut app, surface, &[0.5 * DT * i as f32, 0.0]);
        run(&mut app, 1);
    }
    let height = 0.5 * DT * 29.0;
    let found = ask(&mut app, move |context| {
        let mut found = Vec::new();
        let filter = QueryFilter::default().exclude_collider(ball);
        context.intersect_ray(
            Vec3::new(0.2, 5.0, 0.1),
            -Vec3::Y,
            10.0,
            true,
            filter,
            |entity, _, hit| {
                found.push((entity, hit.time_of_impact));
                true
            },
        );
        context.intersect_shape(
            Vec3::new(0.2, height, 0.1),
            Quat::IDENTITY,
            &Collider::ball(0.1),
            filter,
            |entity, _| {
                found.push((entity, 0.0));
                true
            },
        );
        found
    });
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found.iter().all(|(entity, _)| *entity == surface));
    assert!((found[0].1 - (5.0 - height)).abs() < 1e-5, "{found:?}");
}
