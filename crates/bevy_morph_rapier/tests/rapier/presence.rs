//! When a surface is in physics and when it is not: nothing stays behind, and a surface that comes back
//! carries bodies again.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{bevy_mesh, body, settle, sheet};

use crate::support::{BALL, app, ball_on_sheet, below, diagnostics, place, population, put, run, set_weights, spawn};

/// A change that a game makes to a surface.
type Change = fn(&mut App, Entity);

fn pause_detection(app: &mut App, paused: bool) {
    app.world_mut().resource_mut::<MorphCollisionSettings>().paused = paused;
}

fn add_sheet(app: &mut App, height: f32) -> Mesh3d {
    let mut mesh = sheet(8);
    mesh.positions.iter_mut().for_each(|p| p.y += height);
    Mesh3d(app.world_mut().resource_mut::<Assets<Mesh>>().add(bevy_mesh(&mesh)))
}

#[test]
fn a_surface_spawned_while_detection_is_paused_carries_and_pushes() {
    let mut app = app();
    pause_detection(&mut app, true);
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let ball = body(&mut app, Collider::ball(0.3), BALL);
    run(&mut app, 30);
    assert!((place(&app, ball).y - 0.3).abs() < 1e-2, "{}", place(&app, ball));
    for i in 1..=30 {
        set_weights(&mut app, surface, &[0.01 * i as f32, 0.0]);
        run(&mut app, 1);
    }
    assert!((place(&app, ball).y - 0.6).abs() < 1e-2, "{}", place(&app, ball));
}

#[test]
fn a_mesh_swapped_while_detection_is_paused_leaves_no_ghost() {
    let (mut app, surface, ball) = ball_on_sheet();
    pause_detection(&mut app, true);
    let lower = add_sheet(&mut app, -1.0);
    app.world_mut().entity_mut(surface).insert(lower);
    settle(&mut app);
    // If the tree took long, the ball is below both surfaces.
    put(&mut app, ball, BALL);
    run(&mut app, 90);
    assert!((place(&app, ball).y + 0.7).abs() < 1e-2, "{}", place(&app, ball));
    let (hit, height) = below(&mut app, 3.0, 3.1).expect("the new surface");
    assert!(hit == surface && (height + 1.0).abs() < 1e-4, "{height}");
}

#[test]
fn a_mesh_swapped_for_one_that_is_ready_does_not_drop_its_bodies() {
    let (mut app, surface, ball) = ball_on_sheet();
    let lower = add_sheet(&mut app, -0.01);
    // Any collider with this mesh keeps its tree ready.
    app.world_mut()
        .spawn((lower.clone(), MorphCollider::default(), MorphColliderDisabled));
    settle(&mut app);
    app.world_mut().entity_mut(surface).insert(lower);
    run(&mut app, 30);
    assert!((place(&app, ball).y - 0.29).abs() < 1e-2, "{}", place(&app, ball));
}

#[test]
fn of_two_disablers_one_is_enough() {
    let ends: [Change; 2] = [
        |app, surface| {
            app.world_mut().entity_mut(surface).remove::<MorphColliderDisabled>();
        },
        |app, surface| {
            app.world_mut().entity_mut(surface).remove::<ColliderDisabled>();
        },
    ];
    for order in [[0, 1], [1, 0]] {
        let (mut app, surface, ball) = ball_on_sheet();
        app.world_mut()
            .entity_mut(surface)
            .insert((MorphColliderDisabled, ColliderDisabled));
        run(&mut app, 2);
        ends[order[0]](&mut app, surface);
        run(&mut app, 60);
        assert!(place(&app, ball).y < -1.0, "{order:?}: {}", place(&app, ball));
        assert_eq!(below(&mut app, 3.0, 3.1), None, "{order:?}");
        ends[order[1]](&mut app, surface);
        put(&mut app, ball, BALL);
        run(&mut app, 60);
        assert!(
            (place(&app, ball).y - 0.3).abs() < 1e-2,
            "{order:?}: {}",
            place(&app, ball)
        );
        assert!(below(&mut app, 3.0, 3.1).is_some(), "{order:?}");
    }
}

#[test]
fn what_a_surface_does_while_it_is_disabled_is_no_motion() {
    let (mut app, surface, ball) = ball_on_sheet();
    app.world_mut().entity_mut(surface).insert(MorphColliderDisabled);
    run(&mut app, 1);
    put(&mut app, ball, BALL);
    // Slow enough to count as motion, had it happened in one step.
    set_weights(&mut app, surface, &[0.02, 0.0]);
    app.world_mut().entity_mut(surface).remove::<MorphColliderDisabled>();
    let mut fastest: f32 = 0.0;
    for _ in 0..30 {
        run(&mut app, 1);
        fastest = fastest.max(crate::support::velocity(&app, ball).y);
    }
    assert!(fastest < 0.6, "it was thrown at {fastest}");
    assert!((place(&app, ball).y - 0.32).abs() < 1e-2, "{}", place(&app, ball));
}

