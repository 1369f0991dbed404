//! Small fast bodies do not pass through moving surfaces.

use bevy::prelude::*;
use morph_collision_workspace::physics::bullets::Shots;
use morph_collision_workspace::physics::drops::Kind;
use morph_collision_workspace::physics::{settle, sheet};

use crate::support::{
    DT, DYNAMIC, Friction, GravityScale, LockedAxes, Method, app, ball, body, cuboid, diagnostics, fixed, flying,
    place, run, set_weights, spawn, trimesh,
};

const SHOTS: usize = 20;

#[test]
fn no_bullet_goes_through_a_surface_that_comes_towards_it() {
    let mut wrong = Vec::new();
    let mut shoot = |shots: Shots| {
        let hits = shots.fire(&Method::Ours, SHOTS);
        // They neither stick nor bounce off. Cuboids tumble.
        let slow = if shots.kind == Kind::Ball { 1.0 } else { 3.0 };
        if hits.through > 0 || hits.fastest > slow {
            wrong.push(format!("{hits:?} of {SHOTS}: {shots:?}"));
        }
    };
    for ccd in [false, true] {
        for (speed, rise) in [
            (5.0, 5.0),
            (20.0, 5.0),
            (20.0, 1.0),
            (20.0, -1.0),
            (100.0, 1.0),
            (100.0, 5.0),
            (300.0, 0.0),
        ] {
            for radius in [0.005, 0.02, 0.1] {
                shoot(Shots {
                    speed,
                    radius,
                    rise,
                    ccd,
                    ..Shots::SMALL
                });
            }
        }
        for (speed, rise) in [(20.0, 5.0), (100.0, 1.0)] {
            let kind = Kind::Cuboid;
            shoot(Shots {
                kind,
                speed,
                rise,
                ccd,
                ..Shots::SMALL
            });
        }
        for unit in [0.01, 10.0, 100.0] {
            shoot(Shots {
                unit,
                ccd,
                ..Shots::SMALL
            });
        }
        for rate in [10.0, 30.0, 240.0] {
            shoot(Shots {
                rate,
                ccd,
                ..Shots::SMALL
            });
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_lies_on_a_thin_floor_is_not_put_below_it() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    set_weights(&mut app, surface, &[1.0, 0.0]);
    run(&mut app, 5);
    let corners = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let floor = trimesh(&corners, &[[0, 2, 1], [0, 3, 2]]);
    app.world_mut().spawn((floor, fixed()));
    let debris: Vec<Entity> = (0..9)
        .map(|i| {
            let at = Vec3::new(0.2 * (i % 3) as f32 + 0.03, 0.05, 0.2 * (i / 3) as f32 + 0.07);
            body(&mut app, ball(0.05), at)
        })
        .collect();
    run(&mut app, 30);
    for step in 1..=60 {
        set_weights(&mut app, surface, &[1.0 - 2.0 * DT * step as f32, 0.0]);
        run(&mut app, 1);
        let lowest = debris.iter().map(|&ball| place(&app, ball).y).fold(f32::MAX, f32::min);
        assert!(lowest > 0.0, "{lowest} in step {step}");
    }
}

#[test]
fn a_body_with_several_colliders_is_moved_back_once() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    // Beside each, a single ball does the same.
    let pairs: Vec<[Entity; 2]> = (0..48)
        .map(|i| {
            let at = Vec3::new((i % 8) as f32 - 3.4, 2.5 + 0.04 * i as f32, (i / 8) as f32 - 2.4);
            let speed = if i % 2 == 0 { 20.0 } else { 100.0 };
            let single = body(&mut app, ball(0.02), at + Vec3::Z * 0.3);
            app.world_mut().entity_mut(single).insert(flying(Vec3::Y * -speed));
            let flight = (Transform::from_translation(at), flying(Vec3::Y * -speed));
            let dumbbell = (DYNAMIC, flight, LockedAxes::ROTATION_LOCKED);
            let dumbbell = app.world_mut().spawn(dumbbell).id();
            for x in [-0.1, 0.1] {
                let ball = (ball(0.02), Transform::from_xyz(x, 0.0, 0.0), ChildOf(dumbbell));
                app.world_mut().spawn(ball);
            }
            [dumbbell, single]
        })
        .collect();
    for step in 1..=60 {
        let height = 5.0 * DT * step as f32;
        set_weights(&mut app, surface, &[height, 0.0]);
        run(&mut app, 1);
        for pair in &pairs {
            let [above, expected] = pair.map(|body| place(&app, body).y - height);
            assert!(above > 0.0, "{above} in step {step}");
            assert!(
                (above - expected).abs() < 0.01,
                "{above}, not {expected} above the sheet in step {step}"
            );
        }
    }
}

/// A hundred crates on a sheet that slides. Returns the numbers of those that were compared with its triangles and of those for
/// which there was too much to do, in each of a few steps.
fn compared(cells: u32, slide: f32, speed: f32) -> Vec<(u32, u32)> {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(cells), ());
    settle(&mut app);
    for i in 0..100 {
        let at = Vec3::new(0.6 * (i % 10) as f32 - 2.7, 0.101, 0.6 * (i / 10) as f32 - 2.7);
        let load = body(&mut app, cuboid(Vec3::splat(0.1)), at);
        let more = (flying(Vec3::X * speed), Friction::new(0.0), GravityScale(0.0));
        app.world_mut().entity_mut(load).insert(more);
    }
    let mut counts = Vec::new();
    for step in 1..=4 {
        set_weights(&mut app, surface, &[0.0, slide * DT * step as f32]);
        run(&mut app, 1);
        let counted = diagnostics(&app);
        counts.push((counted.compared_bodies, counted.limited_bodies));
    }
    counts
}

#[test]
fn only_what_moves_fast_relative_to_the_surface_is_compared() {
    // The first step may be a jump.
    assert_eq!(compared(16, 10.0, 10.0)[1..], [(0, 0); 3], "riding crates");
    assert_eq!(compared(16, 10.0, 0.0)[1..], [(100, 0); 3], "crates at rest");
    // A jump passes nothing.
    assert_eq!(compared(16, 1000.0, 0.0)[0], (0, 0), "a jump");
}

#[test]
fn the_work_of_a_step_is_limited() {
    let counts = compared(128, 60.0, 0.0);
    // Then the sheet is away.
    let (some, others) = counts[1];
    assert!(some > 0 && others > 0 && some + others == 100, "{counts:?}");
}
