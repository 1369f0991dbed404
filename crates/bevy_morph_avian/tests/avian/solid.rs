//! Closed surfaces with an inside.

use avian3d::prelude::*;
use bevy::prelude::*;
use morph_collision_workspace::physics::settle;

use crate::any_engine::solid::{SLAB, SOLID, floating, with_slab};
use crate::support::{ask, place, run, slab, spawn, velocity};

#[test]
fn a_body_of_several_colliders_leaves_no_faster() {
    // A second surface encloses one of them.
    let (mut app, _) = with_slab(SLAB, true, ());
    let twin = spawn(&mut app, &slab(SLAB), ());
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
    let (mut app, slab) = with_slab(SLAB, true, ());
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
fn points_and_solid_rays_find_the_inside() {
    for solid in [false, true] {
        let (mut app, slab) = with_slab(SLAB, solid, ());
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
