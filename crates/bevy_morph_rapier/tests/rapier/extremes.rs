//! Random sizes and places from 1e-30 to 1e30, infinite and NaN: nothing panics, and other bodies are not affected.

use bevy::prelude::*;
use bevy_morph_rapier::MorphQueryDispatcher;
use bevy_rapier3d::parry::math::{Pose, Rotation};
use bevy_rapier3d::parry::query::details::ShapeCastOptions;
use bevy_rapier3d::parry::query::{
    ClosestPoints, ContactManifold, NonlinearRigidMotion, PersistentQueryDispatcher, QueryDispatcher,
};
use bevy_rapier3d::parry::shape::{Ball, Capsule, Cone, Cuboid, Cylinder, Shape, Triangle};
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{body, settle, sheet};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::support::{BALL, app, ball_on_sheet, place, run, set_weights, spawn};

/// A number of any size and sign.
fn any_size(random: &mut Pcg64) -> f32 {
    let size = 10f32.powf(random.random_range(-30.0..30.0));
    if random.random_bool(0.5) { size } else { -size }
}

/// A number that nobody would write.
fn extreme(random: &mut Pcg64) -> f32 {
    match random.random_range(0..10) {
        0 => f32::NAN,
        1 => f32::INFINITY,
        2 => -f32::MAX,
        3 => 0.0,
        4 | 5 => random.random_range(-2.0..2.0),
        _ => any_size(random),
    }
}

fn extreme_place(random: &mut Pcg64) -> Transform {
    let mut vector = |calm: bool, calm_value: Vec3| {
        if calm {
            return calm_value;
        }
        let one = extreme(random);
        if random.random_bool(0.5) {
            Vec3::splat(one)
        } else {
            Vec3::new(one, extreme(random), extreme(random))
        }
    };
    let translation = vector(false, Vec3::ZERO);
    let scale = vector(false, Vec3::ONE);
    let rotation = Quat::from_rotation_y(extreme(random));
    let mut place = Transform::IDENTITY;
    match random.random_range(0..4) {
        0 => place.translation = translation,
        1 => place.scale = scale,
        2 => place.rotation = rotation,
        _ => (place.translation, place.scale) = (translation, scale),
    }
    place
}

fn any_shape(random: &mut Pcg64, size: f32) -> Box<dyn Shape> {
    let corner = |random: &mut Pcg64| size * Vec3::from_array([(); 3].map(|()| random.random_range(-1.0..1.0)));
    match random.random_range(0..6) {
        0 => Box::new(Ball::new(size)),
        1 => Box::new(Cuboid::new(Vec3::splat(size))),
        2 => Box::new(Capsule::new_x(size, size)),
        3 => Box::new(Cylinder::new(size, size)),
        4 => Box::new(Cone::new(size, size)),
        _ => Box::new(Triangle::new(corner(random), corner(random), corner(random))),
    }
}

const CALM: [Vec3; 3] = [BALL, Vec3::new(-2.0, 0.4, 1.0), Vec3::new(2.0, 0.5, -1.5)];

/// Sheets and balls that must not be affected, in an app to which more is added.
fn calm() -> (App, [Entity; 3], Entity) {
    let mut app = app();
    let calm = CollisionGroups::new(Group::GROUP_1, Group::GROUP_1);
    let surface = spawn(&mut app, &sheet(16), calm);
    settle(&mut app);
    let balls = CALM.map(|at| {
        let ball = body(&mut app, Collider::ball(0.3), at);
        app.world_mut().entity_mut(ball).insert((calm, Sleeping::disabled()));
        ball
    });
    (app, balls, surface)
}

fn rise(app: &mut App, surface: Entity, step: usize) {
    let height = 0.3 * (0.05 * step as f32).sin();
    set_weights(app, surface, &[height, 0.0]);
}

const STEPS: usize = 120;

#[test]
fn no_step_panics_and_calm_bodies_elsewhere_move_as_if_they_were_alone() {
    let (mut alone, balls, surface) = calm();
    let mut expected = Vec::new();
    for step in 0..STEPS {
        rise(&mut alone, surface, step);
        run(&mut alone, 1);
        expected.push(balls.map(|ball| place(&alone, ball)));
    }
    for seed in 0..12 {
        let mut random = Pcg64::seed_from_u64(seed);
        let (mut app, balls, surface) = calm();
        // Bodies collide only with surfaces. How Parry handles large bodies with each other is not tested here.
        let of_surfaces = CollisionGroups::new(Group::GROUP_2, Group::GROUP_3);
        let of_bodies = CollisionGroups::new(Group::GROUP_3, Group::GROUP_2);
        let kinds = [
            None,
            Some(RigidBody::Fixed),
            Some(RigidBody::KinematicPositionBased),
            Some(RigidBody::Dynamic),
        ];
        let mut troubled = Vec::new();
        for i in 0..6 {
            let surface = spawn(&mut app, &sheet(4), of_surfaces);
            if let Some(kind) = kinds[i % kinds.len()] {
                app.world_mut().entity_mut(surface).insert((kind, GravityScale(0.0)));
            }
            if random.random_bool(0.5) {
                app.world_mut()
                    .entity_mut(surface)
                    .insert(ActiveEvents::COLLISION_EVENTS);
            }
            troubled.push(surface);
        }
        for _ in 0..8 {
            let size = any_size(&mut random).abs();
            let size = if random.random_bool(0.5) { 0.5 } else { size };
            let shape = match random.random_range(0..4) {
                0 => Collider::ball(size),
                1 => Collider::cuboid(size, size, size),
                2 => Collider::capsule_x(size, size),
                _ => Collider::cylinder(size, size),
            };
            let at = Vec3::new(random.random_range(-3.0..3.0), 0.5, random.random_range(-3.0..3.0));
            let it = body(&mut app, shape, at);
            app.world_mut().entity_mut(it).insert((of_bodies, GravityScale(0.1)));
            if random.random_bool(0.3) {
                app.world_mut().entity_mut(it).insert(Ccd::enabled());
            }
            troubled.push(it);
        }
        let surfaces = 6;
        for (step, expected) in expected.iter().enumerate() {
            for _ in 0..2 {
                let which = random.random_range(0..troubled.len());
                let mut entity = app.world_mut().entity_mut(troubled[which]);
                // Bodies that Rapier has disabled get another try.
                entity.remove::<(RigidBodyDisabled, ColliderDisabled)>();
                match random.random_range(0..4) {
                    0 => {
                        let mut place = extreme_place(&mut random);
                        if which >= surfaces {
                            // Parry refuses to mirror some of its own shapes.
                            place.scale = Vec3::ONE;
                        }
                        entity.insert(place);
                    }
                    1 => {
                        entity.insert(Transform::from_xyz(0.0, 0.2, 0.0));
                    }
                    2 if which < surfaces => {
                        let weights = [extreme(&mut random), extreme(&mut random)];
                        set_weights(&mut app, troubled[which], &weights);
                    }
                    _ => {
                        entity.insert(Velocity::linear(Vec3::Y * extreme(&mut random)));
                    }
                }
            }
            rise(&mut app, surface, step);
            run(&mut app, 1);
            for (&ball, &expected) in balls.iter().zip(expected) {
                let off = place(&app, ball) - expected;
                assert!(off.length() < 1e-3, "seed {seed}, step {step}: off by {off}");
            }
        }
    }
}

