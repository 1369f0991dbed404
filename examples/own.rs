//! Your own model, twice: the copies run into each other, and the panel compares the cost with a refit of the whole mesh. Drop
//! other files on the window.
//!
//! Any glTF file works: `MorphColliderScene` makes colliders of all its meshes that morph or follow joints.
//!
//! `game` is what you would copy; the gallery adds camera, light and panel, and checks files. `--help` lists the options.

use std::f32::consts::TAU;
use std::path::PathBuf;
use std::process::ExitCode;

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use clap::Parser;
use morph_collision_workspace::options::ViewOptions;
use morph_collision_workspace::outcome::exit_code;
use morph_collision_workspace::own::{self, Accepted, Inbox, IntakeSystems, Verdict, race};
use morph_collision_workspace::physics::wobbling;
use morph_collision_workspace::view::clock::{Clock, Pending};
use morph_collision_workspace::view::group::{Extent, Idle, Member};
use morph_collision_workspace::view::models::Plays;
use morph_collision_workspace::view::{self, Demo};

/// Two copies of a model run into each other; touching triangles are red.
#[derive(Parser)]
struct Options {
    /// A .glb file, or a self-contained .gltf file, that has morph targets or joints.
    #[arg(default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/mh_head_eyes_teeth_arkit52.glb"))]
    model: PathBuf,
    #[command(flatten)]
    view: ViewOptions,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let name = options.model.display().to_string();
    let inbox = Inbox::default();
    match std::fs::read(&options.model) {
        Ok(bytes) => inbox.put(name, bytes),
        Err(error) => {
            eprintln!("error: {name}: {error}");
            return ExitCode::from(2);
        }
    }
    exit_code(view::run(demo(inbox, Verdict::default()), &options.view))
}

/// Two copies of the model that comes into the inbox.
#[must_use]
pub fn demo(inbox: Inbox, verdict: Verdict) -> Demo {
    Demo {
        name: "own",
        about: "Two copies of your model run into each other. Touching triangles are red.",
        keys: &[],
        eye: Vec3::new(0.9, 0.7, 3.7),
        target: Vec3::new(0.35, 0.0, 0.0),
        pictures: &[100, 140],
        scene: Box::new(|app| {
            app.insert_resource(inbox)
                .insert_resource(verdict)
                .add_plugins((own::plugin, race::plugin, game));
        }),
    }
}

fn game(app: &mut App) {
    app.add_plugins((MorphCollisionPlugin, MorphBoundsPlugin))
        .init_resource::<Fit>()
        .add_systems(Update, (spawn, measure, meet, morph).chain().after(IntakeSystems));
}

/// Replaces the model on the stage.
fn spawn(
    mut accepted: MessageReader<Accepted>,
    before: Query<Entity, With<Member>>,
    mut fit: ResMut<Fit>,
    mut commands: Commands,
) {
    for Accepted { gltf, scene } in accepted.read() {
        before.iter().for_each(|member| commands.entity(member).despawn());
        *fit = Fit(None);
        for index in 0..2 {
            commands.spawn((
                Member(index),
                Name::new(format!("copy {index}")),
                WorldAssetRoot(scene.clone()),
                // All its meshes that deform become colliders, and this entity their body.
                MorphColliderScene::default(),
                Plays::new(gltf.clone(), 0.3 * index as f32),
                Pending,
                Visibility::default(),
                // They keep apart until their size is known.
                Transform::from_xyz(1e6 * index as f32, 0.0, 0.0),
            ));
        }
    }
}

/// How the model on the stage is scaled to the common size.
#[derive(Resource, Default)]
struct Fit(Option<Fitted>);

#[derive(Clone, Copy)]
struct Fitted {
    center: Vec3,
    size: Vec3,
    scale: f32,
}

fn measure(mut fit: ResMut<Fit>, extent: Extent) {
    if fit.0.is_some() {
        return;
    }
    let (min, max) = extent.of_first();
    let size = max - min;
    let longest = size.max_element();
    if longest.is_finite() && longest > 0.0 {
        fit.0 = Some(Fitted {
            center: 0.5 * (min + max),
            size,
            // The longest side is 2 long.
            scale: 2.0 / longest,
        });
    }
}

/// One turns on the spot, the other comes and goes.
fn meet(mut members: Query<(&Member, &mut Transform)>, fit: Res<Fit>, clock: Res<Clock>) {
    let Some(Fitted { center, size, scale }) = fit.0 else {
        return;
    };
    let seconds = clock.frame as f32 / 60.0;
    let apart = size.x * scale * (0.65 + 0.45 * (TAU * seconds / 8.0).cos());
    for (&Member(index), mut place) in &mut members {
        let turn = if index == 0 { 0.25 } else { -0.15 };
        let rotation = Quat::from_rotation_y(turn * (TAU * seconds / 5.0).sin());
        *place = Transform {
            translation: Vec3::X * apart * index as f32 - rotation * center * scale,
            rotation,
            scale: Vec3::splat(scale),
        };
    }
}

/// Without a clip, shows the targets one after the other.
fn morph(mut idle: Idle, clock: Res<Clock>) {
    let seconds = clock.frame as f32 / 60.0;
    idle.for_each(|index, weights| weights.copy_from_slice(&wobbling(seconds + 1.3 * index as f32, weights.len())));
}
