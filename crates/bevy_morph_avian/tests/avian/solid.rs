//! Closed surfaces with an inside.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_morph_avian::prelude::*;
use morph_collision_models::generated::rigid::box_mesh;
use morph_collision_workspace::physics::{settle, sheet};

use crate::support::{app, ask, body, place, run, set_weights, spawn, velocity};

const SOLID: MorphPhysicsCollider = MorphPhysicsCollider {
    max_acceleration: 100.0,
    solid: true,
};

/// A box of 4 by 1 by 4, with a target that lifts it.
fn with_slab(solid: bool) -> (App, Entity) {
    let mut app = app();
    let mut slab = box_mesh(Vec3::new(2.0, 0.5, 2.0));
    slab.targets = vec![vec![Vec3::Y; slab.positions.len()]];
    slab.target_names = vec!["rise".into()];
    let slab = spawn(&mut app, &slab, ());
    app.world_mut()
        .entity_mut(slab)
        .insert(MorphPhysicsCollider { solid, ..SOLID });
    settle(&mut app);
    (app, slab)
}

fn floating(app: &mut App, collider: Collider, at: Vec3) -> Entity {
    let body = body(app, collider, at);
    app.world_mut().entity_mut(body).insert(GravityScale(0.0));
    body
}

#[test]
fn what_is_inside_is_driven_out_of_what_is_solid() {
    for shape in [
        Collider::sphere(0.2),
        Collider::cuboid(0.4, 0.4, 0.4),
        Collider::capsule(0.1, 0.2),
    ] {
        for solid in [false, true] {
            let (mut app, _) = with_slab(solid);
            let at = Vec3::new(0.1, 0.1, 0.05);
            let inside = floating(&mut app, shape.clone(), at);
            let mut fastest: f32 = 0.0;
            for _ in 0..60 {
                run(&mut app, 1);
                fastest = fastest.max(velocity(&app, inside).length());
            }
            let (now, speed) = (place(&app, inside), velocity(&app, inside).length());
            println!("{solid}: {now}, at most {fastest}/s, now {speed}/s");
            if solid {
                assert!(now.y > 0.69 && (now - at).normalize().y > 0.99, "{now}");
                assert!(fastest < 4.1 && speed < 1.5, "{fastest}, {speed}");
            } else {
                assert_eq!(now, at);
            }
        }
    }
}

#[test]
fn a_body_of_several_colliders_leaves_no_faster() {
    // A second surface encloses one of them.
    let (mut app, _) = with_slab(true);
    let mut twin = box_mesh(Vec3::new(2.0, 0.5, 2.0));
    twin.targets = vec![vec![Vec3::Y; twin.positions.len()]];
    twin.target_names = vec!["rise".into()];
    let twin = spawn(&mut app, &twin, ());
    app.world_mut().entity_mut(twin).insert(SOLID);
    settle(&mut app);
    let at = Vec3::new(0.1, 0.1, 0.05);
    let body = (RigidBody::Dynamic, GravityScale(0.0), Transform::from_translation(at));
    let body = app.world_mut().spawn(body).id();
    for i in [-1.0, 0.0, 1.0] {
        let part = (
            Collider::cuboid(0.4, 0.4, 0.4),
            Transform::from_xyz(0.5 * i, 0.0, 0.0),
            ChildOf(body),
        );
        app.world_mut().spawn(part);
    }
    let mut fastest: f32 = 0.0;
    for _ in 0..60 {
        run(&mut app, 1);
        fastest = fastest.max(velocity(&app, body).length());
    }
    let (now, speed) = (place(&app, body), velocity(&app, body).length());
    assert!(now.y > 0.69, "{now}");
    assert!(fastest < 4.1 && speed < 1.5, "{fastest}, {speed}");
}

#[test]
fn locked_axes_and_layers_keep_what_is_inside() {
    let (mut app, slab) = with_slab(true);
    let at = Vec3::new(0.1, 0.1, 0.05);
    let locked = floating(&mut app, Collider::sphere(0.2), at);
    app.world_mut()
        .entity_mut(locked)
        .insert(LockedAxes::TRANSLATION_LOCKED);
    let other = floating(&mut app, Collider::sphere(0.2), at + Vec3::X);
    app.world_mut()
        .entity_mut(other)
        .insert(CollisionLayers::from_bits(2, 2));
    app.world_mut()
        .entity_mut(slab)
        .insert(CollisionLayers::from_bits(1, 1));
    run(&mut app, 60);
    assert_eq!(place(&app, locked), at);
    assert_eq!(place(&app, other), at + Vec3::X);
}

#[test]
fn what_a_jump_swallows_leaves_by_the_way_it_came() {
    let (mut app, slab) = with_slab(true);
    let cuboid = body(&mut app, Collider::cuboid(0.3, 0.3, 0.3), Vec3::new(0.1, 0.66, 0.05));
    run(&mut app, 30);
    set_weights(&mut app, slab, &[0.9]);
    run(&mut app, 120);
    let rests = place(&app, cuboid).y;
    assert!((rests - 1.55).abs() < 0.02, "{rests}");
}

#[test]
fn points_and_solid_rays_find_the_inside() {
    for solid in [false, true] {
        let (mut app, slab) = with_slab(solid);
        run(&mut app, 2);
        let (points, rays) = ask(&mut app, |spatial| {
            let at = Vec3::new(0.1, 0.1, 0.05);
            let filter = SpatialQueryFilter::default();
            let points = spatial.point_intersections(at, &filter);
            let ray = |solid| {
                spatial
                    .cast_ray(at, Dir3::Y, 10.0, solid, &filter)
                    .map(|hit| hit.distance)
            };
            (points, [ray(true), ray(false)])
        });
        assert_eq!(points, if solid { vec![slab] } else { Vec::new() });
        assert_eq!(rays.map(Option::unwrap)[0] == 0.0, solid);
        assert!((rays[1].unwrap() - 0.4).abs() < 1e-5);
    }
}

#[test]
fn what_is_not_closed_is_reported_once() {
    crate::log::Errors::collect(|_| {
        crate::log::Errors::collect(|errors| {
            let mut app = app();
            let open = spawn(&mut app, &sheet(4), Name::new("a sheet"));
            app.world_mut().entity_mut(open).insert(SOLID);
            settle(&mut app);
            run(&mut app, 5);
            let warnings = errors.take_warnings();
            let [warning] = &warnings[..] else {
                panic!("{warnings:?}")
            };
            assert!(
                warning.contains("a sheet") && warning.contains("not closed"),
                "{warning}"
            );
        });
    });
}
