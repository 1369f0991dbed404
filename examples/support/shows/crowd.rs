//! A dense crowd of morphing dolphins or another model. All of them collide.

use std::path::Path;

use bevy::prelude::*;

use super::group::{Group, Member};
use crate::instances::in_crowd;
use crate::view::Show;
use crate::view::clock::{Clock, started};

/// Distance between neighbours, in world units; a dolphin is 2 long.
const SPACING: f32 = 1.0;

/// `count` instances of the glTF file `model`: an asset's name, or any path. A `foreign` model is not a
/// dolphin.
#[must_use]
pub fn crowd(model: &Path, count: usize, foreign: bool) -> Show {
    let group = Group::new(model, count, foreign);
    let side = (count as f32).cbrt().ceil() * SPACING;
    Show {
        name: "crowd",
        about: "Everyone may touch everyone; only those near each other are compared.",
        keys: &[],
        eye: Vec3::new(0.9, 0.7, 1.2) * side.max(1.0),
        target: Vec3::ZERO,
        pictures: &[0, 60],
        scene: Box::new(move |app| {
            group.join(app);
            app.add_systems(Update, mill.run_if(started));
        }),
    }
}

fn mill(mut members: Query<(&Member, &mut Transform)>, group: Res<Group>, clock: Res<Clock>) {
    let middle = 0.5 * SPACING * ((group.count as f32).cbrt().ceil() - 1.0);
    for (&Member(index), mut place) in &mut members {
        let mut dolphin = in_crowd(index, group.count, clock.frame as f32 / 60.0, SPACING);
        dolphin.translation -= middle;
        *place = group.place(dolphin);
    }
}