#[test]
fn a_collider_of_the_game_s_own_stays_and_works_when_the_surface_goes() {
    let cuboid = || Collider::cuboid(1.0, 1.0, 1.0);
    let replace: [(&str, Change); 5] = [
        ("removed, then a collider", |app, surface| {
            let mut surface = app.world_mut().entity_mut(surface);
            surface
                .remove::<MorphPhysicsCollider>()
                .insert(Collider::cuboid(1.0, 1.0, 1.0));
        }),
        ("a collider, then removed", |app, surface| {
            let mut surface = app.world_mut().entity_mut(surface);
            surface
                .insert(Collider::cuboid(1.0, 1.0, 1.0))
                .remove::<MorphPhysicsCollider>();
        }),
        ("a collider, and not removed", |app, surface| {
            app.world_mut()
                .entity_mut(surface)
                .insert(Collider::cuboid(1.0, 1.0, 1.0));
        }),
        ("a collider, and no MorphCollider", |app, surface| {
            let mut surface = app.world_mut().entity_mut(surface);
            surface
                .remove::<MorphCollider>()
                .insert(Collider::cuboid(1.0, 1.0, 1.0));
        }),
        ("a collider after the surface was disabled", |app, surface| {
            app.world_mut().entity_mut(surface).insert(MorphColliderDisabled);
            run(app, 2);
            let mut surface = app.world_mut().entity_mut(surface);
            surface
                .remove::<MorphPhysicsCollider>()
                .insert(Collider::cuboid(1.0, 1.0, 1.0));
        }),
    ];
    for (name, replace) in replace {
        let (mut app, surface, ball) = ball_on_sheet();
        replace(&mut app, surface);
        put(&mut app, ball, BALL + Vec3::Y);
        run(&mut app, 60);
        let (hit, height) = below(&mut app, 0.8, 0.8).expect("the cuboid");
        assert!(hit == surface && (height - 1.0).abs() < 1e-3, "{name}: {height}");
        let resting = place(&app, ball).y;
        assert!((resting - 1.3).abs() < 1e-2, "{name}: the ball is at {resting}");
        assert_eq!(diagnostics(&app).surfaces, 0, "{name}");
    }

    // The same for a collider that was there before the surface.
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), cuboid());
    settle(&mut app);
    assert_eq!(
        (diagnostics(&app).surfaces, below(&mut app, 0.8, 0.8).map(|hit| hit.0)),
        (0, Some(surface))
    );
    app.world_mut().entity_mut(surface).remove::<MorphPhysicsCollider>();
    run(&mut app, 2);
    assert!(app.world().get::<Collider>(surface).is_some());
}

#[test]
fn a_disabled_surface_that_is_despawned_or_undone_leaves_nothing_behind() {
    let (mut app, surface, _) = ball_on_sheet();
    set_weights(&mut app, surface, &[0.01, 0.0]);
    run(&mut app, 1);
    app.world_mut().entity_mut(surface).insert(Disabled);
    run(&mut app, 2);
    assert_eq!(diagnostics(&app).parts, 0);
    assert_eq!(population(&mut app).1, 0, "only the ball's body is left");
    app.world_mut().entity_mut(surface).despawn();
    run(&mut app, 2);
    assert_eq!(population(&mut app), (1, 0));

    let (mut app, surface, ball) = ball_on_sheet();
    app.world_mut()
        .entity_mut(surface)
        .insert(Disabled)
        .remove::<MorphPhysicsCollider>();
    run(&mut app, 60);
    assert!(place(&app, ball).y < -1.0, "{}", place(&app, ball));
    assert_eq!(below(&mut app, 3.0, 3.1), None);
}

#[test]
fn a_body_that_becomes_fixed_in_its_sleep_needs_no_parts() {
    let (mut app, surface, ball) = ball_on_sheet();
    run(&mut app, 120);
    app.world_mut().entity_mut(ball).insert(RigidBody::Fixed);
    run(&mut app, 2);
    set_weights(&mut app, surface, &[-2.0, 0.0]);
    run(&mut app, 2);
    assert_eq!((diagnostics(&app).parts, population(&mut app).1), (0, 0));
}

#[test]
fn a_removed_collider_comes_back_while_the_surface_is_wanted() {
    let (mut app, surface, ball) = ball_on_sheet();
    app.world_mut().entity_mut(surface).remove::<Collider>();
    run(&mut app, 5);
    put(&mut app, ball, BALL);
    run(&mut app, 30);
    assert!((place(&app, ball).y - 0.3).abs() < 1e-2, "{}", place(&app, ball));
    app.world_mut()
        .entity_mut(surface)
        .remove::<(MorphPhysicsCollider, Collider)>();
    run(&mut app, 30);
    assert!(!app.world().entity(surface).contains::<Collider>());
    assert!(place(&app, ball).y < 0.0, "{}", place(&app, ball));
}
