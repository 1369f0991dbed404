//! A small game, set up as a game would do it: a heaving hill, a player who walks on it, and balls and boxes that rain on both.
//!
//! The hill is a glTF file. Bevy's animation player plays its weights from the file's own clip, once a frame. Physics runs in
//! `FixedUpdate`, 64 times a second, independently of the frame rate. One `MorphPhysicsScene` on the scene's root connects the
//! two.
//!
//! - `hill`: the file, its placement and its clip.
//! - `player`: a capsule with Rapier's character controller.
//! - `rain`: the falling bodies.
//! - `tally`, `report`: the statistics.
//! - `stage`: draws the game, and reads keys.

mod hill;
mod player;
mod rain;
mod report;
#[cfg(feature = "render")]
pub mod stage;
mod tally;

use std::path::PathBuf;

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

pub use hill::{Hill, MODEL};
pub use player::{HALF_SEGMENT, IDLE, JUMP, Player, RADIUS, SPEED, Wish};
pub use rain::{Falling, Form};
pub use report::Report;
pub use tally::Tally;

/// Physics steps per second: Bevy's default.
pub const RATE: f64 = 64.0;

/// Half extents of the ground; its top is at height 0.
pub const GROUND: Vec3 = Vec3::new(10.0, 0.5, 10.0);

/// Bodies below this height have left the ground.
const ABYSS: f32 = -6.0;

/// The game's options.
#[derive(Resource, Clone, Debug)]
pub struct Game {
    /// Number of balls and boxes.
    pub bodies: u32,
    /// Random seed for where and how they fall.
    pub seed: u64,
    /// Whether they use continuous collision detection.
    pub ccd: bool,
    /// The hill: an asset's name or a file's path.
    pub model: PathBuf,
}

impl Default for Game {
    fn default() -> Self {
        Self {
            bodies: 120,
            seed: 1,
            ccd: false,
            model: MODEL.into(),
        }
    }
}

/// The player, the rain and the hill's clip. The example adds physics and spawns the hill.
pub fn plugin(app: &mut App) {
    app.init_resource::<Game>()
        .init_resource::<Wish>()
        .init_resource::<Tally>()
        .add_observer(hill::play)
        .add_systems(Startup, lay_the_ground)
        .add_systems(
            Update,
            (
                hill::fit,
                hill::wave,
                (hill::rewind, player::spawn, rain::spawn).run_if(hill::is_new),
            )
                .chain(),
        )
        .add_systems(
            FixedUpdate,
            (
                (player::bring_back, player::walk, rain::bring_back).before(PhysicsSet::SyncBackend),
                (tally::count_ground, tally::find_fallen_through).after(PhysicsSet::Writeback),
            ),
        );
}

/// Steps of the length of those of [`FixedUpdate`].
#[must_use]
pub fn timestep() -> TimestepMode {
    TimestepMode::Fixed {
        dt: (1.0 / RATE) as f32,
        substeps: 1,
    }
}

fn lay_the_ground(mut commands: Commands) {
    commands.spawn((
        Name::new("ground"),
        Collider::cuboid(GROUND.x, GROUND.y, GROUND.z),
        Transform::from_xyz(0.0, -GROUND.y, 0.0),
    ));
}
