//! Which motion counts, and for whom.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::rigid;

use super::{HALF, Range, make_continuous};
use crate::support::{
    Edits, add_mesh, cube, diagnostics, move_to, set_weight, settle, spawn, stretching_cube, touches,
};

#[test]
fn layers_and_bodies_apply_on_the_way() {
    let mut range = Range::new();
    let (bullet, wall) = (range.bullet, range.wall);
    range.app.insert(bullet, MorphCollisionLayers::new(1, 2));
    range.app.update();
    range.shoot(2.0);
    assert_eq!(range.counts(), (1, 1), "the wall is on all layers");
    range.app.insert(wall, MorphCollisionLayers::new(1, 1));
    range.app.update();
    range.shoot(-2.0);
    assert_eq!(range.counts(), (0, 0));
    range.app.insert(wall, MorphCollisionLayers::ALL);
    range.app.insert(bullet, MorphColliderOf { body: wall });
    range.app.update();
    range.shoot(2.0);
    assert_eq!(range.counts(), (0, 0), "one body");
}

#[test]
fn the_motion_of_both_counts() {
    let mut range = Range::new();
    // Side by side they do not meet, however far they go.
    move_to(&mut range.app, range.wall, 102.0);
    range.shoot(100.0);
    assert_eq!(range.counts(), (0, 0));
    assert_eq!(diagnostics(&range.app).swept_pairs, 1);
    // They swap places. The other one is not continuous, and at the end it is far away from the way of the first.
    move_to(&mut range.app, range.wall, 0.0);
    range.shoot(200.0);
    let (starts, ends) = range.news();
    assert_eq!((starts.len(), ends.len()), (1, 1));
    // A gap of 1.5 closes at 202.
    let time = starts[0].impact.unwrap().earliest;
    assert!((time - f64::from((1.5 - HALF) / 202.0)).abs() < 1e-5, "{time}");
    // The continuous one rests and the other one passes.
    move_to(&mut range.app, range.wall, 300.0);
    range.app.update();
    assert_eq!(range.counts(), (1, 1));
}

#[test]
fn weights_move_colliders_too() {
    let mut range = Range::new();
    let mesh = add_mesh(&mut range.app, &stretching_cube());
    let (arm, wall) = (range.bullet, range.wall);
    range.app.insert(arm, Mesh3d(mesh));
    set_weight(&mut range.app, arm, 0.0);
    settle(&mut range.app);
    // A punch, and back: at both ends of each frame it is in front of the wall.
    set_weight(&mut range.app, arm, 0.5);
    range.app.update();
    assert_eq!(range.counts(), (0, 0));
    // Then it moves on, but the arm goes back so far that it points to the left.
    set_weight(&mut range.app, arm, -6.0);
    range.shoot(2.6);
    let (starts, ends) = range.news();
    assert_eq!(
        (starts.len(), ends.len()),
        (1, 0),
        "the side at -X passes, that at +X comes back to x = -2.9"
    );
    assert!(touches(&range.app, arm, wall));
    let time = starts[0].impact.unwrap().earliest;
    // The side at +X is at -1 + t (-6.5 + 4.6), and that at -X at -2.5 + 4.6 t.
    assert!((time - f64::from((2.5 - HALF) / 4.6)).abs() < 1e-5, "{time}");
}

