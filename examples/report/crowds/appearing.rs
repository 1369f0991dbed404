//! The longest frame when a character appears whose file is loaded, but whose tree is not built.

use std::thread::sleep;
use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::prelude::*;
use bevy_morph_physics::MorphPhysicsScene;
use morph_collision_testkit::bench::median;
use morph_collision_testkit::report::Table;
use morph_collision_workspace::app::{ready, without_collisions};
use morph_collision_workspace::crowd::{load, place};

use super::physics::Way;
use crate::model::{Model, run_on_one_thread};

/// What the app does with the character.
#[derive(Clone, Copy)]
enum Use {
    Draws,
    Collides,
    Physics(Way),
}

/// Frames after the tree is ready: a surface needs a few to be complete.
const AFTERWARDS: usize = 60;

/// The table of all apps.
pub(super) fn times(quick: bool) -> Result<String, String> {
    let rounds = if quick { 1 } else { 9 };
    let model = Model::find("mh_character.glb")?;
    let mut table = Table::new(["", "the longest frame, ms"]);
    for (name, used) in [
        ("Bevy alone", Use::Draws),
        ("with collisions", Use::Collides),
        ("Rapier, without a surface", Use::Physics(Way::Rapier)),
        ("Rapier, with a surface", Use::Physics(Way::RapierSurfaces)),
        ("Avian, without a surface", Use::Physics(Way::Avian)),
        ("Avian, with a surface", Use::Physics(Way::AvianSurfaces)),
    ] {
        let times: Result<Vec<f64>, String> = (0..rounds).map(|_| longest(used, &model)).collect();
        table.row([name.to_owned(), format!("{:.2}", median(times?.into_iter()))]);
    }
    Ok(table.to_string())
}

/// The longest frame from the one in which the character is spawned, in milliseconds.
fn longest(used: Use, model: &Model) -> Result<f64, String> {
    let mut app = without_collisions(model.folder());
    match used {
        Use::Draws => {}
        Use::Collides => _ = app.add_plugins(MorphCollisionPlugin),
        Use::Physics(way) => way.add_physics(&mut app),
    }
    ready(&mut app);
    run_on_one_thread(&mut app);
    let (scene, _) = load(&mut app, &model.file).map_err(|error| error.to_string())?;
    for _ in 0..10 {
        app.update();
    }
    let at = [Transform::default()];
    match used {
        Use::Collides => _ = place(&mut app, &scene, &at, MorphColliderScene::default()),
        Use::Physics(way) if way.has_surfaces() => _ = place(&mut app, &scene, &at, MorphPhysicsScene::default()),
        Use::Draws | Use::Physics(_) => _ = place(&mut app, &scene, &at, ()),
    }
    let mut longest = Duration::ZERO;
    let mut left = AFTERWARDS;
    let mut started = false;
    while left > 0 {
        let frame = Instant::now();
        app.update();
        longest = longest.max(frame.elapsed());
        // The tree is built in threads of its own, while other frames are drawn.
        sleep(Duration::from_millis(2));
        let trees = app.world().get_resource::<MorphTrees>();
        let is_building = trees.is_some_and(|trees| trees.building() > 0);
        started |= is_building;
        left = if is_building { AFTERWARDS } else { left - 1 };
    }
    let needs_tree = app.world().contains_resource::<MorphTrees>();
    if needs_tree && !started {
        return Err(format!("{}: no tree was built", model.file.display()));
    }
    Ok(1e3 * longest.as_secs_f64())
}
