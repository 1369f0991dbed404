//! Closed surfaces with an inside: bodies that get in are driven out, and sensors see what is inside.

mod sensors;
mod sides;

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_models::generated::rigid::box_mesh;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::physics::{DT, body, settle};

use crate::any_engine::solid::{LEAVES, SLAB, SOLID, depth, floating, leave, with_slab};
use crate::support::{DRIVEN, app, place, run, set_weights, slab, spawn, velocity};
#[test]
fn what_is_far_inside_a_large_body_finds_out() {
    let half = Vec3::splat(4.0);
    let (mut app, _) = with_slab(half, true, ());
    let ball = floating(&mut app, Collider::ball(0.2), Vec3::new(0.3, 1.2, 0.1));
    let (steps, fastest, _) = leave(&mut app, ball, half);
    println!("{steps} steps, {fastest}/s");
    assert!(
        (40..120).contains(&steps) && fastest < 1.02 * DRIVEN,
        "{steps}, {fastest}"
    );
}

#[test]
fn small_things_and_bullets_are_driven_out() {
    for (size, bullet) in [(0.03, false), (0.03, true), (0.2, true), (0.004, false)] {
        for shape in [Collider::ball(size), Collider::cuboid(size, size, size)] {
            let (mut app, _) = with_slab(SLAB, true, ());
            let body = floating(&mut app, shape, Vec3::new(0.1, 0.2, 0.05));
            if bullet {
                app.world_mut().entity_mut(body).insert(Ccd::enabled());
            }
            run(&mut app, 90);
            let out = depth(place(&app, body), SLAB);
            assert!(out < -0.9 * size, "{size}, {bullet}: {}", place(&app, body));
            assert!(velocity(&app, body).length() < 1.2 * LEAVES, "{}", velocity(&app, body));
        }
    }
}

#[test]
fn what_a_jump_swallows_while_it_sleeps_leaves_too() {
    let (mut app, surface) = with_slab(SLAB, true, ());
    let cuboid = body(&mut app, Collider::cuboid(0.15, 0.15, 0.15), Vec3::new(0.1, 0.66, 0.05));
    app.world_mut().entity_mut(cuboid).insert(Sleeping::default());
    run(&mut app, 300);
    assert!(app.world().get::<Sleeping>(cuboid).unwrap().sleeping);
    // Its upper side is far above the box, which is nearer to the lower side.
    set_weights(&mut app, surface, &[0.0, 1.5, 0.0, 0.0]);
    run(&mut app, 180);
    let rests = place(&app, cuboid).y;
    assert!((rests - 2.15).abs() < 1e-2, "{rests}");
}

#[test]
fn a_surface_that_grows_over_a_body_lets_it_out() {
    // Faster than contacts can follow: by 0.3 in each of four steps.
    let (mut app, surface) = with_slab(SLAB, true, ());
    let ball = floating(&mut app, Collider::ball(0.2), Vec3::new(0.1, 0.9, 0.05));
    run(&mut app, 5);
    for i in 1..=4 {
        set_weights(&mut app, surface, &[0.0, 0.3 * i as f32, 0.0, 0.0]);
        run(&mut app, 1);
    }
    run(&mut app, 90);
    let (at, speed) = (place(&app, ball), velocity(&app, ball));
    println!("{at}, {speed}");
    assert!(at.y > 1.89, "{at}");
}

/// Two jaws that snap at a body between them. Returns how many steps its middle was inside, its highest speed, and where it
/// ended.
fn snap(solid: bool) -> (usize, f32, Vec3) {
    let upper = |mut jaw: MorphMesh, up: f32| {
        jaw.positions.iter_mut().for_each(|p| p.y += up);
        jaw
    };
    let half = Vec3::new(2.0, 0.4, 2.0);
    let (lower, above) = (upper(slab(half), -0.7), upper(slab(half), 0.7));
    // They are one mesh. The upper jaw moves down by 0.4 and leaves a gap of half the ball's size.
    let count = lower.positions.len() as u32;
    let mut positions = lower.positions.clone();
    positions.extend(&above.positions);
    let mut triangles = lower.triangles.clone();
    triangles.extend(above.triangles.iter().map(|t| t.map(|corner| corner + count)));
    let bite = (0..positions.len()).map(|i| if i < count as usize { Vec3::ZERO } else { -Vec3::Y * 0.4 });
    let bite = bite.collect();
    let mut mesh = MorphMesh::rigid("jaws", positions, triangles);
    mesh.targets = vec![bite];
    mesh.target_names = vec!["bite".into()];
    let mut app = app();
    let jaws = spawn(&mut app, &mesh, ());
    app.world_mut()
        .entity_mut(jaws)
        .insert(MorphPhysicsCollider { solid, ..SOLID });
    settle(&mut app);
    let ball = body(&mut app, Collider::ball(0.2), Vec3::new(0.1, 0.1, 0.05));
    let (mut inside, mut fastest): (usize, f32) = (0, 0.0);
    for i in 0..240 {
        // Closes and opens ten times a second.
        let bite = 0.5 - 0.5 * (std::f32::consts::TAU * 10.0 * DT * i as f32).cos();
        set_weights(&mut app, jaws, &[bite]);
        run(&mut app, 1);
        let at = place(&app, ball);
        let above = depth(at - Vec3::Y * (0.7 - 0.4 * bite), half);
        let below = depth(at + Vec3::Y * 0.7, half);
        inside += usize::from(above.max(below) > 0.02);
        fastest = fastest.max(velocity(&app, ball).length());
    }
    (inside, fastest, place(&app, ball))
}