#[test]
fn shapes_have_a_way() {
    for bullet_is_shape in [true, false] {
        let mut range = Range::new();
        let (shape, mesh) = if bullet_is_shape {
            (range.bullet, range.wall)
        } else {
            (range.wall, range.bullet)
        };
        range.app.insert(shape, MorphShape::from(Cylinder::new(0.25, 0.5)));
        settle(&mut range.app);
        range.news();
        range.shoot(2.0);
        let (starts, ends) = range.news();
        assert_eq!((starts.len(), ends.len()), (1, 1));
        let impact = starts[0].impact.unwrap();
        // Of the wall or of the cube, and the cylinder is round towards it.
        let gap = if bullet_is_shape {
            2.0 - 0.25 - HALF
        } else {
            2.0 - 0.25 - 0.5
        };
        assert!((impact.earliest - f64::from(gap / 4.0)).abs() < 1e-5, "{impact:?}");
        assert_eq!(impact.features, MorphImpactFeatures::Shape);
        let shape_first = shape < mesh;
        let (of_shape, of_mesh) = if shape_first { (0, 1) } else { (1, 0) };
        let triangles = [impact.triangles.triangle_a, impact.triangles.triangle_b];
        assert_eq!(triangles[of_shape], MorphContact::NO_TRIANGLE);
        assert!(triangles[of_mesh] < 12);
        assert_eq!(impact.barycentrics[of_shape], Vec3::ZERO);
        assert!((impact.barycentrics[of_mesh].element_sum() - 1.0).abs() < 1e-5);
        // The first of the pair moves back out of the second.
        let out = if range.bullet < range.wall {
            Vec3::NEG_X
        } else {
            Vec3::X
        };
        assert!(impact.normal.distance(out) < 1e-5, "{impact:?}");
        assert!(impact.velocity.dot(out) < 0.0);
    }
}

#[test]
fn a_shape_turns_on_its_way() {
    let mut range = Range::new();
    let sword = MorphShape::Cuboid {
        half_extents: Vec3::new(0.01, 2.0, 0.01),
    };
    let place = |turn: f32| Transform::from_xyz(-1.0, 0.0, 0.0).with_rotation(Quat::from_rotation_z(turn));
    // Below it is in front of the wall, and above it is behind; upright, it does not reach the wall.
    range.app.insert(range.bullet, (sword, place(0.3)));
    settle(&mut range.app);
    range.news();
    range.app.insert(range.bullet, place(-0.3));
    range.app.update();
    assert_eq!(range.counts(), (0, 0));
    // It is swung by nearly half a turn.
    range.app.insert(range.bullet, place(-2.8));
    range.app.update();
    let (starts, ends) = range.news();
    assert_eq!((starts.len(), ends.len()), (1, 1));
    let impact = starts[0].impact.unwrap();
    // The corner at its end comes to x = 0 - HALF: 2 sin a - 0.01 cos a = 0.99, or nearly.
    let angle = 0.3 + 2.5 * impact.earliest;
    let reach = 2.0 * angle.sin() + 0.01 * angle.cos() - f64::from(1.0 - HALF);
    assert!(reach.abs() < 1e-3, "{reach} {impact:?}");
}

#[test]
fn a_shape_that_was_another_one_and_a_half_space_have_no_way() {
    let mut range = Range::new();
    let wall = range.wall;
    range.app.insert(wall, MorphShape::Ball { radius: 0.1 });
    range.shoot(2.0);
    assert_eq!(range.counts(), (0, 0), "it was a mesh");
    range.app.insert(wall, MorphShape::from(Cuboid::from_length(0.2)));
    range.shoot(-2.0);
    assert_eq!(range.counts(), (0, 0), "it was a ball");
    range.shoot(2.0);
    assert_eq!(range.counts(), (1, 1));
    range.app.insert(wall, MorphShape::HalfSpace { normal: Vec3::X });
    move_to(&mut range.app, wall, -5.0);
    range.app.update();
    range.shoot(0.0);
    assert_eq!(range.counts(), (0, 0));
    assert_eq!(diagnostics(&range.app).swept_pairs, 0);
}

