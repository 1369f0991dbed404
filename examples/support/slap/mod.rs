//! Two characters slap two others, at so few frames a second that the hand is on one side of the face in one frame and on the other side
//! in the next. One of the hands is a continuous collider.
//!
//! This moves the characters and counts; the example itself spawns them and feels the slaps. The `stage` draws.

#[cfg(feature = "render")]
pub mod stage;

use std::f32::consts::TAU;
use std::fmt;
use std::time::Duration;

use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use serde::Serialize;

/// The time between two frames of the game: ten a second.
pub const TICK: Duration = Duration::from_millis(100);
/// The schedule repeats after this many ticks.
pub const PERIOD: u32 = 24;
/// The tick, counted from the start of a period, at which the hand has passed the face.
pub const SLAP: u32 = 6;

/// The direction of the arm: ticks from the start of a period, how far it points to the left, and how far it points down, in degrees.
const SWING: [(u32, f32, f32); 10] = [
    (0, -80.0, -10.0),
    (SLAP - 2, -75.0, -12.0),
    (SLAP - 1, -35.0, -12.0),
    (SLAP, 35.0, -12.0),
    (SLAP + 1, 75.0, -10.0),
    (9, 80.0, 0.0),
    (12, 80.0, 65.0),
    (16, -80.0, 65.0),
    (20, -80.0, -10.0),
    (PERIOD, -80.0, -10.0),
];
/// The rotation of the right collarbone, in the space of the character.
const COLLARBONE: Quat = Quat::from_xyzw(-0.09, -0.1713, 0.6884, 0.699);
/// The rotation of the right upper arm in the same space if the arm points forward, the thumb up.
const FORWARD: Quat = Quat::from_xyzw(-0.031, 0.7064, 0.7064, -0.031);
/// The rotation of the head, relative to the neck.
const HEAD: Quat = Quat::from_xyzw(-0.07, 0.0, 0.0, 0.9976);
/// The model is in decimetres, and its root is in its middle.
const SCALE: f32 = 0.1;
/// Where the slapped one stands, in front of the other one and a bit to the right, in decimetres.
const OPPOSITE: Vec3 = Vec3::new(-1.2, 0.0, 5.3);
/// How far the middle of a pair is from the origin.
const ASIDE: f32 = 0.62;
/// For how many ticks a slap hurts.
const HURTS: f32 = 8.0;

/// The current frame of the game.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Moment {
    /// Frames since the beginning.
    pub tick: u32,
    /// Whether everything is loaded.
    pub started: bool,
}

/// The two pairs: without and with a continuous collider.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The hand is compared where it is in each frame.
    Discrete,
    /// It is also compared on its way from frame to frame.
    Continuous,
}

/// On the roots of the scenes: which of a pair it is.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The one who slaps.
    Slaps,
    /// The one who is slapped.
    IsSlapped,
}

/// On an anchor on the skin, where the slap was felt.
#[derive(Component, Clone, Copy, Debug)]
pub struct Mark;

/// What has happened on both sides, without and with a continuous collider.
#[derive(Resource, Clone, Debug, Default)]
pub struct Tally {
    /// Slaps so far.
    pub slaps: u32,
    /// How many were felt.
    pub felt: [u32; 2],
    /// The last that was felt.
    pub last: [Option<Felt>; 2],
}

/// How a slap was felt.
#[derive(Clone, Copy, Debug)]
pub struct Felt {
    /// In which tick.
    pub tick: u32,
    /// At which share of the time since the tick before; unknown if only the end of the way was compared.
    pub share: Option<f64>,
    /// How fast the hand was, in metres per second.
    pub speed: f32,
}

/// Moves arms, heads and faces, and counts slaps.
pub fn plugin(app: &mut App) {
    app.init_resource::<Moment>().init_resource::<Tally>().add_systems(
        Update,
        (count.run_if(resource_changed::<Moment>), swing, pull_faces).chain(),
    );
}

impl Role {
    /// Where it stands. They face each other along the x axis; on the left without, on the right with a continuous collider.
    #[must_use]
    pub fn place(self, side: Side) -> Transform {
        let aside = if side == Side::Discrete { -ASIDE } else { ASIDE };
        let turn = Quat::from_rotation_y(0.25 * TAU);
        let start = Vec3::X * aside - turn * OPPOSITE * 0.5 * SCALE;
        let slaps = Transform::from_translation(start)
            .with_rotation(turn)
            .with_scale(Vec3::splat(SCALE));
        match self {
            Role::Slaps => slaps,
            Role::IsSlapped => slaps.with_translation(slaps * OPPOSITE).with_rotation(turn.inverse()),
        }
    }
}

fn count(moment: Res<Moment>, mut tally: ResMut<Tally>, mut last: Local<u32>) {
    if moment.started && std::mem::replace(&mut *last, moment.tick) != moment.tick {
        tally.slaps += u32::from(moment.tick % PERIOD == SLAP);
    }
}

