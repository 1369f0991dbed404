//! Rewrites the tables of docs/rapier.md in place: how bodies behave on a morphing surface, how many fall through, and what a
//! step costs, with this plugin and with what a game can do without it.
//!
//! `--help` lists the options; `just physics-report` runs it.

mod drops;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use clap::Parser;
use morph_collision_testkit::bench::cpu;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_workspace::outcome::exit_code;
use morph_collision_workspace::physics::behaviour::Behaviour;
use morph_collision_workspace::physics::bullets;
use morph_collision_workspace::physics::times::{Scene, Timed, scenes, table, time};
use morph_collision_workspace::physics::{Kinematic, Method, Surface, app, body, settle, sheet};
use morph_collision_workspace::tables::{Section, TableOptions, rewrite};

/// Tables about rigid bodies on morphing surfaces.
#[derive(Parser)]
struct Options {
    /// The page to rewrite.
    #[arg(default_value = "docs/rapier.md")]
    page: PathBuf,
    #[command(flatten)]
    tables: TableOptions,
    /// For profiling: print only the times of this row of the last table, for one method, and change nothing.
    #[arg(long)]
    row: Option<usize>,
    /// The method: 0 is this plugin, followed by the rivals.
    #[arg(long, default_value_t = 0)]
    way: usize,
    /// Drop only this batch of one hundred bodies, print the last steps of those that fall through, and change nothing.
    #[arg(long)]
    batch: Option<u64>,
    /// The last batch to drop like this.
    #[arg(long, requires = "batch")]
    until: Option<u64>,
    /// Of such a batch, drop only this body.
    #[arg(long, requires = "batch")]
    alone: Option<usize>,
    /// Drop them with CCD.
    #[arg(long, requires = "batch")]
    ccd: bool,
    /// Drop them at this multiple of the usual speed.
    #[arg(long, requires = "batch", default_value_t = 1.0)]
    speed: f32,
}

impl Options {
    fn way(&self) -> Method {
        Method::ALL.get(self.way).copied().unwrap_or(Method::Ours)
    }
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<(), String> {
    let quick = options.tables.quick;
    if let Some(row) = options.row {
        let scenes = scenes();
        let scene = scenes
            .get(row)
            .ok_or_else(|| format!("there are {} rows", scenes.len()))?;
        let frames = if quick { 100 } else { 600 };
        let mesh = sheet(101);
        let times = time(scene, frames, worlds(scene, &mesh, &[options.way()]));
        println!("{} surfaces, {}: {:.0} us", scene.shapes, scene.what, times[0]);
        return Ok(());
    }
    if let Some(first) = options.batch {
        for batch in first..=options.until.unwrap_or(first) {
            drops::trace(options.way(), batch, (options.ccd, options.speed), options.alone);
        }
        return Ok(());
    }
    let sections: [Section<'_>; 6] = [
        ("machine", Box::new(|| Ok(format!("{}\n", cpu())))),
        ("behaviour", Box::new(|| Ok(behaviour()))),
        ("units", Box::new(|| Ok(units()))),
        ("bullets", Box::new(|| Ok(shots()))),
        ("drops", Box::new(|| Ok(drops::table(quick)))),
        ("time", Box::new(|| Ok(times(quick)))),
    ];
    rewrite(&options.page, &options.tables, &sections)
}

fn here() -> App {
    app(Path::new("."))
}

/// The effect of a surface on a body that rests on it, with every method.
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
    let methods = [Method::Ours, Method::NewMesh, Method::SoftBody].map(|method| bullets::rows(&method, method.name()));
    bullets::head() + &methods.concat() + &bullets::rows(&Kinematic, "`TriMesh` on a kinematic body")
}

/// The cost of a frame.
fn times(quick: bool) -> String {
    let mesh = sheet(101);
    let names: Vec<&str> = Method::ALL[1..].iter().map(|method| method.name()).collect();
    table(quick, &names, |scene| worlds(scene, &mesh, &Method::ALL))
}

/// A scene, once per method.
fn worlds<'a>(scene: &Scene, mesh: &'a MorphMesh, methods: &[Method]) -> Vec<Timed<'a>> {
    let world = |&method: &Method| -> Timed<'a> {
        let mut app = here();
        let mut shared = None;
        let spawn = |at| Surface::spawn(&mut app, method, mesh, at, &mut shared);
        let mut surfaces: Vec<_> = scene.sheets().map(spawn).collect();
        for floor in scene.floors() {
            app.world_mut()
                .spawn((Collider::cuboid(3.0, 0.5, 4.0), Transform::from_translation(floor)));
        }
        settle(&mut app);
        for (i, at) in scene.places().enumerate() {
            let collider = if i % 2 == 0 {
                Collider::ball(0.3)
            } else {
                Collider::cuboid(0.3, 0.3, 0.3)
            };
            let body = body(&mut app, collider, at);
            app.world_mut().entity_mut(body).insert(Sleeping::disabled());
        }
        let pose = move |app: &mut App, weights: &[f32]| {
            surfaces.iter_mut().for_each(|surface| surface.pose(app, weights));
        };
        (app, Box::new(pose))
    };
    methods.iter().map(world).collect()
}
