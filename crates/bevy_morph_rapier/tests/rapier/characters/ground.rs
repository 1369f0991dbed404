//! The ground that a character stands on.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{body, settle, sheet};

use super::{
    GRAVITY, HALF_HEIGHT, OFFSET, STANDING, character, ground, is_grounded, move_by, on_sheet, ride, walk, walk_once,
};
use crate::support::{app, place, population, run, spawn};

#[test]
fn a_character_stands_on_a_surface() {
    let step = Vec3::new(0.01, 0.0, 0.005);
    for has_body in [false, true] {
        let (mut app, surface, walker) = match has_body {
            true => on_sheet(RigidBody::KinematicPositionBased),
            false => on_sheet(()),
        };
        // The same mesh, as Rapier's own shape.
        let mesh = sheet(16);
        let rival = Collider::trimesh(mesh.positions, mesh.triangles).unwrap();
        app.world_mut().spawn((rival, Transform::from_xyz(20.0, 0.0, 0.0)));
        let other = character(&mut app, Vec3::new(20.1, STANDING, 0.05), ());
        walk(&mut app, other, Vec3::ZERO, 10);
        for frame in 0..240 {
            move_by(&mut app, other, step + GRAVITY);
            assert!(walk_once(&mut app, walker, step), "in frame {frame}");
            assert!(is_grounded(&app, other));
        }
        let (at, other) = (place(&app, walker), place(&app, other) - 20.0 * Vec3::X);
        assert!(
            (at - other).length() < 0.03 && at.x > 2.4,
            "{at}, and {other} on a mesh of Rapier's"
        );
        assert!((at.y - STANDING).abs() < 2e-3, "{at}");
        assert_eq!(ground(&app, walker).surface, Some(surface));
        assert_eq!(ground(&app, walker).velocity, Vec3::ZERO);
    }
}

#[test]
fn a_character_does_not_sink_into_a_rising_surface() {
    for speed in [0.05, 0.5, 3.0] {
        let (mut app, surface, walker) = on_sheet(());
        let (grounded, moved, [least, greatest]) = ride(&mut app, surface, walker, Vec2::new(speed, 0.0), 240);
        assert!(grounded >= 238, "at {speed}: {grounded}");
        assert!(moved.xz().length() < 1e-3, "at {speed}: {moved}");
        // The surface starts at once; the character follows a step later.
        let late = speed / 60.0;
        assert!(
            least > OFFSET - late - 2e-3 && greatest < OFFSET + 2e-3,
            "at {speed}: {least} to {greatest}"
        );
    }
}

#[test]
fn a_character_in_the_air_is_not_grounded_and_leaves_nothing_behind() {
    let (mut app, surface, walker) = on_sheet(());
    let before = population(&mut app);
    assert!(walk_once(&mut app, walker, Vec3::ZERO));
    assert_eq!(
        population(&mut app),
        before,
        "what it stands on is there while controllers run alone"
    );
    move_by(&mut app, walker, Vec3::Y);
    run(&mut app, 1);
    assert!(!is_grounded(&app, walker));
    assert_eq!(ground(&app, walker), MorphCharacterGround::default());
    app.world_mut().entity_mut(surface).insert(MorphColliderDisabled);
    run(&mut app, 2);
    // Where there is nothing, it falls.
    assert_eq!(walk(&mut app, walker, Vec3::Y * -0.05, 30), 0);
    assert!(place(&app, walker).y < -0.5);
}

