//! Rapier's reports about a surface, and the joints that it respects, are those of one collider, whatever parts push in its
//! place.

use std::path::Path;

use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::app::headless;
use morph_collision_workspace::physics::{DT, body, settle, sheet};

use crate::log::start;
use crate::support::{Log, app, ask, diagnostics, pair, place, put, run, set_weights, spawn};

/// A sheet whose last target is a wave. No rigid motion fits it, so it is split into parts.
fn waving() -> MorphMesh {
    let mut mesh = sheet(32);
    let wave = mesh
        .positions
        .iter()
        .map(|p| Vec3::Y * 0.05 * (9.0 * p.x).sin())
        .collect();
    mesh.targets.push(wave);
    mesh
}

/// Makes waves, and comes to rest flat.
fn wave(app: &mut App, surface: Entity, frames: usize) {
    for frame in 1..=frames {
        let height = (12.0 * DT * frame as f32).sin() * (1.0 - frame as f32 / frames as f32);
        set_weights(app, surface, &[0.0, 0.0, height]);
        run(app, 1);
    }
}

#[test]
fn contact_forces_are_those_of_the_whole_surface() {
    for events in [ActiveEvents::CONTACT_FORCE_EVENTS, ActiveEvents::all()] {
        for on_surface in [false, true] {
            let mut app = app();
            let surface = spawn(&mut app, &waving(), ());
            settle(&mut app);
            let cuboid = body(&mut app, Collider::cuboid(0.6, 0.3, 0.6), Vec3::new(0.0, 0.31, 0.05));
            app.world_mut()
                .entity_mut(cuboid)
                .insert((ColliderMassProperties::Mass(2.0), Sleeping::disabled()));
            let asks = if on_surface { surface } else { cuboid };
            app.world_mut()
                .entity_mut(asks)
                .insert((events, ContactForceEventThreshold(15.0)));
            wave(&mut app, surface, 60);
            run(&mut app, 60);
            assert!(diagnostics(&app).parts > 1, "there is one part alone");
            let mut cursor: MessageCursor<ContactForceEvent> = MessageCursor::default();
            cursor.clear(app.world().resource());
            for frame in 0..10 {
                run(&mut app, 1);
                let forces: Vec<_> = cursor.read(app.world().resource()).copied().collect();
                let [force] = forces[..] else {
                    panic!("{events:?}, frame {frame}: {forces:?}")
                };
                assert_eq!((force.collider1, force.collider2), (surface, cuboid));
                assert!((force.total_force_magnitude - 19.62).abs() < 1.0, "{force:?}");
                assert!((force.total_force.length() - 19.62).abs() < 1.0, "{force:?}");
                assert!(
                    force.total_force.y.abs() > 18.0 && force.max_force_direction.y.abs() > 0.9,
                    "{force:?}"
                );
                assert!(force.max_force_magnitude < 19.0 && !force.started, "{force:?}");
            }
            // The box weighs less than the threshold.
            app.world_mut()
                .entity_mut(asks)
                .insert(ContactForceEventThreshold(25.0));
            run(&mut app, 2);
            cursor.clear(app.world().resource());
            run(&mut app, 5);
            assert_eq!(cursor.read(app.world().resource()).count(), 0);
            app.world_mut()
                .entity_mut(asks)
                .insert(ContactForceEventThreshold(15.0));
            run(&mut app, 3);
            let started: Vec<bool> = cursor.read(app.world().resource()).map(|force| force.started).collect();
            assert_eq!(started, [true, false, false]);
        }
    }
}

/// Lets marked entities fall through surfaces.
#[derive(bevy::ecs::system::SystemParam)]
struct Falls<'w, 's> {
    marked: Query<'w, 's, Entity, With<Name>>,
    surfaces: Query<'w, 's, Entity, With<MorphPhysicsCollider>>,
}

