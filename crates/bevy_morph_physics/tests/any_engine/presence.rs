//! When a surface is in physics and when it is not: nothing stays behind, and a surface that comes back
//! carries bodies again.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_physics::prelude::*;
use morph_collision_workspace::physics::engine::Engine;
use morph_collision_workspace::physics::{bevy_mesh, settle, sheet};

use crate::support::{
    BALL, ColliderDisabled, Log, Method, Sensor, ball_on_sheet, below, diagnostics, fall_asleep, listening, pair,
    place, population, put, run, set_weights, velocity,
};

/// A change that a game makes to a surface.
type Change = fn(&mut App, Entity);

/// A way to take a surface out of physics and to bring it back.
struct Way {
    name: &'static str,
    take_out: Change,
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

fn ways() -> [Way; 8] {
    [
        without::<MorphPhysicsCollider>("no physics"),
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
        Way {
            name: "no mesh asset",
            take_out: |app, surface| {
                let mesh = app.world().get::<Mesh3d>(surface).unwrap().id();
                app.world_mut().resource_mut::<Assets<Mesh>>().remove(mesh);
            },
            bring_back: |app, _, mesh| {
                let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
                meshes
                    .insert(mesh.id(), bevy_mesh(&sheet(16)))
                    .expect("the handle is held");
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
fn whatever_takes_a_surface_out_takes_all_of_it_and_what_brings_it_back_brings_all_of_it() {
    for way in ways() {
        for (asleep, listens) in [(false, false), (true, false), (false, true)] {
            let name = format!("{}, asleep: {asleep}, listening: {listens}", way.name);
            let (mut app, surface, ball) = ball_on_sheet();
            let mesh = app.world().get::<Mesh3d>(surface).unwrap().clone();
            let mut log = Log::default();
            if asleep {
                fall_asleep(&mut app, ball);
            } else {
                Method::Ours.stay_awake(&mut app, ball);
            }
            if listens {
                // Only contacts that begin while somebody listens are reported.
                app.world_mut().entity_mut(ball).insert(listening());
                put(&mut app, ball, BALL + 0.2 * Vec3::Y);
                run(&mut app, 3);
                log = Log::from_now(&app);
                log.run(&mut app, 60, |_, _| {});
                assert_eq!((log.started.len(), log.ended.len()), (1, 0), "{name}");
            }
            (way.take_out)(&mut app, surface);
            log.run(&mut app, 60, |_, _| {});
            assert!(place(&app, ball).y < -1.0, "{name}: {}", place(&app, ball));
            assert_eq!(population(&mut app).1, 0, "{name}: parts were left");
            let left = diagnostics(&app);
            // What is nowhere may be a surface still.
            assert!(
                left.parts == 0 && (left.surfaces == 0 || way.name == "nowhere"),
                "{name}: {left:?}"
            );
            assert_eq!(below(&mut app, 3.0, 3.1), None, "{name}: a ghost");

            // Its motion in between throws nothing, even if it is small enough to be a motion in one step.
            set_weights(&mut app, surface, &[0.02, 0.0]);
            (way.bring_back)(&mut app, surface, mesh);
            settle(&mut app);
            put(&mut app, ball, BALL);
            let mut fastest: f32 = 0.0;
            log.run(&mut app, 60, |app, _| fastest = fastest.max(velocity(app, ball).y));
            assert!(fastest < 0.6, "{name}: thrown at {fastest}");
            let height = place(&app, ball).y;
            assert!((height - 0.32).abs() < 1e-2, "{name}: {height}");
            assert_eq!(population(&mut app), (3, 1), "{name}");
            let (hit, height) = below(&mut app, 3.0, 3.1).expect(&name);
            assert!(
                hit == surface && (height - 0.02).abs() < 1e-4,
                "{name}: {hit} at {height}"
            );
            for i in 1..=30 {
                set_weights(&mut app, surface, &[0.02 + 0.01 * i as f32, 0.0]);
                log.run(&mut app, 1, |_, _| {});
            }
            let speed = velocity(&app, ball).y;
            assert!((speed - 0.6).abs() < 0.02, "{name}: {speed}");
            if listens {
                let events = (log.started, log.ended);
                let touches = pair(surface, ball);
                assert_eq!(events, (vec![touches; 2], vec![touches]), "{name}");
            }
        }
    }
}

#[test]
fn a_surface_that_is_despawned_or_a_sensor_pushes_nothing() {
    let ways: [(&str, usize, Change); 2] = [
        ("despawned", 1, |app, surface| {
            app.world_mut().entity_mut(surface).despawn();
        }),
        ("a sensor", 2, |app, surface| {
            app.world_mut().entity_mut(surface).insert(Sensor);
        }),
    ];
    for (way, colliders, take_out) in ways {
        let (mut app, surface, ball) = ball_on_sheet();
        take_out(&mut app, surface);
        run(&mut app, 60);
        assert!(place(&app, ball).y < -1.0, "{way}: {}", place(&app, ball));
        assert_eq!(population(&mut app), (colliders, 0), "{way}");
    }
}

#[test]
fn a_swapped_mesh_is_another_surface() {
    let (mut app, surface, ball) = ball_on_sheet();
    let mut higher = sheet(8);
    higher.positions.iter_mut().for_each(|p| p.y += 0.2);
    let higher = app.world_mut().resource_mut::<Assets<Mesh>>().add(bevy_mesh(&higher));
    app.world_mut().entity_mut(surface).insert(Mesh3d(higher));
    settle(&mut app);
    run(&mut app, 2);
    // It fell while the tree was being built.
    put(&mut app, ball, BALL + 0.2 * Vec3::Y);
    run(&mut app, 60);
    assert!((place(&app, ball).y - 0.5).abs() < 1e-2, "{}", place(&app, ball));
    assert_eq!(population(&mut app), (3, 1));
}
