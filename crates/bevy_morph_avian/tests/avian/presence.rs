//! When a surface is in physics and when it is not: nothing stays behind, and a surface that comes back carries
//! bodies again.

use avian3d::prelude::*;
use bevy::prelude::*;

use crate::support::{BALL, ball_on_sheet, place, population, put, run};

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
