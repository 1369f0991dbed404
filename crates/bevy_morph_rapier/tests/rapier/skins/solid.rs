//! A skinned mesh with an inside.

use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::parry::math::Pose;
use bevy_rapier3d::parry::query::PointQuery;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::body;

use super::{TOP, app_with_arm, both};
use crate::support::{ask, place, run, velocity};

#[test]
fn what_is_inside_a_solid_limb_is_driven_out_and_seen() {
    for mirrored in [false, true] {
        let scale = if mirrored { Vec3::new(1.0, -1.0, 1.0) } else { Vec3::ONE };
        let (mut app, arm) = app_with_arm();
        let solid = MorphPhysicsCollider {
            solid: true,
            ..default()
        };
        app.world_mut().entity_mut(arm.surface).insert(solid);
        let bent = Transform::from_xyz(0.1, 0.2, -0.1).with_scale(scale);
        arm.pose(&mut app, [bent, bent.with_rotation(Quat::from_rotation_y(0.5))]);
        run(&mut app, 3);
        let middle = Vec3::new(-1.5, 0.3, -0.1);
        let seen = ask(&mut app, move |context| {
            let mut seen = Vec::new();
            let ball = Collider::ball(0.1);
            context.intersect_shape(middle, Quat::IDENTITY, &ball, QueryFilter::default(), |entity, _| {
                seen.push(entity);
                true
            });
            seen
        });
        assert_eq!(seen, [arm.surface]);
        let ball = body(&mut app, Collider::ball(0.1), middle);
        app.world_mut().entity_mut(ball).insert(GravityScale(0.0));
        let rests = body(
            &mut app,
            Collider::cuboid(0.1, 0.1, 0.1),
            Vec3::new(-2.5, 0.2 + TOP + 0.11, -0.1),
        );
        let mut fastest: f32 = 0.0;
        for _ in 0..60 {
            run(&mut app, 1);
            fastest = fastest.max(velocity(&app, ball).length());
        }
        let truth = arm.truth(&app);
        let gap = truth.distance_to_point(&Pose::IDENTITY, place(&app, ball), true) - 0.1;
        assert!(gap > -0.01 && fastest < 3.1, "{mirrored}: {gap}, {fastest}");
        assert!(place(&app, ball).y > 0.6, "{mirrored}: {}", place(&app, ball));
        let rests = place(&app, rests).y - 0.2 - TOP - 0.1;
        assert!(rests.abs() < 0.01, "{mirrored}: {rests}");
        // A limb that is mirrored while something lies on it still pushes outward.
        let back = bent.with_scale(Vec3::new(1.0, 1.0, -1.0) * scale);
        arm.pose(&mut app, both(back));
        run(&mut app, 30);
    }
}

#[test]
fn velocities_of_a_limb_are_those_of_the_place_that_is_asked_for() {
    let (mut app, arm) = app_with_arm();
    for i in 1..=20 {
        let turned = Quat::from_rotation_z(0.01 * i as f32);
        arm.pose(&mut app, [Transform::default(), Transform::from_rotation(turned)]);
        run(&mut app, 1);
    }
    // A hundredth of a radian per step of 1/60 s.
    let at = Quat::from_rotation_z(0.2) * Vec3::new(2.5, TOP, 0.0);
    let system = move |mut surfaces: MorphRapierVelocity| surfaces.surface_velocity(arm.surface, at).unwrap();
    use bevy::ecs::system::RunSystemOnce;
    let found = app.world_mut().run_system_once(system).unwrap();
    let expected = Vec3::Z.cross(at) * 0.6;
    assert!(found.distance(expected) < 0.05, "{found} for {expected}");
}
