//! A dense crowd of morphing dolphins, all of them with collision on.

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::scenes::dolphins as lanes;

use crate::instances::in_crowd;
use crate::view::Show;
use crate::view::clock::{Clock, started};
use crate::view::models::{Plays, scene};

/// From one to the next, in world units; a dolphin is 2 long.
const SPACING: f32 = 1.0;

#[derive(Resource)]
struct Crowd {
    model: PathBuf,
    count: usize,
}

/// Number in the crowd.
#[derive(Component)]
struct Member(usize);

/// `count` instances of the glTF file `model`.
#[must_use]
pub fn crowd(model: &Path, count: usize) -> Show {
    let model = model.to_path_buf();
    let side = (count as f32).cbrt().ceil() * SPACING;
    Show {
        name: "crowd",
        about: "Everyone may touch everyone; only those near each other are compared.",
        keys: &[],
        eye: Vec3::new(0.9, 0.7, 1.2) * side.max(1.0),
        target: Vec3::ZERO,
        pictures: &[0, 60],
        scene: Box::new(move |app| {
            app.insert_resource(Crowd { model, count })
                .add_systems(Startup, spawn)
                .add_systems(Update, mill.run_if(started));
        }),
    }
}

fn spawn(mut commands: Commands, crowd: Res<Crowd>, assets: Res<AssetServer>) {
    for index in 0..crowd.count {
        commands.spawn((
            Member(index),
            scene(&assets, &crowd.model),
            Plays::from(&assets, &crowd.model, lanes::phase(index)),
            MorphColliderScene::default(),
            // Until the show begins they keep apart.
            Transform::from_xyz(1000.0 * index as f32, 0.0, 0.0),
        ));
    }
}

fn mill(mut members: Query<(&Member, &mut Transform)>, crowd: Res<Crowd>, clock: Res<Clock>) {
    let middle = 0.5 * SPACING * ((crowd.count as f32).cbrt().ceil() - 1.0);
    for (&Member(index), mut place) in &mut members {
        *place = in_crowd(index, crowd.count, clock.frame as f32 / 60.0, SPACING);
        place.translation -= middle;
    }
}
