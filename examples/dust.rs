//! Ten thousand grains of dust fall on a dancing character, slide along its skin and fall off.
//!
//! One call of `MorphSpatialQuery::project_points` finds the skin near all grains, and projections know its velocity: a raised arm throws the
//! dust off. `game` is what you would copy. With the feature `render` it is drawn, unless `--headless` asks for numbers.

use std::{path::Path, process::ExitCode, time::Instant};

use bevy::{gltf::Gltf, prelude::*};
use bevy_morph_collision::{prelude::*, spatial::MorphProjection};
use clap::Parser;
use morph_collision_workspace::app::{self, update_until};
use morph_collision_workspace::dust::{Dust, Report};
use morph_collision_workspace::outcome::{exit_code, print_report};
#[cfg(feature = "render")]
use morph_collision_workspace::view::{self, Demo};
use morph_collision_workspace::{character::MODEL, error::ExampleError, options::OutputOptions};

/// Dust falls on a dancing character.
#[derive(Parser)]
struct Options {
    /// Frames of 1/60 s each.
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: u32,
    /// Grains of dust, without a window.
    #[arg(long, default_value_t = GRAINS, value_parser = clap::value_parser!(u32).range(..=1_000_000))]
    grains: u32,
    #[command(flatten)]
    output: OutputOptions,
}

const GRAINS: u32 = 10_000;
/// The distance of grains from the skin, in metres.
const RADIUS: f32 = 0.006;
/// How far the skin looks for grains that are inside it: more than a grain falls in a frame.
const REACH: f32 = 0.04;
/// The share of its speed along the skin that a grain loses in a frame.
const FRICTION: f32 = 0.06;
/// The share of its speed that a grain loses in the air in a second: it falls at 1.6 metres per second in the end.
const DRAG: f32 = 6.0;

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn game(app: &mut App) {
    app.add_plugins(MorphCollisionPlugin)
        .add_systems(Startup, spawn)
        .add_systems(Update, (dance, fall));
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    // The model is in decimetres, and its root is in its middle.
    let place = Transform::from_xyz(0.0, 0.84, 0.0).with_scale(Vec3::splat(0.1));
    let model = WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(MODEL)));
    // Nothing is compared with the skin, but queries find it.
    let collider = MorphCollider::new(MorphCollisionMode::Passive);
    let scene = MorphColliderScene { collider, ..default() };
    commands.spawn((model, scene, Visibility::default(), place));
}

/// Plays a clip as soon as the model is there.
fn dance(
    mut players: Query<(Entity, &mut AnimationPlayer), Without<AnimationGraphHandle>>,
    (assets, gltfs): (Res<AssetServer>, Res<Assets<Gltf>>),
    mut file: Local<Option<Handle<Gltf>>>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    mut commands: Commands,
) {
    let gltf = gltfs.get(file.get_or_insert_with(|| assets.load(MODEL)));
    let Some(clip) = gltf.and_then(|gltf| gltf.named_animations.get("wave_and_crouch")) else {
        return;
    };
    for (entity, mut player) in &mut players {
        let (graph, node) = AnimationGraph::from_clip(clip.clone());
        player.play(node).repeat();
        commands.entity(entity).insert(AnimationGraphHandle(graphs.add(graph)));
    }
}

/// Moves all grains by one frame.
fn fall(
    mut dust: ResMut<Dust>,
    spatial: MorphSpatialQuery,
    time: Res<Time>,
    mut skin: Local<Vec<Option<MorphProjection>>>,
) {
    let (seconds, dust) = (time.delta_secs(), &mut *dust);
    for (place, velocity) in dust.places.iter_mut().zip(&mut dust.velocities) {
        *velocity += seconds * (Vec3::NEG_Y * 9.81 - *velocity * DRAG);
        *place += seconds * *velocity;
    }
    spatial.project_points(&dust.places, REACH, &MorphQueryFilter::default(), &mut skin);
    dust.on_skin.clear();
    for (grain, near) in skin.iter().enumerate() {
        let (place, velocity) = (&mut dust.places[grain], &mut dust.velocities[grain]);
        let is_inside = |near: &MorphProjection| (*place - near.point).dot(near.normal) < -0.7 * near.distance;
        let Some(near) = near.filter(|near| near.distance < RADIUS || is_inside(near)) else {
            continue;
        };
        let of_skin = near.velocity(&spatial).unwrap_or_default();
        let relative = *velocity - of_skin;
        let along = relative - relative.dot(near.normal).min(0.0) * near.normal;
        *velocity = of_skin + (1.0 - FRICTION) * along;
        *place = near.point + RADIUS * near.normal;
        dust.on_skin.push(grain as u32);
    }
    dust.lift_fallen();
}

fn run(options: &Options) -> Result<(), ExampleError> {
    if options.output.is_drawn("dust")? {
        #[cfg(feature = "render")]
        return view::run(demo(), &options.output.view);
    }
    let assets = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets"));
    let mut app = app::without_collisions(assets);
    app.add_plugins(game).insert_resource(Dust::default());
    app::ready(&mut app);
    update_until(&mut app, &assets.join(MODEL), |world| {
        Ok(world.resource::<MorphCollisionDiagnostics>().colliders == 1)
    })?;
    app.insert_resource(Dust::new(options.grains));
    let mut report = Report::default();
    for _ in 0..options.frames {
        let start = Instant::now();
        app.update();
        report.look(app.world().resource::<Dust>(), start.elapsed());
    }
    print_report(&report, options.output.json);
    Ok(())
}

/// The CC0 character.
#[cfg(feature = "render")]
#[must_use]
pub fn demo() -> Demo {
    Demo {
        name: "dust",
        about: "Ten thousand grains of dust fall on a dancing character, slide along its skin and fall off.",
        keys: &[],
        eye: Vec3::new(0.5, 1.5, 2.9),
        target: Vec3::new(0.0, 0.95, 0.0),
        pictures: &[90, 150, 210],
        scene: Box::new(|app| {
            app.insert_resource(Dust::new(GRAINS));
            app.add_plugins((game, MorphBoundsPlugin, morph_collision_workspace::dust::stage::plugin));
        }),
    }
}