#[test]
fn no_question_about_a_surface_panics_and_what_is_out_of_range_is_out_of_reach() {
    let (app, surface, _) = ball_on_sheet();
    let surface = app.world().get::<Collider>(surface).unwrap().raw.clone();
    let dispatcher = MorphQueryDispatcher;
    let mut random = Pcg64::seed_from_u64(7);
    let (mut inside, mut outside) = (0, 0);
    for case in 0..1000 {
        let size = any_size(&mut random).abs();
        let shape = any_shape(&mut random, size);
        let mut translation = Vec3::from_array([(); 3].map(|()| random.random_range(-2.0..2.0)));
        if random.random_bool(0.3) {
            translation[random.random_range(0..3)] = extreme(&mut random);
        }
        let rotation = Rotation::from_rotation_x(random.random_range(-3.0..3.0));
        let pose = Pose::from_parts(translation, rotation);
        let velocity = Vec3::new(extreme(&mut random), extreme(&mut random), -1.0);
        let (swapped, reach) = (random.random_bool(0.5), random.random_range(0.0..1.0));
        let (g1, g2): (&dyn Shape, &dyn Shape) = if swapped {
            (&*shape, &*surface)
        } else {
            (&*surface, &*shape)
        };

        let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
        let made = dispatcher.contact_manifolds(&pose, g1, g2, reach, &mut manifolds, &mut None);
        let contact = dispatcher.contact(&pose, g1, g2, reach);
        let distance = dispatcher.distance(&pose, g1, g2);
        let intersection = dispatcher.intersection_test(&pose, g1, g2);
        let closest = dispatcher.closest_points(&pose, g1, g2, reach);
        let options = ShapeCastOptions::with_max_time_of_impact(10.0);
        let cast = dispatcher.cast_shapes(&pose, velocity, g1, g2, options);
        let still = NonlinearRigidMotion::constant_position(Pose::IDENTITY);
        let moving = NonlinearRigidMotion::new(pose, Vec3::ZERO, velocity, Vec3::ZERO);
        let nonlinear = dispatcher.cast_shapes_nonlinear(&still, g1, &moving, g2, 0.0, 0.02, true);

        let in_range = |v: Vec3| v.abs().max_element() <= 0.9e8 && v.is_finite();
        let out_of_range = |v: Vec3| !v.is_finite() || v.abs().max_element() > 4e8;
        let touches = |distance: f32| distance == 0.0;
        if out_of_range(translation) || size > 1e9 {
            outside += 1;
            assert!(
                made.is_ok() && manifolds.iter().all(|manifold| manifold.points.is_empty()),
                "{case}"
            );
            assert_eq!(contact.unwrap(), None, "{case}");
            assert_eq!(distance.unwrap().distance, f32::MAX, "{case}");
            assert!(!intersection.unwrap().intersecting, "{case}");
            assert_eq!(closest.unwrap(), ClosestPoints::Disjoint, "{case}");
            assert!(cast.unwrap().is_none() && nonlinear.unwrap().is_none(), "{case}");
        } else if in_range(translation) && (1e-2..1e7).contains(&size) {
            inside += 1;
            let (distance, intersects) = (distance.unwrap().distance, intersection.unwrap().intersecting);
            // The sheet is at height 0 and 8 wide: shapes that are tall enough and near it intersect it.
            let bounds = shape.compute_aabb(&if swapped { pose.inverse() } else { pose });
            if bounds.mins.y > 1e-3 * size + 1e-3 || bounds.maxs.y < -1e-3 * size - 1e-3 {
                assert!(!intersects && !touches(distance), "{case}: {distance}");
            }
            if intersects {
                assert!(distance < 1e-3 * size + 1e-3, "{case}: {distance}");
            }
            if out_of_range(velocity) {
                assert!(cast.unwrap().is_none() && nonlinear.unwrap().is_none(), "{case}");
            }
        }
    }
    assert!(inside > 100 && outside > 300, "{inside}, {outside}");
}