#[test]
fn what_is_between_fast_jaws_is_not_swallowed() {
    let solid = snap(true);
    println!("{solid:?}");
    assert!(solid.0 < 3, "inside in {} steps", solid.0);
    assert!(solid.1 < 40.0, "{}", solid.1);
    assert!(
        solid.2.y.abs() < 0.35 || solid.2.xz().abs().max_element() > 2.0,
        "{}",
        solid.2
    );
}

#[test]
fn a_surface_that_is_not_solid_is_as_thin_as_ever() {
    let (mut app, slab) = with_slab(SLAB, false, ());
    let ball = floating(&mut app, Collider::ball(0.2), Vec3::new(0.1, 0.1, 0.05));
    run(&mut app, 60);
    assert_eq!(place(&app, ball), Vec3::new(0.1, 0.1, 0.05));
    // A body that hits it from inside is stopped.
    app.world_mut().entity_mut(ball).insert(Velocity::linear(Vec3::Y));
    run(&mut app, 60);
    assert!((place(&app, ball).y - 0.3).abs() < 0.03, "{}", place(&app, ball));
    // It can be changed at any time, even for sleeping bodies.
    app.world_mut()
        .entity_mut(ball)
        .insert((Velocity::zero(), Sleeping::default()));
    run(&mut app, 200);
    assert!(app.world().get::<Sleeping>(ball).unwrap().sleeping);
    app.world_mut().entity_mut(slab).insert(SOLID);
    run(&mut app, 60);
    assert!(place(&app, ball).y > 0.69, "{}", place(&app, ball));
    let inside = floating(&mut app, Collider::ball(0.2), Vec3::new(1.0, 0.1, 0.05));
    app.world_mut()
        .entity_mut(slab)
        .insert(MorphPhysicsCollider { solid: false, ..SOLID });
    run(&mut app, 30);
    assert_eq!(place(&app, inside), Vec3::new(1.0, 0.1, 0.05));
}

#[test]
fn what_has_no_volume_lies_still_on_a_solid_surface() {
    // The first triangle of each is on its underside, which sinks in a little.
    let (mut app, _) = with_slab(SLAB, true, ());
    let mut crate_ = box_mesh(Vec3::splat(0.2));
    crate_
        .triangles
        .sort_by_key(|corners| corners.map(|corner| crate_.positions[corner as usize].y > 0.0));
    let shell = Collider::trimesh(crate_.positions.clone(), crate_.triangles.clone()).unwrap();
    let shell = body(&mut app, shell, Vec3::new(0.1, 0.705, 0.05));
    let weight = (ColliderMassProperties::Mass(1.0), AdditionalMassProperties::Mass(0.0));
    app.world_mut().entity_mut(shell).insert(weight);
    let morphing = spawn(&mut app, &crate_, Transform::from_xyz(-1.0, 0.705, 0.05));
    let weight = ColliderMassProperties::Mass(1.0);
    app.world_mut()
        .entity_mut(morphing)
        .insert((RigidBody::Dynamic, Velocity::default(), weight));
    settle(&mut app);
    run(&mut app, 60);
    for lies in [shell, morphing] {
        let (mut fastest, mut highest): (f32, f32) = (0.0, 0.0);
        for _ in 0..120 {
            run(&mut app, 1);
            fastest = fastest.max(velocity(&app, lies).length());
            highest = highest.max(place(&app, lies).y);
        }
        assert!(fastest < 0.05 && (highest - 0.7).abs() < 1e-2, "{fastest}, {highest}");
    }
}

#[test]
fn what_surrounds_a_solid_body_is_not_inside() {
    // A ring of four bars around a rod. Its middle is in the rod, but no part of it is.
    let (mut app, _) = with_slab(Vec3::new(0.3, 2.0, 0.3), true, ());
    let bar = |at: Vec3, half: Vec3| (at, Quat::IDENTITY, Collider::cuboid(half.x, half.y, half.z));
    let (long, wide) = (Vec3::new(0.7, 0.1, 0.1), Vec3::new(0.1, 0.1, 0.7));
    let bars = [Vec3::Z, -Vec3::Z].map(|at| bar(0.6 * at, long));
    let ring = [bars, [Vec3::X, -Vec3::X].map(|at| bar(0.6 * at, wide))].concat();
    let ring = floating(&mut app, Collider::compound(ring), Vec3::new(0.05, 0.2, 0.0));
    run(&mut app, 60);
    assert!(
        place(&app, ring).distance(Vec3::new(0.05, 0.2, 0.0)) < 1e-4,
        "{}",
        place(&app, ring)
    );
}

