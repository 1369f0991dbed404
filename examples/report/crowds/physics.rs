//! Physics surfaces of a crowd near which nobody is, and of one in which a player walks into one character.

use avian3d::prelude as avian;
use bevy::app::AnimationSystems;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_avian::MorphAvianPlugin;
use bevy_morph_collision::prelude::*;
use bevy_morph_physics::MorphPhysicsScene;
use bevy_morph_rapier::MorphRapierPlugin;
use bevy_rapier3d::prelude as rapier;
use clap::ValueEnum;
use morph_collision_testkit::report::Table;
use morph_collision_workspace::app::STEP;

use super::APART;
use crate::characters::{Stage, frame_times, grid};
use crate::model::Model;

pub(super) const CHARACTERS: usize = 100;
const CLIP: &str = "walk_and_talk";
/// The unit of the model is the decimetre.
const LENGTH_UNIT: f32 = 10.0;

/// What there is besides the animated characters.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum Way {
    /// Rapier, in which nothing is.
    Rapier,
    /// Each character has a surface in Rapier.
    RapierSurfaces,
    /// The same, and a player walks into one of them.
    RapierWalked,
    /// Avian, in which nothing is.
    Avian,
    /// Each character has a surface in Avian.
    AvianSurfaces,
    /// The same, and a player walks into one of them.
    AvianWalked,
}

impl Way {
    pub(super) fn has_surfaces(self) -> bool {
        !matches!(self, Self::Rapier | Self::Avian)
    }

    fn is_walked(self) -> bool {
        matches!(self, Self::RapierWalked | Self::AvianWalked)
    }

    fn is_rapier(self) -> bool {
        matches!(self, Self::Rapier | Self::RapierSurfaces | Self::RapierWalked)
    }

    pub(super) fn add_physics(self, app: &mut App) {
        app.insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
        if self.is_rapier() {
            let physics = rapier::RapierPhysicsPlugin::<rapier::NoUserData>::default();
            app.add_plugins(physics.with_length_unit(LENGTH_UNIT))
                .insert_resource(rapier::TimestepMode::Fixed {
                    dt: STEP.as_secs_f32(),
                    substeps: 1,
                })
                .configure_sets(PostUpdate, rapier::PhysicsSet::SyncBackend.after(AnimationSystems));
        } else {
            app.add_plugins(avian::PhysicsPlugins::default().with_length_unit(LENGTH_UNIT))
                .insert_resource(Time::<Fixed>::from_duration(STEP));
        }
        if self.has_surfaces() {
            app.add_plugins(MorphPlugins);
            match self.is_rapier() {
                true => _ = app.add_plugins(MorphRapierPlugin),
                false => _ = app.add_plugins(MorphAvianPlugin),
            }
        }
        if self.is_walked() {
            app.add_systems(Startup, spawn_player).add_systems(Update, walk);
        }
    }

    /// The crowd.
    fn stage(self, model: &Model) -> Result<Stage, String> {
        let places = grid(CHARACTERS, APART);
        let add = |app: &mut App| self.add_physics(app);
        let mut stage = if self.has_surfaces() {
            Stage::new(model, &places, MorphPhysicsScene::default(), add)?
        } else {
            Stage::new(model, &places, (), add)?
        };
        stage.play(CLIP)?;
        Ok(stage)
    }
}

/// Walks back and forth, into the first character.
#[derive(Component)]
struct Player;

const RADIUS: f32 = 2.0;

/// The player, who is a body in either engine.
fn spawn_player(mut commands: Commands) {
    commands.spawn((
        Player,
        Transform::from_xyz(0.0, 10.0, 8.0),
        (
            rapier::RigidBody::Dynamic,
            rapier::Collider::ball(RADIUS),
            rapier::Velocity::default(),
            rapier::GravityScale(0.0),
        ),
        (
            avian::RigidBody::Dynamic,
            avian::Collider::sphere(RADIUS),
            avian::GravityScale(0.0),
        ),
    ));
}

/// Walks at a metre a second.
fn walk(
    mut players: Query<(&Transform, &mut rapier::Velocity, &mut avian::LinearVelocity), With<Player>>,
    time: Res<Time>,
) {
    for (place, mut in_rapier, mut in_avian) in &mut players {
        let goal = Vec3::new(3.0 * time.elapsed_secs().sin(), 10.0, 0.0);
        let velocity = (goal - place.translation).clamp_length_max(10.0);
        in_rapier.linear = velocity;
        in_avian.0 = velocity;
    }
}

/// The time of a frame of each crowd.
pub(super) fn times(quick: bool) -> Result<String, String> {
    let model = Model::find("mh_character.glb")?;
    let frames = if quick { 20 } else { 180 };
    let stages: Result<Vec<Stage>, String> = Way::value_variants().iter().map(|way| way.stage(&model)).collect();
    let times = frame_times(&mut stages?, frames);
    let mut table = Table::new([
        "",
        "without surfaces, ms",
        "with surfaces, nobody near, ms",
        "for each surface, µs",
        "a player walks into one, ms",
    ]);
    for (engine, times) in ["Rapier", "Avian"].into_iter().zip(times.chunks(3)) {
        let ms = |us: f64| format!("{:.2}", us / 1000.0);
        let each = (times[1] - times[0]) / CHARACTERS as f64;
        table.row([
            engine.to_owned(),
            ms(times[0]),
            ms(times[1]),
            format!("{each:.1}"),
            ms(times[2]),
        ]);
    }
    Ok(table.to_string())
}

/// The frames that are counted.
pub(super) const COUNTED: usize = 10;

/// Runs a few frames of one crowd, for tools that count instructions in the function `counted_frames`.
pub(crate) fn count(way: Way) -> Result<(), String> {
    let mut stage = way.stage(&Model::find("mh_character.glb")?)?;
    for _ in 0..3 {
        stage.app.update();
    }
    counted_frames(&mut stage.app);
    Ok(())
}

#[inline(never)]
fn counted_frames(app: &mut App) {
    for _ in 0..COUNTED {
        app.update();
    }
}