/// Sets the arms, and turns the heads of those who were hit.
fn swing(
    moment: Res<Moment>,
    tally: Res<Tally>,
    actors: Query<(&Side, &Role)>,
    parents: Query<&ChildOf>,
    mut joints: Query<(Entity, &Name, &mut Transform), Without<Role>>,
) {
    for (entity, name, mut place) in &mut joints {
        let joint = name.as_str();
        if !["upperarm_r", "lowerarm_l", "lowerarm_r", "head"].contains(&joint) {
            continue;
        }
        let Some((&side, &role)) = parents.iter_ancestors(entity).find_map(|root| actors.get(root).ok()) else {
            continue;
        };
        match (joint, role) {
            ("upperarm_r", Role::Slaps) => {
                place.rotation = COLLARBONE.inverse() * direction(moment.tick) * FORWARD;
            }
            ("head", Role::IsSlapped) => {
                place.rotation = HEAD * Quat::from_rotation_y(-0.6 * tally.pain(side, *moment));
            }
            ("lowerarm_l" | "lowerarm_r", _) => {
                // Straightens the elbow: only the turn about the arm's own axis is left.
                let [_, y, _, w] = place.rotation.to_array();
                place.rotation = Quat::from_xyzw(0.0, y, 0.0, w).normalize();
            }
            _ => {}
        }
    }
}

/// Where the arm points, as a rotation from straight ahead.
fn direction(tick: u32) -> Quat {
    let now = tick % PERIOD;
    let next = SWING
        .iter()
        .position(|&(tick, ..)| tick > now)
        .unwrap_or(SWING.len() - 1);
    let ((from, yaw, pitch), (to, next_yaw, next_pitch)) = (SWING[next.saturating_sub(1)], SWING[next]);
    let share = (now - from) as f32 / (to - from) as f32;
    let [yaw, pitch] = [yaw.lerp(next_yaw, share), pitch.lerp(next_pitch, share)].map(f32::to_radians);
    Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch)
}

/// Sets the faces of those who are slapped: they puff their cheeks, until it hurts.
fn pull_faces(
    moment: Res<Moment>,
    tally: Res<Tally>,
    meshes: Res<Assets<Mesh>>,
    actors: Query<(&Side, &Role)>,
    parents: Query<&ChildOf>,
    mut faces: Query<(Entity, &mut MorphWeights)>,
) {
    for (entity, mut face) in &mut faces {
        let actor = parents.iter_ancestors(entity).find_map(|root| actors.get(root).ok());
        let Some((&side, Role::IsSlapped)) = actor else {
            continue;
        };
        let names = face
            .first_mesh()
            .and_then(|mesh| meshes.get(mesh)?.morph_target_names());
        let Some(names) = names.map(<[String]>::to_vec) else {
            continue;
        };
        let pain = tally.pain(side, *moment);
        let puff = 0.5 - 0.5 * (TAU * moment.tick as f32 / 8.0).cos();
        for (name, weight) in names.iter().zip(face.weights_mut()) {
            *weight = match name.as_str() {
                "cheekPuff" => puff * (1.0 - pain),
                "eyeBlinkLeft" | "eyeBlinkRight" => pain,
                "jawOpen" => 0.6 * pain,
                _ => 0.0,
            };
        }
    }
}

impl Tally {
    /// How much it hurts on a side, from 1 to 0. Nothing is felt in the tick itself.
    fn pain(&self, side: Side, moment: Moment) -> f32 {
        let ticks = self.last[side as usize].map(|felt| moment.tick.saturating_sub(felt.tick));
        match ticks {
            Some(1..) => ticks.map_or(0.0, |ticks| (1.0 - (ticks - 1) as f32 / HURTS).max(0.0)),
            _ => 0.0,
        }
    }
}

/// The result of a run.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Report {
    /// Number of slaps.
    pub slaps: u32,
    /// How many were felt on the left.
    pub felt_discrete: u32,
    /// How many were felt on the right.
    pub felt_continuous: u32,
    /// When the last one hit, as a share of the time between two frames.
    pub share: Option<f64>,
    /// The speed of the hand then, in metres per second.
    pub speed: f32,
}

impl From<&Tally> for Report {
    fn from(tally: &Tally) -> Self {
        let [felt_discrete, felt_continuous] = tally.felt;
        let [_, last] = tally.last;
        Self {
            slaps: tally.slaps,
            felt_discrete,
            felt_continuous,
            share: last.and_then(|felt| felt.share),
            speed: last.map_or(0.0, |felt| felt.speed),
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} slaps, at {} frames a second",
            self.slaps,
            1.0 / TICK.as_secs_f32()
        )?;
        writeln!(f, "  discrete      felt {}", self.felt_discrete)?;
        write!(f, "  continuous    felt {}", self.felt_continuous)?;
        match self.share {
            Some(share) => write!(
                f,
                "; the last after {:.1} % of a frame, at {:.1} m/s",
                100.0 * share,
                self.speed
            ),
            None => Ok(()),
        }
    }
}
