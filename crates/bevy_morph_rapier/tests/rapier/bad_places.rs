//! Surfaces and bodies with places, sizes and weights that cannot be computed with.

use bevy::ecs::message::MessageCursor;
use bevy::math::Affine3A;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{DT, body, settle, sheet};

use crate::support::{
    BALL, app, ball_on_sheet, below, collect_errors, diagnostics, place, put, run, set_weights, slab, spawn, velocity,
};

/// The place of a second sheet with a ball on it, which must not be affected.
const ASIDE: Vec3 = Vec3::new(20.0, 0.0, 0.0);

/// Adds that sheet and that ball.
fn add_bystander(app: &mut App) -> (Entity, Entity) {
    let surface = spawn(app, &sheet(16), Transform::from_translation(ASIDE));
    settle(app);
    let ball = body(app, Collider::ball(0.3), ASIDE + BALL);
    app.world_mut().entity_mut(ball).insert(Sleeping::disabled());
    run(app, 30);
    (surface, ball)
}

fn assert_rests_aside(app: &mut App, (surface, ball): (Entity, Entity), case: &str) {
    let off = place(app, ball) - (ASIDE + Vec3::new(BALL.x, 0.3, BALL.z));
    assert!(off.length() < 1e-2, "{case}: it is off by {off}");
    assert!(velocity(app, ball).length() < 1e-2, "{case}: {}", velocity(app, ball));
    let (hit, height) = below(app, ASIDE.x + 3.0, 3.1).expect(case);
    assert!(hit == surface && height.abs() < 1e-4, "{case}: {hit} at {height}");
}

/// Places that no surface can have, with their names.
fn bad_places() -> Vec<(&'static str, Transform)> {
    vec![
        ("NaN place", Transform::from_xyz(0.0, f32::NAN, 0.0)),
        ("infinite place", Transform::from_xyz(f32::INFINITY, 0.0, 0.0)),
        ("place of 1e30", Transform::from_xyz(0.0, -1e30, 0.0)),
        ("place of 1e9", Transform::from_xyz(0.0, 0.0, 1e9)),
        (
            "NaN rotation",
            Transform::from_rotation(Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)),
        ),
        ("NaN scale", Transform::from_scale(Vec3::new(1.0, f32::NAN, 1.0))),
        ("infinite scale", Transform::from_scale(Vec3::splat(f32::INFINITY))),
        ("scale of 1e9", Transform::from_scale(Vec3::splat(1e9))),
        ("scale of 1e18", Transform::from_scale(Vec3::splat(1e18))),
        ("scale of 1e20", Transform::from_scale(Vec3::splat(1e20))),
        ("scale of 1e30", Transform::from_scale(Vec3::splat(1e30))),
        ("scale of f32::MAX", Transform::from_scale(Vec3::splat(f32::MAX))),
    ]
}

#[test]
fn at_a_bad_place_a_surface_is_left_out_which_is_logged_once_and_at_a_good_one_it_is_back() {
    for (case, bad) in bad_places() {
        // A listener makes Rapier compare the surface itself, not only its parts.
        for listening in [false, true] {
            collect_errors(|errors| {
                let (mut app, surface, ball) = ball_on_sheet();
                let bystander = add_bystander(&mut app);
                app.world_mut()
                    .entity_mut(surface)
                    .insert(Name::new("the troubled one"));
                if listening {
                    app.world_mut().entity_mut(ball).insert(ActiveEvents::COLLISION_EVENTS);
                }
                let mut quarantined: MessageCursor<PhysicsQuarantineEvent> = MessageCursor::default();
                app.world_mut().entity_mut(surface).insert(bad);
                put(&mut app, ball, BALL);
                run(&mut app, 60);
                assert!(place(&app, ball).y < -1.0, "{case}: {}", place(&app, ball));
                assert_eq!((place(&app, ball).x, place(&app, ball).z), (BALL.x, BALL.z), "{case}");
                assert_eq!(diagnostics(&app).surfaces, 1, "{case}");
                assert_eq!(below(&mut app, 3.0, 3.1), None, "{case}: a ghost");
                assert_rests_aside(&mut app, bystander, case);
                let logged = errors.take();
                let ours = logged
                    .iter()
                    .filter(|text| text.contains("left out of physics"))
                    .collect::<Vec<_>>();
                assert_eq!(ours.len(), 1, "{case}: {logged:?}");
                assert!(ours[0].contains("the troubled one"), "{case}: {logged:?}");

                app.world_mut().entity_mut(surface).insert(Transform::default());
                put(&mut app, ball, BALL);
                run(&mut app, 60);
                assert!(
                    (place(&app, ball).y - 0.3).abs() < 1e-2,
                    "{case}: {}",
                    place(&app, ball)
                );
                let (hit, _) = below(&mut app, 3.0, 3.1).expect(case);
                assert_eq!(hit, surface, "{case}");
                assert_rests_aside(&mut app, bystander, case);
                // Rapier had no reason to disable anything for good.
                assert_eq!(quarantined.read(app.world().resource()).count(), 0, "{case}");
                assert!(!app.world().entity(surface).contains::<ColliderDisabled>(), "{case}");
                assert_eq!(diagnostics(&app).surfaces, 2, "{case}");
            });
        }
    }
}

