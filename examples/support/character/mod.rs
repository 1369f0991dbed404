//! A character that walks, talks, crouches and waves. Rays stick to its skin, it kicks crates, and a hand goes to its face.
//!
//! The window and the headless run of the example share this. Nothing here draws.
//!
//! - `act`: its schedule.
//! - `props`: the crates in its way, and the rays that are cast at it.
//! - `hand`: detects where its hand touches its face.

mod act;
mod hand;
mod props;

use bevy::app::AnimationSystems;
use bevy::gltf::Gltf;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_rapier3d::prelude::*;

pub use act::PERIOD;
pub use hand::HandOnFace;
pub use props::{Crate, Dart, GROUND, HALF};

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

/// The whole game, except for physics and collisions themselves, and whatever starts [`Moment`].
pub fn plugin(app: &mut App) {
    app.init_resource::<Moment>()
        .init_resource::<Tally>()
        .init_resource::<props::Aim>()
        .insert_resource(TimestepMode::Variable {
            max_dt: 8.0 * DT,
            time_scale: 1.0,
            substeps: 1,
        })
        .add_systems(Startup, (cast, props::spawn))
        .add_systems(
            Update,
            (
                dress,
                act::rehearse,
                (act::play, props::shoot, props::watch, props::bring_back)
                    .chain()
                    .run_if(|moment: Res<Moment>| moment.started),
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

/// Makes the mesh collide, in physics too.
fn dress(skinned: Query<Entity, (With<SkinnedMesh>, Without<Skin>)>, mut commands: Commands) {
    for mesh in &skinned {
        commands
            .entity(mesh)
            .insert((Skin, MorphRapierCollider::default(), HandOnFace::default()));
    }
}
