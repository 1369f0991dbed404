//! Balls and boxes rain on a body that breathes and wobbles, and on a face that speaks: both push and carry what falls on them.
//!
//! With the feature `render` it is drawn, unless `--headless` asks for numbers; `--help` lists the options.

use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use bevy::ecs::system::RunSystemOnce;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_rapier3d::prelude::*;
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use morph_collision_testkit::{gltf_read, mesh::MorphMesh};
use morph_collision_workspace::app::locate;
use morph_collision_workspace::error::ExampleError;
use morph_collision_workspace::options::ViewOptions;
use morph_collision_workspace::physics::{DT, app, bevy_mesh, body, settle, state, wobbling};
#[cfg(feature = "render")]
use morph_collision_workspace::{shows, view};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

/// Balls and boxes rain on morphing bodies.
#[derive(Parser)]
struct Options {
    /// Balls and boxes.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    bodies: u32,
    /// Steps of a sixtieth of a second.
    #[arg(long, default_value_t = 900, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    steps: u32,
    /// glTF or glb files with morph targets, in place of the body and the face; drawn: glb, without the places of its nodes.
    #[arg(long)]
    model: Vec<PathBuf>,
    /// Continuous collision detection for what falls.
    #[arg(long)]
    ccd: bool,
    /// Where and how bodies fall.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Do not draw, print numbers. Without the feature `render` nothing else can be done.
    #[arg(long)]
    headless: bool,
    #[command(flatten)]
    view: ViewOptions,
    /// Print nothing but the result, as one JSON object.
    #[arg(long)]
    json: bool,
}

/// What came of it.
#[derive(Serialize)]
struct Report {
    bodies: usize,
    steps: u32,
    /// Bodies whose centre went through a surface.
    fell_through: usize,
    /// Bodies that hardly move at the end.
    resting: usize,
    /// Whole frames, in microseconds.
    step_us: Times,
}

#[derive(Serialize)]
struct Times {
    median: f64,
    worst: f64,
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

fn run(options: &Options) -> Result<(), ExampleError> {
    if options.view.is_drawn("physics", options.headless || options.json)? {
        #[cfg(feature = "render")]
        return draw(options);
    }
    let mut scene = Rain::new(options)?;
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len}").unwrap_or(ProgressStyle::default_bar());
    let progress = ProgressBar::new(options.steps.into()).with_style(style);
    for step in 0..options.steps {
        scene.step(step);
        progress.inc(1);
    }
    progress.finish_and_clear();
    let report = scene.report(options.steps);
    let text = match options.json {
        // Numbers and plain names always have a JSON form.
        true => serde_json::to_string(&report).unwrap_or_default(),
        false => report.to_string(),
    };
    if writeln!(io::stdout().lock(), "{text}").is_err() {
        std::process::exit(0);
    }
    Ok(())
}

#[cfg(feature = "render")]
fn draw(options: &Options) -> Result<(), ExampleError> {
    let models = options
        .model
        .iter()
        .map(|model| locate(model))
        .collect::<Result<_, _>>()?;
    let rain = shows::Rain {
        bodies: options.bodies,
        seed: options.seed,
        ccd: options.ccd,
        models,
    };
    view::run(shows::physics(rain), &options.view)
}

/// The scene.
struct Rain {
    app: App,
    /// Surfaces, and how many targets they have.
    surfaces: Vec<(Entity, usize)>,
    bodies: Vec<Falling>,
    times: Vec<f64>,
}

struct Falling {
    body: Entity,
    at: Vec3,
    through: bool,
}

impl Rain {
    fn new(options: &Options) -> Result<Self, ExampleError> {
        let assets = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets"));
        let mut models = options.model.clone();
        if models.is_empty() {
            models = ["pass_through_20480.glb", "mh_head_eyes_teeth_arkit52.glb"]
                .map(|name| assets.join(name))
                .to_vec();
        }
        let mut app = app(assets);
        let mut surfaces = Vec::new();
        for (i, model) in models.iter().enumerate() {
            let file = locate(model)?;
            let meshes = gltf_read::read_meshes(&file).map_err(|error| ExampleError::Read(error.to_string()))?;
            let place = Transform::from_xyz(8.0 * i as f32 - 4.0 * (models.len() - 1) as f32, 0.0, 0.0);
            surfaces.extend(spawn(&mut app, &meshes, place));
        }
        let ground = (Collider::cuboid(50.0, 1.0, 50.0), Transform::from_xyz(0.0, -4.0, 0.0));
        app.world_mut().spawn(ground);
        settle(&mut app);

        let mut rng = Pcg64Mcg::seed_from_u64(options.seed);
        let bodies = (0..options.bodies).map(|i| {
            let mut within = |reach: f32| rng.random_range(-reach..=reach);
            let over = 8.0 * (i as usize % models.len()) as f32 - 4.0 * (models.len() - 1) as f32;
            let at = Vec3::new(over + within(2.0), 4.0 + 0.1 * i as f32, within(2.0));
            let size = 0.2 + within(0.08);
            let collider = match i % 2 {
                0 => Collider::ball(size),
                _ => Collider::cuboid(size, 0.8 * size, 0.6 * size),
            };
            let body = body(&mut app, collider, at);
            if options.ccd {
                app.world_mut().entity_mut(body).insert(Ccd::enabled());
            }
            let through = false;
            Falling { body, at, through }
        });
        let bodies = bodies.collect();
        Ok(Self {
            app,
            surfaces,
            bodies,
            times: Vec::new(),
        })
    }

