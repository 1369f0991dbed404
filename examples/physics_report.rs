//! Makes the tables of docs/rapier.md again, in place: how bodies behave on a morphing surface, how many fall through, and what a
//! step costs, here and with what a game can do by itself.
//!
//! `--help` lists the options; `just physics-report` runs it.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use clap::Parser;
use morph_collision_testkit::bench::{cpu, median};
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_workspace::physics::{DT, Method, Surface, app, body, settle, sheet, state};
use morph_collision_workspace::tables::{Section, TableOptions, progress, rewrite};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Tables about rigid bodies on morphing surfaces.
#[derive(Parser)]
struct Options {
    /// The page to change.
    #[arg(default_value = "docs/rapier.md")]
    page: PathBuf,
    #[command(flatten)]
    tables: TableOptions,
    /// Print the times of this row of the last table, of this plugin alone, and change nothing: to profile it.
    #[arg(long)]
    row: Option<usize>,
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(options: &Options) -> Result<(), String> {
    let quick = options.tables.quick;
    if let Some(row) = options.row {
        let scenes = scenes();
        let scene = scenes
            .get(row)
            .ok_or_else(|| format!("there are {} rows", scenes.len()))?;
        let frames = if quick { 100 } else { 600 };
        let times = time(scene, &sheet(101), frames, &[Method::Ours]);
        println!("{} surfaces, {}: {:.0} us", scene.shapes, scene.what, times[0]);
        return Ok(());
    }
    let sections: [Section<'_>; 4] = [
        ("machine", Box::new(|| Ok(format!("{}\n", cpu())))),
        ("behaviour", Box::new(|| Ok(behaviour()))),
        ("drops", Box::new(|| Ok(drops(quick)))),
        ("time", Box::new(|| Ok(times(quick)))),
    ];
    rewrite(&options.page, &options.tables, &sections)
}

fn here() -> App {
    app(Path::new("."))
}

/// A body that rests on a sheet.
fn at_rest<'a>(method: Method, mesh: &'a MorphMesh, collider: Collider) -> (App, Surface<'a>, Entity) {
    let mut app = here();
    let surface = Surface::spawn(&mut app, method, mesh, Vec3::ZERO, &mut None);
    settle(&mut app);
    let body = body(&mut app, collider, Vec3::new(0.1, 0.52, 0.05));
    for _ in 0..60 {
        app.update();
    }
    (app, surface, body)
}

/// Four things that a surface does to what lies on it.
fn behaviour() -> String {
    let mesh = sheet(32);
    let ball = || Collider::ball(0.5);
    let mut table = String::from(
        "| way | ball on a surface rising at 0.5/s: velocity | gap | cuboid on a surface sliding at 1/s: velocity | ball slapped up by 0.5 in 0.1 s: speed | ball on a surface that jumps by 0.2: highest | cuboid sliding at 3/s without friction: velocity after 1 s |\n|---|--:|--:|--:|--:|--:|--:|\n",
    );
    for method in Method::ALL {
        let (mut app, mut surface, body) = at_rest(method, &mesh, ball());
        for i in 1..=90 {
            surface.pose(&mut app, &[0.5 * DT * i as f32, 0.0]);
            app.update();
        }
        let (place, speed) = state(&app, body);
        let (rise, gap) = (speed.y, place.y - 0.5 - 0.75);

        let (mut app, mut surface, body) = at_rest(method, &mesh, Collider::cuboid(0.5, 0.5, 0.5));
        for i in 1..=120 {
            surface.pose(&mut app, &[0.0, DT * i as f32]);
            app.update();
        }
        let slide = state(&app, body).1.x;

        let (mut app, mut surface, body) = at_rest(method, &mesh, ball());
        for i in 1..=6 {
            surface.pose(&mut app, &[i as f32 / 12.0, 0.0]);
            app.update();
        }
        let slap = state(&app, body).1.y;

        let (mut app, mut surface, body) = at_rest(method, &mesh, ball());
        surface.pose(&mut app, &[0.2, 0.0]);
        let mut highest: f32 = 0.0;
        for _ in 0..120 {
            app.update();
            highest = highest.max(state(&app, body).0.y);
        }
        let (mut app, _, body) = at_rest(method, &mesh, Collider::cuboid(0.5, 0.5, 0.5));
        let friction = Friction {
            coefficient: 0.0,
            combine_rule: CoefficientCombineRule::Min,
        };
        let pushed = (friction, Velocity::linear(Vec3::X * 3.0));
        app.world_mut().entity_mut(body).insert(pushed);
        for _ in 0..60 {
            app.update();
        }
        let glide = state(&app, body).1.x;

        let name = method.name();
        let _infallible = writeln!(
            table,
            "| {name} | {rise:.3} | {gap:+.4} | {slide:.3} | {slap:.2} | {highest:.3} | {glide:.3} |"
        );
    }
    table
}

