//! A character that walks, talks, crouches and waves, and crates in its way.
//!
//! - `act`: its schedule.
//! - `props`: the crates, and where rays are cast at it.
//! - `hand`: detects where its hand touches its face.
//! - `report`: what a run without a window counts.
//! - `stage`: draws what happens.

mod act;
mod hand;
mod props;
mod report;
#[cfg(feature = "render")]
pub mod stage;

use bevy::app::AnimationSystems;
use bevy::gltf::Gltf;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_rapier3d::prelude::*;

pub use act::PERIOD;
pub use hand::HandOnFace;
pub use props::{Aim, Crate, Dart, GROUND, HALF};
pub use report::Report;

use crate::physics::DT;

/// The file, among the assets.
pub const MODEL: &str = "mh_character_low.glb";

/// The current time: the show's clock, or the frames of a headless run.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct Moment {
    /// Seconds since the beginning.
    pub seconds: f32,
    /// Whether everything is loaded.
    pub started: bool,
}

/// What has happened so far.
#[derive(Resource, Clone, Debug, Default)]
pub struct Tally {
    /// Rays cast at it.
    pub rays: u32,
    /// Rays that hit, each of which left a dart.
    pub hits: u32,
    /// The joint that was hit last, and the velocity of the skin there, in units per second.
    pub last_hit: Option<(String, Vec3)>,
    /// Number of crates that it has kicked.
    pub kicks: u32,
}

/// The root of the character's scene.
#[derive(Component, Clone, Copy, Debug)]
pub struct Character;

/// The character's mesh.
#[derive(Component, Clone, Copy, Debug)]
pub struct Skin;

/// The file, while its clips are not found yet.
#[derive(Resource)]
struct Cast(Handle<Gltf>);

/// The systems that make it act, in [`Update`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ActSystems;

/// The character's act, the crates, and what its hand touches. Whatever adds this moves [`Moment`] on.
pub fn plugin(app: &mut App) {
    app.init_resource::<Moment>()
        .init_resource::<Tally>()
        .init_resource::<Aim>()
        .insert_resource(TimestepMode::Variable {
            max_dt: 8.0 * DT,
            time_scale: 1.0,
            substeps: 1,
        })
        .add_systems(Startup, (cast, props::spawn))
        .add_systems(
            Update,
            (
                act::rehearse,
                (act::play, props::watch, props::bring_back)
                    .chain()
                    .in_set(ActSystems)
                    .run_if(started),
            ),
        )
        .add_systems(
            PostUpdate,
            (
                act::raise_hand.after(AnimationSystems).before(PhysicsSet::SyncBackend),
                hand::feel
                    .after(MorphCollisionSystems::Weights)
                    .before(MorphCollisionSystems::Anchors),
            ),
        );
}

fn cast(mut commands: Commands, assets: Res<AssetServer>) {
    commands.insert_resource(Cast(assets.load(MODEL)));
    commands.spawn((
        Character,
        WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(MODEL))),
        Visibility::default(),
        act::standing(0.0),
    ));
}

/// A run condition: everything is loaded.
pub fn started(moment: Res<Moment>) -> bool {
    moment.started
}