#[test]
fn colliders_within_their_margins_have_a_way_to_touch() {
    let mut range = Range::new();
    let bullet = MorphCollider::default().with_continuous(true).with_margin(1.0);
    range.app.insert(range.bullet, bullet);
    range.shoot(-1.2);
    let (starts, ends) = range.news();
    assert_eq!((starts.len(), ends.len()), (1, 0));
    assert!(starts[0].impact.is_none(), "only margins touch");
    let lasting = |range: &Range| {
        let collisions = range.app.world().resource::<MorphCollisions>();
        collisions.get(range.bullet, range.wall).unwrap().clone()
    };
    // To the other side, near the wall again: it lasts, and has an impact now.
    range.shoot(1.2);
    assert_eq!(range.counts(), (0, 0));
    let contact = lasting(&range);
    assert!(contact.distance > 0.0);
    let time = contact.impact.unwrap().earliest;
    assert!((time - f64::from((1.2 - 0.5 - HALF) / 2.4)).abs() < 1e-5, "{time}");
    // Nothing new, so the old one stays.
    range.shoot(1.3);
    assert_eq!(lasting(&range).impact, contact.impact);
    // Through the wall, away from it.
    range.shoot(-5.0);
    assert_eq!(range.counts(), (0, 1));
    let ended: Vec<_> = range
        .app
        .world()
        .resource::<MorphCollisions>()
        .ended()
        .cloned()
        .collect();
    let time = ended[0].impact.unwrap().earliest;
    assert!((time - f64::from((1.3 - 0.5 - HALF) / 6.3)).abs() < 1e-5, "{time}");
}

#[test]
fn a_tolerance_that_ends_on_the_way_does_not_mix_two_states() {
    let mut range = Range::new();
    let mesh = add_mesh(&mut range.app, &stretching_cube());
    let arm = range.bullet;
    let collider = MorphCollider::default().with_continuous(true);
    range.app.insert(arm, (Mesh3d(mesh), collider.with_tolerance(5.0)));
    set_weight(&mut range.app, arm, 0.0);
    settle(&mut range.app);
    range.news();
    // It stretches far to the right, and moves to the left by as much. Collisions still see it as it was.
    set_weight(&mut range.app, arm, 2.5);
    range.shoot(-5.0);
    assert_eq!(range.counts(), (0, 0));
    // From there it goes up and away. Stretched at its old place it would have been in the wall.
    range.app.insert(arm, collider);
    set_weight(&mut range.app, arm, 0.0);
    range.shoot(-2.5);
    assert_eq!(range.counts(), (0, 0));
    // Its motion goes on from there.
    range.shoot(2.5);
    assert_eq!(range.counts(), (1, 1));
}

#[test]
fn a_teleport_is_no_motion() {
    let mut range = Range::new();
    range.app.insert(range.bullet, MorphTeleported);
    range.shoot(2.0);
    assert_eq!(range.counts(), (0, 0));
    assert_eq!(diagnostics(&range.app).swept_pairs, 0);
    assert!(
        range.app.world().get::<MorphTeleported>(range.bullet).is_none(),
        "it counts once"
    );
    range.shoot(-2.0);
    assert_eq!(range.counts(), (1, 1));
    // Where it appears, it collides as usual.
    range.app.insert(range.bullet, MorphTeleported);
    range.shoot(0.2);
    let (starts, ends) = range.news();
    assert_eq!((starts.len(), ends.len(), starts[0].impact), (1, 0, None));
    // The other one may teleport as well.
    range.shoot(-2.0);
    range.news();
    range.app.insert(range.wall, MorphTeleported);
    range.shoot(2.0);
    assert_eq!(range.counts(), (0, 0));
}

#[test]
fn a_teleport_counts_for_what_is_below_and_for_parts_of_a_body() {
    for as_child in [true, false] {
        let mut range = Range::new();
        let root = range.app.spawn(Transform::default());
        let mut bullet = range.app.world_mut().entity_mut(range.bullet);
        if as_child {
            let between = bullet.world_scope(|world| world.spawn((Transform::default(), ChildOf(root))).id());
            bullet.insert(ChildOf(between));
        } else {
            bullet.insert(MorphColliderOf { body: root });
        }
        range.app.update();
        range.app.insert(root, MorphTeleported);
        range.shoot(2.0);
        assert_eq!(range.counts(), (0, 0));
        range.shoot(-2.0);
        assert_eq!(range.counts(), (1, 1));
        range.app.world_mut().despawn(root);
    }
}

#[test]
fn a_teleport_waits_for_the_next_run() {
    let mut range = Range::new();
    let pause = |range: &mut Range, paused: bool| {
        range.app.settings().paused = paused;
    };
    pause(&mut range, true);
    range.app.insert(range.bullet, MorphTeleported);
    range.app.update();
    assert!(range.app.world().get::<MorphTeleported>(range.bullet).is_some());
    pause(&mut range, false);
    range.app.update();
    assert!(range.app.world().get::<MorphTeleported>(range.bullet).is_none());
}