/// A bowl of 24 by 24 that waves.
fn bowl() -> MorphMesh {
    let mut mesh = sheet(48);
    for vertex in &mut mesh.positions {
        *vertex *= 3.0;
        vertex.y = 0.03 * (vertex.x * vertex.x + vertex.z * vertex.z);
    }
    let wave = |direction: Vec2, phase: f32| {
        let height = |p: &Vec3| 0.3 * (direction.dot(p.xz()) + phase).sin();
        mesh.positions.iter().map(|p| Vec3::Y * height(p)).collect()
    };
    mesh.targets = vec![wave(Vec2::new(1.0, 0.2), 0.0), wave(Vec2::new(-0.3, 0.9), 1.0)];
    mesh
}

/// Bodies that fall into the bowl, each alone: how many fall through.
fn drops(quick: bool) -> String {
    let mesh = bowl();
    let batches = if quick { 4 } else { 100 };
    let per_batch = 100;
    let progress = progress(batches * 4);
    let mut table = String::from("| way | CCD | drops | fell through | left over the rim |\n|---|---|--:|--:|--:|\n");
    for ccd in [false, true] {
        for method in [Method::Ours, Method::NewMesh] {
            let (mut through, mut left) = (0, 0);
            for batch in 0..batches {
                let fates = batch_of_drops(method, &mesh, ccd, batch, per_batch);
                through += fates.0;
                left += fates.1;
                progress.inc(1);
            }
            let on = if ccd { "on" } else { "off" };
            let (name, drops) = (method.name(), batches * per_batch);
            let _infallible = writeln!(table, "| {name} | {on} | {drops} | {through} | {left} |");
        }
    }
    progress.finish_and_clear();
    table
}

fn batch_of_drops(method: Method, mesh: &MorphMesh, ccd: bool, batch: u64, count: u64) -> (u64, u64) {
    let mut rng = Pcg64Mcg::seed_from_u64(batch);
    let mut app = here();
    let mut surface = Surface::spawn(&mut app, method, mesh, Vec3::ZERO, &mut None);
    settle(&mut app);
    let mut bodies = Vec::new();
    for _ in 0..count {
        let mut within = |reach: f32| rng.random_range(-reach..=reach);
        let at = Vec3::new(within(6.0), 5.0 + within(2.0), within(6.0));
        // As after a fall of some metres.
        let linear = Vec3::new(within(3.0), -6.0 + within(4.0), within(3.0));
        let angular = Vec3::new(within(5.0), within(5.0), within(5.0));
        let size = 0.25 + within(0.15);
        let collider = match bodies.len() % 3 {
            0 => Collider::ball(size),
            1 => Collider::cuboid(size, 0.7 * size, 0.5 * size),
            _ => Collider::capsule_y(size, 0.5 * size),
        };
        let body = body(&mut app, collider, at);
        // They meet the surface alone.
        let groups = CollisionGroups::new(Group::GROUP_1, Group::ALL ^ Group::GROUP_1);
        let mut entity = app.world_mut().entity_mut(body);
        entity.insert((Velocity { linear, angular }, groups));
        if ccd {
            entity.insert(Ccd::enabled());
        }
        bodies.push(body);
    }
    for step in 0..240 {
        let time = step as f32 * DT;
        surface.pose(&mut app, &[(3.0 * time).sin(), (2.3 * time).cos()]);
        app.update();
    }
    let places = bodies.iter().map(|&body| state(&app, body).0);
    places.fold((0, 0), |(through, left), at| {
        if at.x.abs().max(at.z.abs()) > 11.5 {
            (through, left + 1)
        } else {
            (through + u64::from(at.y < -1.0), left)
        }
    })
}