#[test]
fn a_character_stands_on_others_but_not_on_itself() {
    // Two characters. Each is inside its own box, which is a surface on its body.
    let mut app = app();
    let mut cube = morph_collision_models::generated::rigid::box_mesh(Vec3::splat(0.45));
    cube.targets = vec![vec![Vec3::X; cube.positions.len()]];
    let [one, other] =
        [0.0, 0.5].map(|x| character(&mut app, Vec3::new(x, 5.0, 0.0), RigidBody::KinematicPositionBased));
    for walker in [one, other] {
        let skin = spawn(&mut app, &cube, ());
        app.world_mut().entity_mut(skin).insert(ChildOf(walker));
    }
    settle(&mut app);
    let falls = |app: &mut App, step: Vec3| {
        move_by(app, one, step);
        move_by(app, other, Vec3::ZERO);
        run(app, 1);
        is_grounded(app, one)
    };
    app.world_mut().get_mut::<Transform>(other).unwrap().translation.x = 20.0;
    run(&mut app, 1);
    assert!(!falls(&mut app, Vec3::Y * -0.01), "it stands on its own skin");
    // The same beside the other character, which it could stand on.
    let beside = place(&app, one) + Vec3::X * 1.2;
    app.world_mut().get_mut::<Transform>(other).unwrap().translation = beside;
    run(&mut app, 1);
    assert!(!falls(&mut app, Vec3::Y * -0.01), "it stands on its own skin");
    // On top of the other character's box, which is 0.9 high.
    app.world_mut().get_mut::<Transform>(other).unwrap().translation =
        place(&app, one) - Vec3::Y * (0.45 + STANDING + 0.02);
    run(&mut app, 1);
    assert!(falls(&mut app, Vec3::Y * -0.05), "{}", place(&app, one));
    for walker in [one, other] {
        let controller = app.world().get::<KinematicCharacterController>(walker).unwrap();
        assert!(controller.exclude_colliders.is_empty(), "filters are as they were");
    }
}

#[test]
fn filters_of_a_controller_hold() {
    let groups = CollisionGroups::new(Group::GROUP_2, Group::GROUP_2);
    for blind in 0..4 {
        let (mut app, surface, walker) = on_sheet(());
        let mut controller = app.world_mut().get_mut::<KinematicCharacterController>(walker).unwrap();
        match blind {
            0 => controller.filter_flags |= QueryFilterFlags::EXCLUDE_FIXED,
            1 => controller.filter_groups = Some(groups),
            2 => _ = controller.exclude_colliders.insert(surface),
            _ => controller.filter_predicate = Some(ControllerFilterPredicate::new(move |entity, _| entity != surface)),
        }
        app.world_mut()
            .entity_mut(surface)
            .insert(CollisionGroups::new(Group::GROUP_1, Group::GROUP_1));
        run(&mut app, 1);
        assert_eq!(walk(&mut app, walker, Vec3::ZERO, 20), 0, "{blind}");
        assert!(place(&app, walker).y < 0.0, "{blind}");
    }
}

#[test]
fn a_shape_of_its_own_walks_as_a_collider_does() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let controller = KinematicCharacterController {
        custom_shape: Some((Collider::capsule_y(0.5, 0.3), Vec3::Y * 0.2, Quat::IDENTITY)),
        ..Default::default()
    };
    let at = Transform::from_xyz(0.0, STANDING - 0.2, 0.0);
    let walker = app.world_mut().spawn((controller, Collider::ball(0.1), at)).id();
    walk(&mut app, walker, Vec3::ZERO, 5);
    let (grounded, moved, _) = ride(&mut app, surface, walker, Vec2::new(0.5, 1.0), 60);
    assert!(
        grounded >= 59 && (moved - Vec3::new(1.0, 0.5, 0.0)).length() < 0.03,
        "{grounded}, {moved}"
    );
}

#[test]
fn what_sleeps_on_a_surface_is_not_woken_by_who_walks_there() {
    let (mut app, _, walker) = on_sheet(());
    let crates = body(&mut app, Collider::cuboid(0.2, 0.2, 0.2), Vec3::new(1.0, 0.2, 1.0));
    app.world_mut().entity_mut(crates).insert(Sleeping::default());
    let asleep = |app: &App| app.world().get::<Sleeping>(crates).unwrap().sleeping;
    walk(&mut app, walker, Vec3::ZERO, 240);
    assert!(asleep(&app));
    for _ in 0..60 {
        walk(&mut app, walker, Vec3::new(0.01, 0.0, 0.0), 1);
        assert!(asleep(&app));
    }
    assert!((place(&app, walker).y - HALF_HEIGHT - OFFSET).abs() < 2e-3);
}