#[test]
fn a_surface_spawned_at_a_bad_place_comes_when_the_place_is_good() {
    for (case, bad) in bad_places() {
        let mut app = app();
        let surface = spawn(&mut app, &sheet(16), bad);
        settle(&mut app);
        let ball = body(&mut app, Collider::ball(0.3), BALL);
        run(&mut app, 60);
        assert!(place(&app, ball).y < -1.0, "{case}: {}", place(&app, ball));
        app.world_mut().entity_mut(surface).insert(Transform::default());
        put(&mut app, ball, BALL);
        run(&mut app, 60);
        assert!(
            (place(&app, ball).y - 0.3).abs() < 1e-2,
            "{case}: {}",
            place(&app, ball)
        );
        assert_eq!(
            below(&mut app, 3.0, 3.1).map(|(entity, _)| entity),
            Some(surface),
            "{case}"
        );
    }
}

#[test]
fn a_surface_scaled_to_nothing_and_back_carries_again() {
    for nothing in [0.0, 1e-30, 1e-22] {
        let (mut app, surface, ball) = ball_on_sheet();
        let scale = |app: &mut App, scale: f32| {
            app.world_mut().get_mut::<Transform>(surface).unwrap().scale = Vec3::splat(scale);
        };
        scale(&mut app, nothing);
        run(&mut app, 60);
        assert!(place(&app, ball).y < -1.0, "{nothing}: {}", place(&app, ball));
        assert!(!app.world().entity(surface).contains::<ColliderDisabled>(), "{nothing}");
        scale(&mut app, 1.0);
        put(&mut app, ball, BALL);
        run(&mut app, 60);
        assert!(
            (place(&app, ball).y - 0.3).abs() < 1e-2,
            "{nothing}: {}",
            place(&app, ball)
        );
    }
}

#[test]
fn a_sheet_scaled_to_nothing_across_itself_or_mirrored_carries_all_the_same() {
    for odd in [
        Vec3::new(1.0, 0.0, 1.0),
        Vec3::new(1.0, 1e-30, 1.0),
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::splat(1e6),
    ] {
        let (mut app, surface, ball) = ball_on_sheet();
        app.world_mut().entity_mut(surface).insert(Transform::from_scale(odd));
        put(&mut app, ball, BALL);
        run(&mut app, 60);
        assert!((place(&app, ball).y - 0.3).abs() < 1e-2, "{odd}: {}", place(&app, ball));
    }
}

#[test]
fn bad_weights_leave_the_last_good_ones() {
    let (mut app, surface, ball) = ball_on_sheet();
    set_weights(&mut app, surface, &[0.1, 0.0]);
    run(&mut app, 30);
    for bad in [
        vec![f32::NAN, 0.0],
        vec![f32::INFINITY, 0.0],
        vec![0.5],
        vec![1e38, 1e38],
    ] {
        set_weights(&mut app, surface, &bad);
        run(&mut app, 5);
        assert!(
            (place(&app, ball).y - 0.4).abs() < 1e-2,
            "{bad:?}: {}",
            place(&app, ball)
        );
    }
    set_weights(&mut app, surface, &[0.1, 0.0]);
    run(&mut app, 5);
    assert!((place(&app, ball).y - 0.4).abs() < 1e-2);
}