#[test]
fn motion_during_a_pause_does_not_count() {
    let mut range = Range::new();
    range.app.settings().paused = true;
    range.shoot(1.0);
    range.shoot(2.0);
    range.app.settings().paused = false;
    range.shoot(2.5);
    assert_eq!(range.counts(), (0, 0));
    range.shoot(-2.0);
    assert_eq!(range.counts(), (1, 1), "from the second frame on, it does");
    // If nothing moves in the first frame after a pause, that is all.
    range.app.settings().paused = true;
    range.app.update();
    range.app.settings().paused = false;
    range.app.update();
    range.shoot(2.0);
    assert_eq!(range.counts(), (1, 1));
}

#[test]
fn a_collider_that_was_not_there_has_no_way() {
    let mut range = Range::new();
    let (bullet, wall) = (range.bullet, range.wall);
    let mut x = -2.0;
    // Moves to the other side of the wall.
    let mut cross = |range: &mut Range| {
        x = -x;
        range.shoot(x);
        range.counts()
    };
    for entity in [bullet, wall] {
        // Disabled and enabled again, ours and Bevy's.
        range.app.insert(entity, MorphColliderDisabled);
        assert_eq!(cross(&mut range), (0, 0));
        range.app.remove::<MorphColliderDisabled>(entity);
        assert_eq!(cross(&mut range), (0, 0), "it is there again, but was not before");
        assert_eq!(cross(&mut range), (1, 1));
    }
    range.app.insert(wall, Disabled);
    assert_eq!(cross(&mut range), (0, 0));
    range.app.remove::<Disabled>(wall);
    assert_eq!(cross(&mut range), (0, 0));
    assert_eq!(cross(&mut range), (1, 1));

    // Another mesh, as soon as its tree is built.
    let thin = add_mesh(&mut range.app, &rigid::box_mesh(Vec3::new(0.1, 0.2, 0.2)));
    range.app.insert(bullet, Mesh3d(thin));
    range.app.update();
    settle(&mut range.app);
    assert_eq!(range.counts(), (0, 0));
    assert_eq!(cross(&mut range), (1, 1));

    // New in the frame in which the other one passes; there already is a tree.
    let mesh = add_mesh(&mut range.app, &cube());
    spawn(&mut range.app, &mesh, 50.0);
    settle(&mut range.app);
    let new = spawn(&mut range.app, &mesh, 0.0);
    make_continuous(&mut range.app, new, true);
    assert_eq!(
        cross(&mut range),
        (2, 1),
        "only the wall is passed, and the new cube is in the wall"
    );

    // Despawned in that frame.
    range.app.world_mut().despawn(wall);
    range.app.world_mut().despawn(new);
    assert_eq!(cross(&mut range), (0, 1));
    range.app.world_mut().despawn(bullet);
    range.app.update();
    assert_eq!(range.counts(), (0, 0));
}

#[test]
fn what_rests_is_not_compared_on_a_way() {
    let mut range = Range::new();
    range.shoot(2.0);
    assert_eq!((diagnostics(&range.app).swept_pairs, range.counts()), (1, (1, 1)));
    range.app.update();
    assert_eq!((diagnostics(&range.app).swept_pairs, range.counts()), (0, (0, 0)));
    // Another pair moves.
    let mesh = add_mesh(&mut range.app, &cube());
    let others = [20.0, 22.0].map(|x| spawn(&mut range.app, &mesh, x));
    make_continuous(&mut range.app, others[0], true);
    settle(&mut range.app);
    range.counts();
    move_to(&mut range.app, others[0], 30.0);
    range.app.update();
    assert_eq!(diagnostics(&range.app).swept_pairs, 1);
    assert_eq!(range.counts(), (1, 1));
    // The first one goes on from where it rested.
    range.shoot(-2.0);
    let time = range.news().0[0].impact.unwrap().earliest;
    assert!((time - f64::from((1.5 - HALF) / 4.0)).abs() < 1e-5, "{time}");
}

