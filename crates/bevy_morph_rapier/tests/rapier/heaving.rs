//! The example's game, run without a window: a player on a hill that a glTF clip moves, with physics in fixed
//! steps.

use std::path::Path;

use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::parry::math::Pose;
use bevy_rapier3d::parry::query::PointQuery;
use bevy_rapier3d::parry::shape::TriMesh;
use bevy_rapier3d::prelude::*;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_workspace::app::{update_until, without_collisions};
use morph_collision_workspace::heaving::{
    Falling, Game, HALF_SEGMENT, IDLE, JUMP, MODEL, Player, RADIUS, SPEED, Tally, Wish,
};

#[path = "../../../../examples/physics.rs"]
#[allow(dead_code, unexpected_cfgs, unreachable_pub, reason = "it is also a program")]
mod physics;

use crate::log::start;
use crate::support::{global, run, truth};

fn assets() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets")
}

/// The game at the moment when the player is above the hill.
fn game(bodies: u32) -> (App, Entity) {
    let mut app = without_collisions(&assets());
    app.insert_resource(Game { bodies, ..default() })
        .add_plugins(physics::play);
    start(&mut app);
    let mut players = app.world_mut().query_filtered::<Entity, With<Player>>();
    update_until(&mut app, Path::new(MODEL), |world| {
        Ok(players.iter(world).next().is_some())
    })
    .expect("the hill comes with the repository");
    let player = players.single(app.world()).expect("there is one");
    (app, player)
}

fn at(app: &App, player: Entity) -> Vec3 {
    app.world()
        .get::<Transform>(player)
        .expect("it is somewhere")
        .translation
}

fn ground(app: &App, player: Entity) -> MorphCharacterGround {
    *app.world().get(player).expect("it has a controller")
}

/// The hill as it is drawn now, by brute force.
fn hill(app: &mut App) -> TriMesh {
    let mesh = read_meshes(&assets().join(MODEL)).expect("it can be read").remove(0);
    let world = app.world_mut();
    let mut surfaces = world.query_filtered::<Entity, (With<MeshMorphWeights>, With<MorphPhysicsCollider>)>();
    let surface = surfaces.single(world).expect("one component has put it into physics");
    let mut nodes = world.query::<&MorphWeights>();
    let weights = nodes.single(world).expect("there is one").weights().to_vec();
    assert!(weights.iter().any(|&weight| weight != 0.0), "its clip plays");
    truth(&mesh, &weights, &global(app, surface))
}

/// The distance of the capsule from the hill: 0 if they touch, negative if they overlap.
fn gap(app: &mut App, player: Entity) -> f32 {
    let (hill, at) = (hill(app), at(app, player));
    let feet = at - HALF_SEGMENT * Vec3::Y;
    hill.distance_to_point(&Pose::IDENTITY, feet, false) - RADIUS
}

#[test]
fn a_player_walks_in_circles_on_a_heaving_hill_in_the_rain() {
    let (mut app, player) = game(30);
    // It falls a little, then it stands and is carried.
    run(&mut app, 60);
    assert!(ground(&app, player).surface.is_some());
    run(&mut app, (60.0 * IDLE) as usize);
    *app.world_mut().resource_mut::<Tally>() = Tally::default();
    let (mut turned, mut before, mut rises) = (0.0, at(&app, player), Vec::new());
    for frame in 0..480 {
        app.update();
        let now = at(&app, player);
        turned += before.xz().angle_to(now.xz());
        before = now;
        rises.push(ground(&app, player).velocity.y);
        if frame % 20 == 0 {
            let gap = gap(&mut app, player);
            // The drawn hill is up to a step and a frame ahead of physics.
            assert!(gap.abs() < 0.06, "frame {frame}: {gap} above the hill");
        }
    }
    let tally = *app.world().resource::<Tally>();
    assert!(tally.steps > 500, "{tally:?}");
    assert!(
        tally.share(tally.grounded) > 0.98 && tally.share(tally.on_hill) > 0.98,
        "{tally:?}"
    );
    assert!(
        turned.abs() > std::f32::consts::TAU,
        "it walks around the middle: {turned}"
    );
    assert!(tally.walked > 0.8 * SPEED * 8.0, "{tally:?}");
    let heaves = |up: f32| rises.iter().filter(|&&speed| up * speed > 0.1).count() > 40;
    assert!(heaves(1.0) && heaves(-1.0), "the hill lifts and lowers it");
    let mut bodies = app.world_mut().query::<&Falling>();
    assert!(bodies.iter(app.world()).all(|falling| !falling.through));
}

#[test]
fn a_player_goes_where_it_is_told_to_and_jumps() {
    let (mut app, player) = game(0);
    run(&mut app, 70);
    let from = at(&app, player);
    let walk = Vec2::new(1.0, 0.0);
    for _ in 0..60 {
        *app.world_mut().resource_mut::<Wish>() = Wish { walk, jump: false };
        app.update();
    }
    let way = (at(&app, player) - from).xz();
    assert!(way.distance(SPEED * walk) < 0.7, "{way}");

    let from = at(&app, player).y;
    *app.world_mut().resource_mut::<Wish>() = Wish {
        walk: Vec2::ZERO,
        jump: true,
    };
    let (mut highest, mut left) = (from, false);
    for _ in 0..80 {
        app.update();
        highest = highest.max(at(&app, player).y);
        left |= ground(&app, player).surface.is_none();
    }
    let height = JUMP * JUMP / (2.0 * 9.81);
    // The jump includes the hill's velocity.
    assert!(
        (highest - from - height).abs() < 0.4,
        "{} high, {height} without the hill",
        highest - from
    );
    assert!(left && ground(&app, player).surface.is_some(), "it lands on the hill");
}

#[test]
fn who_leaves_the_ground_is_brought_back() {
    let (mut app, player) = game(1);
    run(&mut app, 10);
    let mut bodies = app.world_mut().query_filtered::<Entity, With<Falling>>();
    let body = bodies.single(app.world()).expect("there is one");
    for lost in [player, body] {
        app.world_mut().get_mut::<Transform>(lost).unwrap().translation = Vec3::new(40.0, -5.0, 0.0);
        run(&mut app, 60);
        assert!(at(&app, lost).y > 0.0, "it is at {}", at(&app, lost));
    }
    assert!(!app.world().get::<Falling>(body).unwrap().through);
}

#[test]
fn what_goes_through_the_hill_is_counted() {
    let (mut app, _) = game(1);
    run(&mut app, 10);
    let mut bodies = app.world_mut().query_filtered::<Entity, With<Falling>>();
    let body = bodies.single(app.world()).expect("there is one");
    // Nothing stops a sensor.
    app.world_mut().entity_mut(body).insert(Sensor);
    run(&mut app, 90);
    assert!(app.world().get::<Falling>(body).unwrap().through);
}