/// What a scene of the table of times is.
struct Scene {
    what: &'static str,
    shapes: usize,
    /// On each of the first so many shapes.
    on: usize,
    bodies: usize,
    morphs: bool,
}

fn scenes() -> Vec<Scene> {
    let few = |shapes, on| Scene {
        what: "few bodies",
        shapes,
        on,
        bodies: 2,
        morphs: true,
    };
    vec![
        few(1, 1),
        few(10, 10),
        few(100, 1),
        Scene {
            what: "many bodies",
            bodies: 100,
            ..few(1, 1)
        },
        Scene {
            what: "many bodies",
            bodies: 30,
            ..few(10, 10)
        },
        Scene {
            what: "nothing near",
            bodies: 0,
            ..few(10, 0)
        },
        Scene {
            what: "nothing morphs",
            morphs: false,
            ..few(1, 1)
        },
        Scene {
            what: "nothing morphs, many bodies",
            bodies: 100,
            morphs: false,
            ..few(1, 1)
        },
    ]
}

/// What a frame costs.
fn times(quick: bool) -> String {
    let mesh = sheet(101);
    let frames = if quick { 20 } else { 100 };
    let scenes = scenes();
    let mut table = String::from("| surfaces | bodies | ours, µs |");
    for method in &Method::ALL[1..] {
        let _infallible = write!(table, " {} |", method.name());
    }
    table.push_str("\n|---|---|--:|--:|--:|--:|--:|\n");
    let progress = progress(scenes.len() as u64);
    for scene in &scenes {
        let row = time(scene, &mesh, frames, &Method::ALL);
        let (shapes, bodies) = (scene.shapes, scene.on * scene.bodies);
        let _infallible = write!(table, "| {shapes} | {bodies} ({}) | {:.0} |", scene.what, row[0]);
        for rival in &row[1..] {
            let _infallible = write!(table, " {:.2} |", rival / row[0]);
        }
        table.push('\n');
        progress.inc(1);
    }
    progress.finish_and_clear();
    table
}

/// Frames of one way in a row.
const TURN: usize = 20;

/// Medians of whole frames in microseconds, the ways in turns.
fn time(scene: &Scene, mesh: &MorphMesh, frames: usize, methods: &[Method]) -> Vec<f64> {
    let mut worlds: Vec<_> = methods
        .iter()
        .map(|&method| {
            let mut app = here();
            let mut shared = None;
            let surfaces: Vec<_> = (0..scene.shapes)
                .map(|i| Surface::spawn(&mut app, method, mesh, Vec3::X * 20.0 * i as f32, &mut shared))
                .collect();
            settle(&mut app);
            for surface in 0..scene.on {
                for i in 0..scene.bodies {
                    let cell =
                        Vec3::new((i % 10) as f32 - 4.5, 0.4, (i / 10) as f32 - 4.5) * Vec3::new(0.75, 1.0, 0.75);
                    let at = Vec3::X * 20.0 * surface as f32 + cell;
                    let collider = if i % 2 == 0 {
                        Collider::ball(0.3)
                    } else {
                        Collider::cuboid(0.3, 0.3, 0.3)
                    };
                    let body = body(&mut app, collider, at);
                    app.world_mut().entity_mut(body).insert(Sleeping::disabled());
                }
            }
            (app, surfaces)
        })
        .collect();
    // In turns of some frames, as in a game that has its caches to itself.
    let mut times = vec![Vec::new(); worlds.len()];
    for turn in 0..=frames.div_ceil(TURN) {
        for ((app, surfaces), times) in worlds.iter_mut().zip(&mut times) {
            for frame in 0..TURN {
                let time = (turn * TURN + frame) as f32 * DT;
                let start = Instant::now();
                if scene.morphs {
                    for surface in surfaces.iter_mut() {
                        surface.pose(app, &[0.05 * (6.0 * time).sin(), 0.05 * (5.0 * time).cos()]);
                    }
                }
                app.update();
                // The first turn is for bodies to come to rest, the first frames of one for caches to fill.
                if turn > 0 && frame >= TURN / 4 {
                    times.push(start.elapsed().as_secs_f64() * 1e6);
                }
            }
        }
    }
    times.into_iter().map(|times| median(times.into_iter())).collect()
}
