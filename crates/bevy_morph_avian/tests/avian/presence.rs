//! When a surface is in physics and when it is not: nothing stays behind, and a surface that comes back carries
//! bodies again.

use avian3d::prelude::*;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_morph_avian::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::physics::{bevy_mesh, settle, sheet};

use crate::support::{BALL, ball_on_sheet, below, diagnostics, place, population, put, run, set_weights, velocity};

fn add_sheet(app: &mut App, height: f32) -> Mesh3d {
    let mut mesh = sheet(8);
    mesh.positions.iter_mut().for_each(|p| p.y += height);
    Mesh3d(app.world_mut().resource_mut::<Assets<Mesh>>().add(bevy_mesh(&mesh)))
}

/// A way to take a surface out of physics and to bring it back.
struct Way {
    name: &'static str,
    take_out: fn(&mut App, Entity),
    bring_back: fn(&mut App, Entity, Mesh3d),
}

/// Inserts a component and removes it again.
fn with<C: Component + Default>(name: &'static str) -> Way {
    Way {
        name,
        take_out: |app, surface| {
            app.world_mut().entity_mut(surface).insert(C::default());
        },
        bring_back: |app, surface, _| {
            app.world_mut().entity_mut(surface).remove::<C>();
        },
    }
}

/// Removes a component and inserts it again.
fn without<C: Component + Default>(name: &'static str) -> Way {
    Way {
        name,
        take_out: |app, surface| {
            app.world_mut().entity_mut(surface).remove::<C>();
        },
        bring_back: |app, surface, _| {
            app.world_mut().entity_mut(surface).insert(C::default());
        },
    }
}

fn ways() -> [Way; 7] {
    [
        without::<MorphPhysicsCollider>("not asked for"),
        without::<MorphCollider>("no collider"),
        Way {
            name: "no mesh",
            take_out: |app, surface| {
                app.world_mut().entity_mut(surface).remove::<Mesh3d>();
            },
            bring_back: |app, surface, mesh| {
                app.world_mut().entity_mut(surface).insert(mesh);
            },
        },
        with::<MorphColliderDisabled>("detection disabled"),
        with::<ColliderDisabled>("collider disabled"),
        with::<Disabled>("disabled"),
        Way {
            name: "nowhere",
            take_out: |app, surface| {
                app.world_mut().get_mut::<Transform>(surface).unwrap().translation.y = 1e20;
            },
            bring_back: |app, surface, _| {
                app.world_mut().get_mut::<Transform>(surface).unwrap().translation.y = 0.0;
            },
        },
    ]
}

#[test]
fn what_is_taken_out_leaves_nothing_and_what_comes_back_carries() {
    for asleep in [false, true] {
        for Way {
            name,
            take_out,
            bring_back,
        } in ways()
        {
            let (mut app, surface, ball) = ball_on_sheet();
            let mesh = app.world().get::<Mesh3d>(surface).unwrap().clone();
            // Another collider keeps its tree ready.
            app.world_mut()
                .spawn((mesh.clone(), MorphCollider::default(), MorphColliderDisabled));
            if asleep {
                run(&mut app, 120);
                assert!(app.world().entity(ball).contains::<Sleeping>());
            }
            take_out(&mut app, surface);
            run(&mut app, 30);
            assert!(place(&app, ball).y < 0.0, "{name}: {}", place(&app, ball));
            assert_eq!(population(&mut app).1, 0, "{name}");
            assert_eq!(below(&mut app, 2.0, 2.0), [], "{name}");
            assert_eq!(diagnostics(&app).parts, 0, "{name}");

            bring_back(&mut app, surface, mesh);
            // Its motion in between throws nothing, even if it is small enough to be a motion in one step.
            set_weights(&mut app, surface, &[0.02, 0.0]);
            put(&mut app, ball, Vec3::new(0.1, 0.301, 0.05));
            let mut fastest: f32 = 0.0;
            for _ in 0..30 {
                run(&mut app, 1);
                fastest = fastest.max(velocity(&app, ball).y);
            }
            assert!(fastest < 0.6, "{name}: thrown at {fastest}");
            assert!(
                (place(&app, ball).y - 0.32).abs() < 1e-2,
                "{name}: {}",
                place(&app, ball)
            );
            for i in 1..=30 {
                set_weights(&mut app, surface, &[0.02 + 0.01 * i as f32, 0.0]);
                run(&mut app, 1);
            }
            assert!(
                (velocity(&app, ball).y - 0.6).abs() < 0.02,
                "{name}: {}",
                velocity(&app, ball)
            );
            assert_eq!(below(&mut app, 2.0, 2.0).len(), 1, "{name}");
        }
    }
}

#[test]
fn a_despawned_surface_leaves_nothing() {
    let (mut app, surface, ball) = ball_on_sheet();
    app.world_mut().entity_mut(surface).despawn();
    run(&mut app, 10);
    assert_eq!(population(&mut app), (1, 0));
    assert!(velocity(&app, ball).y < -1.0);
}

#[test]
fn a_swapped_mesh_is_another_surface() {
    let (mut app, surface, ball) = ball_on_sheet();
    let higher = add_sheet(&mut app, 0.2);
    app.world_mut().entity_mut(surface).insert(higher);
    settle(&mut app);
    run(&mut app, 2);
    // It fell while the tree was being built.
    put(&mut app, ball, BALL + 0.2 * Vec3::Y);
    run(&mut app, 60);
    assert!((place(&app, ball).y - 0.5).abs() < 1e-2, "{}", place(&app, ball));
    assert_eq!(population(&mut app), (3, 1));
}

#[test]
fn a_surface_scaled_to_zero_touches_nothing_and_carries_when_it_is_large_again() {
    let (mut app, surface, ball) = ball_on_sheet();
    app.world_mut().get_mut::<Transform>(surface).unwrap().scale = Vec3::ZERO;
    run(&mut app, 30);
    assert!(place(&app, ball).y < 0.0, "{}", place(&app, ball));
    app.world_mut().get_mut::<Transform>(surface).unwrap().scale = Vec3::ONE;
    put(&mut app, ball, BALL);
    run(&mut app, 30);
    assert!((place(&app, ball).y - 0.3).abs() < 2e-2, "{}", place(&app, ball));
}

#[test]
fn a_collider_of_the_games_own_wins() {
    let (mut app, surface, ball) = ball_on_sheet();
    app.world_mut()
        .entity_mut(surface)
        .insert(Collider::cuboid(0.1, 0.1, 0.1));
    run(&mut app, 30);
    assert_eq!(population(&mut app), (2, 0));
    assert!(
        app.world()
            .get::<Collider>(surface)
            .unwrap()
            .shape()
            .as_cuboid()
            .is_some()
    );
    assert!(place(&app, ball).y < 0.3);
}

#[test]
fn a_joint_without_contacts_spares_what_it_holds() {
    let (mut app, surface, ball) = ball_on_sheet();
    app.world_mut().entity_mut(surface).insert(RigidBody::Static);
    let loose = DistanceJoint::new(surface, ball).with_limits(0.0, 100.0);
    app.world_mut().spawn((loose, JointCollisionDisabled));
    run(&mut app, 30);
    assert!(place(&app, ball).y < 0.0, "{}", place(&app, ball));
}