    fn step(&mut self, step: u32) {
        let time = step as f32 * DT;
        for &(surface, targets) in &self.surfaces {
            if let Some(mut weights) = self.app.world_mut().get_mut::<MeshMorphWeights>(surface) {
                *weights = MeshMorphWeights::Value {
                    weights: wobbling(time, targets),
                };
            }
        }
        let start = Instant::now();
        self.app.update();
        self.times.push(start.elapsed().as_secs_f64() * 1e6);
        self.watch();
    }

    /// Looks for bodies whose centres went through a surface.
    fn watch(&mut self) {
        let mut ways = Vec::new();
        for falling in &mut self.bodies {
            let at = state(&self.app, falling.body).0;
            ways.push((std::mem::replace(&mut falling.at, at), at));
        }
        let crosses = move |mut spatial: MorphSpatialQuery| -> Vec<bool> {
            let mut crosses = |&(from, to): &(Vec3, Vec3)| {
                let way = Dir3::new(to - from).ok();
                let hit = way.map(|way| spatial.cast_ray(from, way, from.distance(to), &MorphQueryFilter::default()));
                matches!(hit, Some(Ok(Some(_))))
            };
            ways.iter().map(&mut crosses).collect()
        };
        let crossed = self.app.world_mut().run_system_once(crosses).unwrap_or_default();
        for (falling, crossed) in self.bodies.iter_mut().zip(crossed) {
            falling.through |= crossed;
        }
    }

    fn report(mut self, steps: u32) -> Report {
        let resting = |falling: &&Falling| state(&self.app, falling.body).1.length() < 0.2;
        let resting = self.bodies.iter().filter(resting).count();
        self.times.sort_by(f64::total_cmp);
        let tenths = |us: f64| (us * 10.0).round() / 10.0;
        let at = |place: usize| self.times.get(place).copied().map_or(0.0, tenths);
        Report {
            bodies: self.bodies.len(),
            steps,
            fell_through: self.bodies.iter().filter(|falling| falling.through).count(),
            resting,
            step_us: Times {
                median: at(self.times.len() / 2),
                worst: at(self.times.len().saturating_sub(1)),
            },
        }
    }
}

/// The meshes of a model, made 5 high together.
fn spawn(app: &mut App, meshes: &[MorphMesh], place: Transform) -> Vec<(Entity, usize)> {
    let all = || meshes.iter().flat_map(|mesh| &mesh.positions);
    let (min, max) = all().fold((Vec3::MAX, Vec3::MIN), |(min, max), p| (min.min(*p), max.max(*p)));
    let scale = 5.0 / (max - min).max_element().max(f32::MIN_POSITIVE);
    let place = place
        .with_scale(Vec3::splat(scale))
        .with_translation(place.translation - scale * 0.5 * (min + max));
    let mut surfaces = Vec::new();
    for mesh in meshes {
        let asset = app.world_mut().resource_mut::<Assets<Mesh>>().add(bevy_mesh(mesh));
        let weights = MeshMorphWeights::Value {
            weights: vec![0.0; mesh.targets.len()],
        };
        let surface = (Mesh3d(asset), weights, MorphRapierCollider::default(), place);
        surfaces.push((app.world_mut().spawn(surface).id(), mesh.targets.len()));
    }
    surfaces
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            bodies,
            steps,
            fell_through,
            resting,
            step_us: Times { median, worst },
        } = self;
        writeln!(f, "{bodies} bodies, {steps} steps")?;
        writeln!(f, "  fell through   {fell_through}")?;
        writeln!(f, "  resting        {resting}")?;
        write!(f, "  per step       {median:.0} us median, {worst:.0} us worst")
    }
}