impl BevyPhysicsHooks for Falls<'_, '_> {
    fn filter_contact_pair(&self, context: PairFilterContextView) -> Option<SolverFlags> {
        let pair = [context.collider1(), context.collider2()];
        let falls = pair.iter().any(|&entity| self.marked.contains(entity))
            && pair.iter().any(|&entity| self.surfaces.contains(entity));
        (!falls).then_some(SolverFlags::COMPUTE_RIGID_IMPULSES)
    }
}

fn hooked_app(substeps: usize) -> App {
    let mut app = headless(Path::new("."));
    app.add_plugins((RapierPhysicsPlugin::<Falls>::default(), MorphRapierPlugin))
        .insert_resource(TimestepMode::Fixed { dt: DT, substeps });
    start(&mut app);
    app
}

/// Lets a box slide over a moving sheet, lifts it off, and returns the events about it. `hooked` is given to the box, and to a
/// ball on a floor far away.
fn heard(
    substeps: usize,
    hooked: [bool; 2],
    wave: f32,
    mut each: impl FnMut(&mut App, [Entity; 2]),
) -> (Log, (Entity, Entity)) {
    let mut app = hooked_app(substeps);
    let surface = spawn(&mut app, &waving(), CollidingEntities::default());
    let floor = (Collider::cuboid(1.0, 0.5, 1.0), Transform::from_xyz(30.0, -0.5, 0.0));
    app.world_mut().spawn(floor);
    settle(&mut app);
    let slippery = Friction {
        coefficient: 0.0,
        combine_rule: CoefficientCombineRule::Min,
    };
    let slides = body(&mut app, Collider::cuboid(0.3, 0.3, 0.3), Vec3::new(-2.0, 0.31, 0.05));
    let other = body(&mut app, Collider::ball(0.3), Vec3::new(30.0, 0.4, 0.0));
    let events = (
        ActiveEvents::COLLISION_EVENTS,
        slippery,
        Velocity::linear(Vec3::X * 3.0),
    );
    app.world_mut().entity_mut(slides).insert(events);
    for (entity, hooked) in [slides, other].into_iter().zip(hooked) {
        if hooked {
            app.world_mut()
                .entity_mut(entity)
                .insert(ActiveHooks::FILTER_CONTACT_PAIRS);
        }
    }
    let mut log = Log::default();
    log.run(&mut app, 60, |app, i| {
        let time = DT * i as f32;
        set_weights(
            app,
            surface,
            &[0.2 * time.sin(), 0.3 * time, wave * (12.0 * time).sin()],
        );
        each(app, [surface, slides]);
    });
    assert!(
        place(&app, slides).x > 0.5 && place(&app, slides).y < 0.6,
        "{}",
        place(&app, slides)
    );
    log.run(&mut app, 1, |app, _| put(app, slides, Vec3::new(0.0, 4.0, 0.0)));
    log.run(&mut app, 3, |_, _| {});
    let colliding = app.world().get::<CollidingEntities>(surface).unwrap();
    assert!(
        colliding.is_empty(),
        "it still touches {:?}",
        colliding.iter().collect::<Vec<_>>()
    );
    (log, pair(surface, slides))
}

#[test]
fn hooks_of_others_do_not_disturb_events() {
    let (log, pair) = heard(1, [false, true], 0.0, |_, _| {});
    assert_eq!((log.started, log.ended), (vec![pair], vec![pair]));
    // Anything may come near between substeps, so events may repeat.
    let (log, pair) = heard(2, [false, true], 0.0, |_, _| {});
    assert!(log.started.contains(&pair) && log.ended.contains(&pair));
}

