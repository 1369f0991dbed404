//! A skinned and morphed character walks, talks, crouches and waves. Rays stick to its skin, it kicks crates, and its hand turns
//! red where it touches the face.
//!
//! - One `MorphPhysicsCollider` on the mesh lets its feet kick crates, and lets rays hit its skin.
//! - A hit names the joint and the velocity of the skin there, and an anchor keeps the dart on its triangle.
//!
//! With the feature `render` it is drawn, unless `--headless` asks for numbers. `--help` lists the options.

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use clap::Parser;
use morph_collision_workspace::app::{self, STEP, update_until};
use morph_collision_workspace::character::{
    self, ActSystems, Aim, Dart, HandOnFace, MODEL, Moment, Report, Skin, Tally,
};
use morph_collision_workspace::error::ExampleError;
use morph_collision_workspace::options::OutputOptions;
use morph_collision_workspace::outcome::{exit_code, print_report};
use morph_collision_workspace::physics;
#[cfg(feature = "render")]
use morph_collision_workspace::view::{self, Demo};

/// A character that walks, talks, crouches and waves, is hit by rays and kicks crates.
#[derive(Parser)]
struct Options {
    /// Frames of 1/60 s each.
    #[arg(long, default_value_t = 960, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: u32,
    #[command(flatten)]
    output: OutputOptions,
}

/// No more darts than these are on the skin at a time.
const DARTS: usize = 48;

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn game(app: &mut App) {
    app.add_plugins((
        RapierPhysicsPlugin::<NoUserData>::default(),
        MorphCollisionPlugin,
        MorphRapierPlugin,
        // The character's act, and the crates.
        character::plugin,
    ))
    .add_systems(Update, (dress, shoot.after(ActSystems).run_if(character::started)));
}

/// Makes the mesh collide, in physics too.
fn dress(skinned: Query<Entity, (With<SkinnedMesh>, Without<Skin>)>, mut commands: Commands) {
    for mesh in &skinned {
        commands
            .entity(mesh)
            .insert((Skin, MorphPhysicsCollider::default(), HandOnFace::default()));
    }
}

/// Casts a ray at the skin now and then, and leaves a dart where it hits.
#[allow(clippy::too_many_arguments, reason = "systems name what they need")]
fn shoot(
    moment: Res<Moment>,
    mut aim: ResMut<Aim>,
    spatial: MorphSpatialQuery,
    skin: Single<Entity, With<Skin>>,
    names: Query<&Name>,
    darts: Query<(), With<Dart>>,
    mut tally: ResMut<Tally>,
    mut commands: Commands,
) {
    let Some(bounds) = spatial.bounds(*skin).filter(|_| darts.count() < DARTS) else {
        return;
    };
    let Some(ray) = aim.ray(moment.seconds, bounds.center(), bounds.size()) else {
        return;
    };
    tally.rays += 1;
    if let Some(hit) = spatial.cast_ray(ray.origin, ray.direction, 10.0, &MorphQueryFilter::default()) {
        tally.hits += 1;
        let joint = hit.joint.and_then(|joint| names.get(joint).ok());
        let velocity = hit.velocity(&spatial).unwrap_or_default();
        tally.last_hit = Some((joint.map(ToString::to_string).unwrap_or_default(), velocity));
        commands.spawn((Dart, MorphSurfaceAnchor::at(&hit), Visibility::default()));
    }
}

fn run(options: &Options) -> Result<(), ExampleError> {
    if options.output.is_drawn("character")? {
        #[cfg(feature = "render")]
        return view::run(demo(), &options.output.view);
    }
    let assets = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets"));
    let mut app = app::without_collisions(assets);
    app.add_plugins(game);
    app::ready(&mut app);
    update_until(&mut app, &assets.join(MODEL), |world| {
        Ok(world.query_filtered::<(), With<Skin>>().iter(world).count() == 1)
    })?;
    physics::settle(&mut app);
    let mut report = Report::default();
    for frame in 0..options.frames {
        let seconds = frame as f32 * STEP.as_secs_f32();
        app.insert_resource(Moment { seconds, started: true });
        let start = Instant::now();
        app.update();
        report.look(&mut app, start.elapsed());
    }
    report.finish();
    print_report(&report, options.output.json);
    Ok(())
}

/// The CC0 character.
#[cfg(feature = "render")]
#[must_use]
pub fn demo() -> Demo {
    Demo {
        name: "character",
        about: "A skinned and morphed character: rays stick to its skin, crates feel its feet, and its hand on its face is red.",
        keys: &[("click", "sticks a dart to the skin"), ("X", "removes the darts")],
        eye: Vec3::new(-0.35, 1.15, 3.75),
        target: Vec3::new(-0.2, 0.62, 0.5),
        pictures: &[66, 200],
        scene: Box::new(|app| {
            app.add_plugins((game, MorphBoundsPlugin, MorphPickingPlugin, character::stage::plugin));
        }),
    }
}