#[test]
fn groups_spare_what_is_inside() {
    let at = Vec3::new(0.1, 0.1, 0.05);
    let others = Group::GROUP_2;
    for (spared, groups) in [(true, others), (false, Group::GROUP_1)] {
        let (mut app, _) = with_slab(SLAB, true, SolverGroups::new(Group::ALL, Group::GROUP_1));
        let ball = floating(&mut app, Collider::ball(0.2), at);
        app.world_mut()
            .entity_mut(ball)
            .insert(SolverGroups::new(groups, Group::ALL));
        run(&mut app, 60);
        assert_eq!(place(&app, ball) == at, spared, "{}", place(&app, ball));
    }
}

#[test]
fn a_scaled_dynamic_body_notices_what_it_swallows() {
    for by_scale in [false, true] {
        let more = (RigidBody::Dynamic, GravityScale(0.0), Velocity::default());
        let (mut app, surface) = with_slab(0.1 * SLAB, true, more);
        let scaled = |y: f32| Transform::from_scale(Vec3::new(10.0, y, 10.0));
        app.world_mut()
            .entity_mut(surface)
            .insert((scaled(10.0), ColliderMassProperties::Mass(1e3)));
        run(&mut app, 5);
        // So near that it is known; then, in one step, far inside.
        let ball = floating(&mut app, Collider::ball(0.2), Vec3::new(0.1, 0.699, 0.05));
        run(&mut app, 5);
        if by_scale {
            app.world_mut().entity_mut(surface).insert(scaled(30.0));
        } else {
            set_weights(&mut app, surface, &[0.0, 0.1, 0.0, 0.0]);
        }
        run(&mut app, 90);
        let at = place(&app, ball);
        assert!(at.y > 1.49, "{by_scale}: {at}");
    }
}

#[test]
fn what_a_dynamic_body_grew_over_while_it_was_switched_off_leaves_it() {
    let more = (RigidBody::Dynamic, GravityScale(0.0), Velocity::default());
    let (mut app, surface) = with_slab(SLAB, true, more);
    app.world_mut()
        .entity_mut(surface)
        .insert(ColliderMassProperties::Mass(1e3));
    let ball = floating(&mut app, Collider::ball(0.2), Vec3::new(0.1, 0.699, 0.05));
    run(&mut app, 5);
    app.world_mut().entity_mut(surface).insert(MorphColliderDisabled);
    run(&mut app, 2);
    set_weights(&mut app, surface, &[0.0, 1.0, 0.0, 0.0]);
    run(&mut app, 2);
    app.world_mut().entity_mut(surface).remove::<MorphColliderDisabled>();
    run(&mut app, 120);
    let at = place(&app, ball);
    assert!(at.y > 1.69, "{at}");
}

#[test]
fn what_was_put_inside_leaves_by_the_nearest_side() {
    let (mut app, _) = with_slab(SLAB, true, ());
    let ball = floating(&mut app, Collider::ball(0.2), Vec3::new(0.1, 0.71, 0.05));
    run(&mut app, 5);
    // Not through the side where it was before the game moved it.
    app.world_mut()
        .entity_mut(ball)
        .insert(Transform::from_xyz(0.1, -0.25, 0.05));
    run(&mut app, 60);
    let at = place(&app, ball);
    assert!(at.y < -0.69, "{at}");
}

#[test]
fn a_solid_dynamic_body_and_what_is_inside_it_part() {
    let more = (RigidBody::Dynamic, GravityScale(0.0), Velocity::default());
    let (mut app, surface) = with_slab(SLAB, true, more);
    app.world_mut()
        .entity_mut(surface)
        .insert(ColliderMassProperties::Mass(3.0));
    run(&mut app, 3);
    for at in [Vec3::new(0.4, 0.1, 0.05), Vec3::new(-0.4, -0.1, 0.05)] {
        let ball = floating(&mut app, Collider::ball(0.2), at);
        app.world_mut()
            .entity_mut(ball)
            .insert(ColliderMassProperties::Mass(1.0));
        let mut fastest: f32 = 0.0;
        for _ in 0..60 {
            run(&mut app, 1);
            let momentum = 3.0 * velocity(&app, surface) + velocity(&app, ball);
            assert!(momentum.length() < 1e-3, "{momentum}");
            fastest = fastest.max((velocity(&app, ball) - velocity(&app, surface)).length());
        }
        let apart = (place(&app, ball) - place(&app, surface)).y.abs();
        println!("{apart} apart, {fastest}/s");
        assert!(apart > 0.69 && fastest < 1.1 * DRIVEN, "{apart}, {fastest}");
        assert!(velocity(&app, ball).length() > 0.1, "{}", velocity(&app, ball));
        app.world_mut().despawn(ball);
        app.world_mut()
            .entity_mut(surface)
            .insert((Transform::default(), Velocity::zero()));
        run(&mut app, 2);
    }
}