#[test]
fn it_takes_effect_at_once_and_can_be_turned_off() {
    let mut range = Range::with([false, false]);
    make_continuous(&mut range.app, range.wall, true);
    range.shoot(2.0);
    assert_eq!(range.counts(), (1, 1));
    make_continuous(&mut range.app, range.wall, false);
    range.shoot(-2.0);
    assert_eq!(range.counts(), (0, 0));
}

#[test]
fn scenes_and_the_setting_pass_it_on() {
    let mut range = Range::with([false, false]);
    let mesh = add_mesh(&mut range.app, &stretching_cube());
    // Above the other cube.
    let above = |x: f32| Transform::from_xyz(x, 2.0, 0.0);
    let fist = range.app.spawn((Mesh3d(mesh), above(-2.0)));
    set_weight(&mut range.app, fist, 0.0);
    let continuous = MorphCollider::default().with_continuous(true);
    range.app.settings().every_deforming_mesh = Some(continuous);
    settle(&mut range.app);
    range.counts();
    range.app.insert(fist, above(2.0));
    range.app.update();
    assert_eq!(range.counts(), (1, 1));
    let plain = MorphCollider::default();
    range.app.settings().every_deforming_mesh = Some(plain);
    range.app.update();
    range.app.insert(fist, above(-2.0));
    range.app.update();
    assert_eq!(range.counts(), (0, 0), "the collider follows the setting");
}

#[test]
fn with_a_tolerance_the_way_is_that_of_what_collisions_see() {
    for is_continuous in [[true, false], [false, true]] {
        let mut range = Range::with(is_continuous);
        let mut collider = range.app.world_mut().get_mut::<MorphCollider>(range.bullet).unwrap();
        *collider = collider.with_tolerance(0.1);
        range.app.update();
        // Its front is 0.05 before the wall, and then, unnoticed, in it.
        range.shoot(-0.5 - HALF - 0.05);
        range.shoot(-0.5 - HALF + 0.02);
        assert_eq!(diagnostics(&range.app).held_colliders, 1);
        assert_eq!(range.counts(), (0, 0));
        range.shoot(2.0);
        let (starts, ends) = range.news();
        assert_eq!((starts.len(), ends.len()), (1, 1));
        let impact = starts[0].impact.unwrap();
        let expected = 0.05 / f64::from(2.5 + HALF + 0.05);
        assert!((impact.earliest - expected).abs() < 1e-5, "{impact:?}");
    }
}

#[test]
fn a_margin_counts_at_the_end_of_the_way_only() {
    let mut range = Range::new();
    let mut collider = range.app.world_mut().get_mut::<MorphCollider>(range.wall).unwrap();
    *collider = collider.with_margin(0.5);
    range.app.update();
    range.shoot(-0.9);
    assert!(touches(&range.app, range.bullet, range.wall), "within the margin");
    let (starts, _) = range.news();
    assert_eq!(starts[0].impact, None, "the surfaces did not touch");
    range.shoot(-2.0);
    range.shoot(0.9);
    let (starts, ends) = range.news();
    assert_eq!(
        (starts.len(), ends.len()),
        (1, 1),
        "the surfaces passed, and it ends within the margin"
    );
    assert!(starts[0].impact.is_some() && touches(&range.app, range.bullet, range.wall));
}

#[test]
fn what_was_not_compared_before_may_touch_at_the_start() {
    let mut range = Range::new();
    range.app.insert(range.bullet, MorphCollisionLayers::NONE);
    range.shoot(0.2);
    range.app.insert(range.bullet, MorphCollisionLayers::ALL);
    range.shoot(2.0);
    let (starts, ends) = range.news();
    assert_eq!((starts.len(), ends.len()), (1, 1));
    let impact = starts[0].impact.unwrap();
    assert_eq!(
        (impact.earliest, impact.latest, impact.features),
        (0.0, 0.0, MorphImpactFeatures::AtStart)
    );
}
