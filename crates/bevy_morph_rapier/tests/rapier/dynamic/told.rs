//! Contact events.

use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::DT;

use super::{grounded, thing};
use crate::support::{Log, diagnostics, pair, put, run, set_weights};

#[test]
fn contacts_are_told_once_and_forces_of_the_whole_surface() {
    let (mut app, surface) = grounded(3.0);
    let cuboid = thing(
        &mut app,
        Collider::cuboid(0.4, 0.3, 0.4),
        2.0,
        Vec3::new(0.0, 0.81, 0.05),
        (),
    );
    app.world_mut().entity_mut(cuboid).insert((
        ActiveEvents::COLLISION_EVENTS | ActiveEvents::CONTACT_FORCE_EVENTS,
        ContactForceEventThreshold(5.0),
    ));
    let mut log = Log::default();
    let mut cursor: MessageCursor<ContactForceEvent> = MessageCursor::default();
    let mut forces = Vec::new();
    let morph = |log: &mut Log, app: &mut App, frames: usize| {
        log.run(app, frames, |app, i| {
            // Rests for a while in between.
            let height = 0.01 * if i < 30 { i } else { (i.max(60)) - 30 } as f32;
            set_weights(app, surface, &[0.0, height * 0.3, 0.0, 0.0]);
        });
    };
    run(&mut app, 1);
    morph(&mut log, &mut app, 90);
    assert!(diagnostics(&app).parts > 1);
    assert_eq!(
        (log.started.clone(), log.ended.clone()),
        (vec![pair(surface, cuboid)], vec![])
    );
    cursor.clear(app.world().resource());
    for frame in 0..30 {
        let height = 0.18 + 0.1 * DT * (frame + 1) as f32;
        log.run(&mut app, 1, |app, _| {
            set_weights(app, surface, &[0.0, height, 0.0, 0.0]);
        });
        let told: Vec<_> = cursor
            .read(app.world().resource::<Messages<ContactForceEvent>>())
            .copied()
            .collect();
        if frame < 5 {
            // The box is thrown a little when the surface stops, and when it moves on.
            continue;
        }
        let [force] = told[..] else { panic!("{frame}: {told:?}") };
        assert_eq!((force.collider1, force.collider2), (surface, cuboid));
        forces.push(force.total_force_magnitude);
    }
    let mean = forces.iter().sum::<f32>() / forces.len() as f32;
    assert!((mean - 19.62).abs() < 1.0, "{forces:?}");
    // When it reaches other triangles, the force of a step may be larger.
    assert!(forces.iter().all(|force| (force - 19.62).abs() < 8.0), "{forces:?}");
    log.run(&mut app, 1, |app, _| put(app, cuboid, Vec3::new(0.0, 4.0, 0.0)));
    log.run(&mut app, 3, |_, _| {});
    assert_eq!(
        (log.started, log.ended),
        (vec![pair(surface, cuboid)], vec![pair(surface, cuboid)])
    );
}