#[test]
fn what_was_somewhere_near_infinity_pushes_as_before() {
    for solid in [false, true] {
        let (mut app, surface, ball) = ball_on_sheet();
        let slab = spawn(
            &mut app,
            &slab(Vec3::new(2.0, 0.5, 2.0)),
            Transform::from_translation(ASIDE),
        );
        app.world_mut().entity_mut(slab).insert(MorphPhysicsCollider {
            solid,
            ..MorphPhysicsCollider::default()
        });
        settle(&mut app);
        let floats = body(&mut app, Collider::ball(0.2), ASIDE + Vec3::new(0.1, 1.0, 0.05));
        app.world_mut().entity_mut(floats).insert(GravityScale(0.0));
        run(&mut app, 5);
        for surface in [surface, slab] {
            let count = if surface == slab { 4 } else { 2 };
            set_weights(&mut app, surface, &vec![1e25; count]);
            run(&mut app, 1);
            set_weights(&mut app, surface, &vec![0.0; count]);
        }
        put(&mut app, ball, BALL);
        run(&mut app, 30);
        for step in 1..=60_u8 {
            let height = DT * f32::from(step);
            set_weights(&mut app, surface, &[height, 0.0]);
            set_weights(&mut app, slab, &[height, 0.0, 0.0, 0.0]);
            run(&mut app, 1);
        }
        let (carried, pushed) = (place(&app, ball).y, place(&app, floats).y);
        assert!((carried - 1.3).abs() < 2e-2, "{carried}");
        assert!(pushed > ASIDE.y + 1.69, "{pushed}");
        // Jumps over all of it in one step.
        put(&mut app, floats, ASIDE + Vec3::new(0.1, 1.9, 0.05));
        run(&mut app, 2);
        set_weights(&mut app, slab, &[1.0, 1.0, 0.0, 0.0]);
        run(&mut app, 90);
        let at = place(&app, floats);
        assert_eq!(at.y > ASIDE.y + 2.69, solid, "{at}");
    }
}

#[test]
fn a_body_too_large_falls_through_which_is_logged_once_and_others_stay_where_they_are() {
    for size in [1e9, 1e20, 1e30] {
        for shape in [
            Collider::ball(size),
            Collider::cuboid(size, size, size),
            Collider::capsule_x(size, size),
        ] {
            collect_errors(|errors| {
                let (mut app, surface, ball) = ball_on_sheet();
                let bystander = add_bystander(&mut app);
                app.world_mut()
                    .entity_mut(surface)
                    .insert(ActiveEvents::COLLISION_EVENTS);
                let large = body(&mut app, shape, Vec3::new(2.0, 1.0, 2.0));
                // It collides only with surfaces. How Parry handles it with other bodies is not
                // tested here.
                app.world_mut().entity_mut(large).insert((
                    CollisionGroups::new(Group::GROUP_2, Group::GROUP_3),
                    ColliderMassProperties::Mass(1.0),
                    Name::new("the large one"),
                ));
                for surface in [surface, bystander.0] {
                    let groups = CollisionGroups::new(Group::GROUP_1 | Group::GROUP_3, Group::ALL);
                    app.world_mut().entity_mut(surface).insert(groups);
                }
                for ball in [ball, bystander.1] {
                    let groups = CollisionGroups::new(Group::GROUP_1, Group::GROUP_1);
                    app.world_mut().entity_mut(ball).insert(groups);
                }
                run(&mut app, 60);
                assert!(place(&app, large).y < -1.0, "{size:e}: {}", place(&app, large));
                assert!(
                    (place(&app, ball).y - 0.3).abs() < 1e-2,
                    "{size:e}: {}",
                    place(&app, ball)
                );
                let off = place(&app, bystander.1) - (ASIDE + Vec3::new(BALL.x, 0.3, BALL.z));
                assert!(off.length() < 1e-2, "{size:e}: {off}");
                let logged = errors.take();
                let named = logged.iter().filter(|text| text.contains("the large one")).count();
                assert_eq!(named, 1, "{size:e}: {logged:?}");
            });
        }
    }
}

#[test]
fn the_plugin_s_own_contacts_go_on_while_physics_leaves_a_surface_out() {
    // What is too large for Parry is not too large for exact collision detection.
    let (mut app, surface, _) = ball_on_sheet();
    let other = spawn(
        &mut app,
        &sheet(4),
        Transform::from_rotation(Quat::from_rotation_x(1.0)),
    );
    app.world_mut()
        .entity_mut(other)
        .remove::<MorphPhysicsCollider>()
        .insert(MorphCollider::default());
    settle(&mut app);
    let touching = |app: &App| app.world().resource::<MorphCollisions>().contains(surface, other);
    assert!(touching(&app));
    app.world_mut()
        .entity_mut(surface)
        .insert(Transform::from_scale(Vec3::splat(1e10)));
    run(&mut app, 3);
    assert!(touching(&app));
    assert_eq!(diagnostics(&app).surfaces, 0);
    let is_large = app.world().get::<GlobalTransform>(surface).unwrap().affine();
    assert!(is_large != Affine3A::IDENTITY);
}