#[test]
fn with_hooks_of_its_own_the_last_event_is_right() {
    let mut touching = 0;
    let (log, pair) = heard(1, [true, false], 1.0, |app, [surface, slides]| {
        let touches = ask(app, move |context| {
            let contact = context.contact_pair(surface, slides);
            contact.is_some_and(|pair| pair.has_any_active_contact())
        });
        let colliding = app.world().get::<CollidingEntities>(surface).unwrap();
        assert_eq!(colliding.contains(slides), touches);
        touching += usize::from(touches);
    });
    assert!(touching > 30, "{touching}");
    assert!(log.started.iter().chain(&log.ended).all(|&heard| heard == pair));
    assert!(!log.started.is_empty() && !log.ended.is_empty());
}

#[test]
fn hooks_know_the_surface_in_every_substep() {
    let mut app = hooked_app(2);
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    // With a listener, parts would prefer not to have names.
    let listens = body(&mut app, Collider::cuboid(0.3, 0.3, 0.3), Vec3::new(2.0, 0.31, 0.05));
    let events = (ActiveEvents::COLLISION_EVENTS, Sleeping::disabled());
    app.world_mut().entity_mut(listens).insert(events);
    run(&mut app, 5);
    // Far away in the first substep, at the surface in the second.
    let comes = body(&mut app, Collider::ball(0.3), Vec3::new(0.0, 2.0, 0.05));
    let hooks = (
        ActiveHooks::FILTER_CONTACT_PAIRS,
        Velocity::linear(Vec3::Y * -190.0),
        Name::new("falls"),
    );
    app.world_mut().entity_mut(comes).insert(hooks);
    set_weights(&mut app, surface, &[0.01, 0.0]);
    run(&mut app, 1);
    assert!(place(&app, comes).y < 0.0, "{}", place(&app, comes));
}

/// A joint that constrains nothing; for a multibody it starts at this place.
fn free(contacts: bool, at: Vec3) -> GenericJoint {
    let mut joint = GenericJoint::new(JointAxesMask::empty());
    joint.set_contacts_enabled(contacts).set_local_anchor1(at);
    joint
}

#[test]
fn joints_without_contacts_keep_a_surface_from_pushing() {
    for multibody in [false, true] {
        let mut app = app();
        let surface = spawn(&mut app, &sheet(16), RigidBody::KinematicPositionBased);
        settle(&mut app);
        // The two are near each other, so that both touch the same triangles. The joined one is at a height at which it would be
        // pushed up.
        let free_ball = body(&mut app, Collider::ball(0.3), Vec3::new(0.0, 0.3, 0.05));
        run(&mut app, 5);
        let at = Vec3::new(0.45, 0.21, 0.05);
        let held = body(&mut app, Collider::ball(0.2), at);
        let mut entity = app.world_mut().entity_mut(held);
        if multibody {
            entity.insert(MultibodyJoint::new(surface, free(false, at)));
        } else {
            entity.insert(ImpulseJoint::new(surface, free(false, at)));
        }
        for frame in 1..=40 {
            set_weights(&mut app, surface, &[0.2 * DT * frame as f32, 0.0]);
            run(&mut app, 1);
        }
        let (stays, falls) = (place(&app, free_ball), place(&app, held));
        assert!((stays.y - 0.3 - 0.2 * DT * 40.0).abs() < 1e-2, "{multibody}: {stays}");
        assert!(falls.y < -0.5, "{multibody}: {falls}");

        // With contacts enabled, or without a joint, it is pushed like other bodies.
        if multibody {
            app.world_mut().entity_mut(held).remove::<MultibodyJoint>();
        } else {
            app.world_mut()
                .entity_mut(held)
                .insert(ImpulseJoint::new(surface, free(true, at)));
        }
        run(&mut app, 1);
        let joints = app.world_mut().query::<&RapierContextJoints>().single(app.world());
        assert_eq!(
            joints.unwrap().impulse_joints.len(),
            usize::from(!multibody),
            "some are left behind"
        );
        put(&mut app, held, Vec3::new(0.45, 0.5, 0.05));
        run(&mut app, 60);
        assert!(place(&app, held).y > 0.3, "{multibody}: {}", place(&app, held));
    }
}
