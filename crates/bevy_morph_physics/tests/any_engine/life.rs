//! What surfaces cost.

use bevy::prelude::*;
use morph_collision_models::generated::random;
use morph_collision_workspace::physics::{settle, sheet};

use crate::support::{
    DYNAMIC, FIXED, GravityScale, app, ball_on_sheet, diagnostics, fall_asleep, is_attached, mass_of_body,
    mass_of_collider, place, population, run, set_weights, spawn, weighed,
};

#[test]
fn parts_come_with_bodies_and_go_with_them() {
    let (mut app, _, ball) = ball_on_sheet();
    assert_eq!((population(&mut app), diagnostics(&app).parts), ((3, 1), 1));
    app.world_mut().entity_mut(ball).despawn();
    run(&mut app, 2);
    assert_eq!(population(&mut app), (1, 0));
}

#[test]
fn what_nothing_can_touch_is_not_blended() {
    let (mut app, surface, ball) = ball_on_sheet();
    // A second surface far away.
    let far = spawn(&mut app, &sheet(16), Transform::from_xyz(100.0, 0.0, 0.0));
    settle(&mut app);
    run(&mut app, 3);
    let resting = diagnostics(&app);
    assert_eq!((resting.surfaces, resting.moving, resting.parts), (2, 0, 1));
    assert_eq!(resting.blended, 0, "nothing moves, the ball stays where it is");
    for i in 1..=10 {
        for surface in [surface, far] {
            set_weights(&mut app, surface, &[0.01 * i as f32, 0.0]);
        }
        run(&mut app, 1);
        let moving = diagnostics(&app);
        assert_eq!((moving.moving, moving.parts, moving.blended), (2, 1, 1));
    }
    // A sleeping body on a resting surface needs no work.
    fall_asleep(&mut app, ball);
    assert_eq!((diagnostics(&app).parts, diagnostics(&app).blended), (1, 0));
    assert!((place(&app, ball).y - 0.4).abs() < 1e-2, "{}", place(&app, ball));
}

#[test]
fn the_mass_of_a_large_surface_is_there_when_a_body_needs_it_and_elsewhere_a_few_steps_later() {
    let mut app = app();
    let mesh = random::random_blob(1, 4, 1, 0.0);
    let alone = spawn(&mut app, &mesh, weighed());
    let at = |x: f32| (Transform::from_xyz(x, 0.0, 0.0), GravityScale(0.0), weighed());
    let dynamic = spawn(&mut app, &mesh, (at(10.0), DYNAMIC));
    let late = spawn(&mut app, &mesh, (at(20.0), FIXED));
    // Trees are built in the background, so any may come first.
    let mut first = [None; 2];
    while first.contains(&None) {
        app.update();
        for (first, surface) in first.iter_mut().zip([dynamic, late]) {
            if first.is_none() && is_attached(&app, surface) {
                *first = Some(mass_of_collider(&app, surface));
            }
        }
    }
    let [of_dynamic, of_late] = first.map(Option::unwrap_or_default);
    let corners = mesh
        .triangles
        .iter()
        .map(|t| t.map(|i| mesh.positions[i as usize].as_dvec3()));
    let volume = corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum::<f64>() as f32;
    let is_right = |mass: f32| (mass / volume - 1.0).abs() < 1e-4;
    assert!(is_right(of_dynamic) && is_right(mass_of_body(&app, dynamic)));
    assert_eq!(of_late, 0.0, "it takes a few steps");
    app.world_mut().entity_mut(late).insert(DYNAMIC);
    run(&mut app, 2);
    let of_body = mass_of_body(&app, late);
    assert!(is_right(of_body), "{of_body} {volume}");
    run(&mut app, 10);
    for surface in [alone, dynamic, late] {
        let mass = mass_of_collider(&app, surface);
        assert!(is_right(mass), "{mass} {volume}");
    }
}
