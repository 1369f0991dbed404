//! Rewrites the tables of docs/avian.md in place: how Avian's bodies behave on a morphing surface, how many fall through, and
//! what a step costs, with this plugin and with what a game can do without it.
//!
//! `--help` lists the options; `just avian-report` runs it.

mod stage;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use bevy::prelude::*;
use clap::Parser;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_workspace::outcome::exit_code;
use morph_collision_workspace::physics::behaviour::Behaviour;
use morph_collision_workspace::physics::bullets;
use morph_collision_workspace::physics::drops::{Drop, Kind, batch_of_drops, bowl, fates, waves};
use morph_collision_workspace::physics::times::{Scene, Timed, table};
use morph_collision_workspace::physics::{DT, settle, sheet};
use morph_collision_workspace::tables::{Section, TableOptions, progress, rewrite};
use stage::{Kinematic, Method, Surface, app, body, drop_body, floor, small, state, stay_awake};

/// Tables about Avian's rigid bodies on morphing surfaces.
#[derive(Parser)]
struct Options {
    /// The page to rewrite.
    #[arg(default_value = "docs/avian.md")]
    page: PathBuf,
    /// Number of bodies to drop, in hundreds.
    #[arg(long, default_value_t = 100)]
    batches: u64,
    #[command(flatten)]
    tables: TableOptions,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let batches = if options.tables.quick { 4 } else { options.batches };
    let sections: [Section<'_>; 5] = [
        ("behaviour", Box::new(|| Ok(behaviour()))),
        ("units", Box::new(|| Ok(units()))),
        ("bullets", Box::new(|| Ok(shots()))),
        ("drops", Box::new(|| Ok(drops(batches)))),
        ("time", Box::new(|| Ok(times(options.tables.quick)))),
    ];
    exit_code(rewrite(&options.page, &options.tables, &sections))
}

/// How a surface acts on a body that rests on it; the same scenes as in docs/rapier.md.
fn behaviour() -> String {
    let rows = Method::ALL.map(|method| Behaviour::of(&method, 1.0).row(method.name()));
    Behaviour::head("method") + &rows.concat()
}

/// The same with this plugin in worlds of other length units.
fn units() -> String {
    let rows = [0.01, 1.0, 10.0, 100.0].map(|unit| Behaviour::of(&Method::Ours, unit).row(&unit.to_string()));
    Behaviour::head("length unit") + &rows.concat()
}

/// Bullets that go through a surface that comes towards them.
fn shots() -> String {
    let methods = Method::ALL.map(|method| bullets::rows(&method, method.name()));
    bullets::head() + &methods.concat() + &bullets::rows(&Kinematic, "`Collider::trimesh` on a kinematic body")
}

/// Drops bodies that do not collide with each other into the bowl, and counts how many fall through.
fn drops(batches: u64) -> String {
    let mesh = bowl();
    let per_batch = 100;
    let progress = progress(batches * 2);
    let mut table = String::from("| method | drops | fell through | left over the rim |\n|---|--:|--:|--:|\n");
    for method in Method::ALL {
        let (mut through, mut left) = (0, 0);
        for batch in 0..batches {
            let fell = fall(method, &mesh, &batch_of_drops(batch, per_batch, 1.0));
            through += fell.0;
            left += fell.1;
            progress.inc(1);
        }
        let (name, drops) = (method.name(), batches * per_batch);
        let _infallible = writeln!(table, "| {name} | {drops} | {through} | {left} |");
    }
    progress.finish_and_clear();
    table
}

fn fall(method: Method, mesh: &MorphMesh, drops: &[Drop]) -> (u64, u64) {
    let mut app = app(Path::new("."));
    let mut surface = Surface::spawn(&mut app, method, mesh, Vec3::ZERO, &mut None);
    settle(&mut app);
    let bodies: Vec<Entity> = drops.iter().map(|drop| drop_body(&mut app, drop)).collect();
    for step in 0..240 {
        surface.pose(&mut app, &waves(step as f32 * DT));
        app.update();
    }
    fates(bodies.iter().map(|&body| state(&app, body).0))
}

/// The cost of a frame.
fn times(quick: bool) -> String {
    let mesh = sheet(101);
    table(quick, &[Method::NewMesh.name()], |scene| {
        Method::ALL.map(|method| world(scene, &mesh, method)).into()
    })
}

fn world<'a>(scene: &Scene, mesh: &'a MorphMesh, method: Method) -> Timed<'a> {
    let mut app = app(Path::new("."));
    let mut shared = None;
    let spawn = |at| Surface::spawn(&mut app, method, mesh, at, &mut shared);
    let mut surfaces: Vec<_> = scene.sheets().map(spawn).collect();
    for at in scene.floors() {
        floor(&mut app, at);
    }
    settle(&mut app);
    for (i, at) in scene.places().enumerate() {
        let body = body(&mut app, small(if i % 2 == 0 { Kind::Ball } else { Kind::Cuboid }), at);
        stay_awake(&mut app, body);
    }
    let pose = move |app: &mut App, weights: &[f32]| {
        surfaces.iter_mut().for_each(|surface| surface.pose(app, weights));
    };
    (app, Box::new(pose))
}
