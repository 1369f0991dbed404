//! Twelve dolphins that swim closely together as a group, roll, and touch now and then: the paper's Fig. 7. Any other model can
//! take their place.

use std::path::Path;

use bevy::prelude::*;
use morph_collision_testkit::scenes::dolphins as lanes;

use super::group::{Group, Member};
use crate::view::Show;
use crate::view::clock::{Clock, FRACTIONS, started};

/// Closer together than in the timed scene, so that more contacts can be seen.
const CLOSER: Vec3 = Vec3::new(1.0, 0.8, 0.8);

/// `count` instances of the glTF file `model`: an asset's name, or any path. A `foreign` model is not a dolphin.
#[must_use]
pub fn dolphins(model: &Path, count: usize, foreign: bool) -> Show {
    let group = Group::new(model, count, foreign);
    Show {
        name: "dolphins",
        about: "Dolphins, morphed by the GPU, swim as a group. Touching triangles are red.",
        keys: &[],
        eye: Vec3::new(1.15, 1.1, 2.5),
        target: Vec3::new(0.0, -0.1, 0.0),
        pictures: &[20, 60, 240, 380],
        scene: Box::new(move |app| {
            group.join(app);
            app.add_systems(Update, swim.run_if(started));
        }),
    }
}

fn swim(mut dolphins: Query<(&Member, &mut Transform)>, group: Res<Group>, clock: Res<Clock>) {
    let frames = lanes::FRAMES * FRACTIONS;
    let now = clock.fractions() % frames;
    for (&Member(index), mut place) in &mut dolphins {
        let lane = lanes::placement(index, group.count, now, frames);
        let (_, rotation, translation) = lane.to_scale_rotation_translation();
        // The camera swims along.
        let translation = (translation - Vec3::X * lanes::way(now, frames)) * CLOSER;
        *place = group.place(Transform::from_translation(translation).with_rotation(rotation));
    }
}
