//! Twelve dolphins that swim closely together as a group, roll, and touch now and then: the paper's Fig. 7.

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::scenes::dolphins as lanes;

use crate::view::Show;
use crate::view::clock::{Clock, started};
use crate::view::models::{Plays, scene};

/// Placements are asked for in fractions of a frame, for when the show does not run at full speed.
const FRACTIONS: f64 = 256.0;

#[derive(Resource)]
struct Group {
    model: PathBuf,
    count: usize,
}

/// Number in the group.
#[derive(Component)]
struct Dolphin(usize);

/// `count` dolphins of the glTF file `model`: an asset's name, or any path.
#[must_use]
pub fn dolphins(model: &Path, count: usize) -> Show {
    let model = model.to_path_buf();
    Show {
        name: "dolphins",
        about: "Dolphins, morphed by the GPU, swim as a group. Touching triangles are red.",
        keys: &[],
        eye: Vec3::new(1.7, 1.35, 3.1),
        target: Vec3::new(0.0, -0.1, 0.0),
        pictures: &[60, 160, 250, 340],
        scene: Box::new(move |app| {
            app.insert_resource(Group { model, count })
                .add_systems(Startup, spawn)
                .add_systems(Update, swim.run_if(started));
        }),
    }
}

fn spawn(mut commands: Commands, group: Res<Group>, assets: Res<AssetServer>) {
    for index in 0..group.count {
        commands.spawn((
            Dolphin(index),
            Name::new(format!("dolphin {index}")),
            scene(&assets, &group.model),
            Plays::from(&assets, &group.model, lanes::phase(index)),
            MorphColliderScene::default(),
            // Until the show begins they keep apart.
            Transform::from_xyz(1000.0 * index as f32, 0.0, 0.0),
        ));
    }
}

fn swim(mut dolphins: Query<(&Dolphin, &mut Transform)>, group: Res<Group>, clock: Res<Clock>) {
    let frames = lanes::FRAMES * FRACTIONS as usize;
    let now = (clock.frame * FRACTIONS).round() as usize % frames;
    for (&Dolphin(index), mut place) in &mut dolphins {
        let lane = lanes::placement(index, group.count, now, frames);
        let (_, rotation, translation) = lane.to_scale_rotation_translation();
        // The camera swims along.
        let translation = translation - Vec3::X * lanes::way(now, frames);
        *place = Transform { translation, rotation, ..default() };
    }
}
