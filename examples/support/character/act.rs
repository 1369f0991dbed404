//! The character's schedule: it crouches and waves on the spot, then walks once around, and repeats.

use std::f32::consts::{FRAC_PI_2, TAU};

use bevy::gltf::Gltf;
use bevy::prelude::*;

use super::{Cast, Character, Moment};

/// How long it stands, in seconds: one `wave_and_crouch`.
const STAND: f32 = 2.0;
/// How long it walks, in seconds: two `walk_and_talk`.
const WALK: f32 = 6.0;
/// The schedule repeats after this many seconds.
pub const PERIOD: f32 = STAND + WALK;
/// Seconds to blend from one clip to the next.
const FADE: f32 = 0.3;
/// The radius of its circle, chosen so that its speed matches the length of its steps.
pub(super) const ROUND: f32 = 1.35;
/// The height of its root above the ground; the root is in its middle.
const ROOT: f32 = 0.84;
/// The model is in decimetres.
const SCALE: f32 = 0.1;

/// Joint rotations that bring the left hand to the face, and the right one out of its way. The clip moves the other joints.
const TO_FACE: [(&str, Quat); 5] = [
    ("head", Quat::from_xyzw(-0.3912, -0.2879, -0.012, 0.874)),
    ("upperarm_l", Quat::from_xyzw(0.7115, -0.6238, -0.3028, 0.1136)),
    ("lowerarm_l", Quat::from_xyzw(0.5387, 0.6808, 0.4946, 0.04)),
    ("hand_l", Quat::from_xyzw(0.5641, -0.3551, -0.2346, 0.7076)),
    ("upperarm_r", Quat::from_xyzw(-0.256, 0.8258, -0.1923, 0.4642)),
];

/// The clips, in the order of their nodes in the graph.
const CLIPS: [&str; 3] = ["wave_and_crouch", "walk_and_talk", "talk"];

/// The time in the schedule, in seconds, and how much it walks, from 0 to 1.
fn phase(seconds: f32) -> (f32, f32) {
    let now = seconds.rem_euclid(PERIOD);
    let stands = smooth(now / FADE) * smooth((STAND - now) / FADE);
    (now, 1.0 - stands)
}

fn smooth(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Where it stands, and which way it faces: the walking direction, or the camera.
pub(super) fn standing(seconds: f32) -> Transform {
    let (now, walks) = phase(seconds);
    let around = TAU * ((now - STAND) / WALK).max(0.0);
    let at = on_round(around);
    Transform::from_xyz(at.x, ROOT, at.z)
        .with_rotation(Quat::from_rotation_y(around + FRAC_PI_2 * walks))
        .with_scale(Vec3::splat(SCALE))
}

/// A point on its circle, at an angle from where it stands.
pub(super) fn on_round(angle: f32) -> Vec3 {
    Vec3::new(ROUND * angle.sin(), 0.0, ROUND * angle.cos())
}

/// A player's nodes of the three clips.
#[derive(Component)]
pub(super) struct Part([AnimationNodeIndex; 3]);

/// Gives the scene's players their clips.
pub(super) fn rehearse(
    cast: Option<Res<Cast>>,
    gltfs: Res<Assets<Gltf>>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    mut players: Query<(Entity, &mut AnimationPlayer), Without<Part>>,
    mut commands: Commands,
) {
    let Some(gltf) = cast.and_then(|cast| gltfs.get(&cast.0)) else {
        return;
    };
    for (entity, mut player) in &mut players {
        let clips = CLIPS.map(|name| gltf.named_animations.get(name).cloned().unwrap_or_default());
        let (graph, nodes) = AnimationGraph::from_clips(clips);
        let [stand, walk, talk] = nodes[..] else { continue };
        let nodes = [stand, walk, talk];
        for node in nodes {
            // Paused because we set the time ourselves in every frame.
            player.play(node).pause();
        }
        let graph = AnimationGraphHandle(graphs.add(graph));
        commands.entity(entity).insert((graph, Part(nodes)));
    }
}

pub(super) fn play(
    moment: Res<Moment>,
    mut root: Single<&mut Transform, With<Character>>,
    mut players: Query<(&mut AnimationPlayer, &Part)>,
) {
    **root = standing(moment.seconds);
    let (now, walks) = phase(moment.seconds);
    let walked = (now - STAND).max(0.0) % (0.5 * WALK);
    for (mut player, Part([stand, walk, talk])) in &mut players {
        let acts = [
            (stand, now.min(STAND), 1.0 - walks),
            (walk, walked, walks),
            (talk, now.min(STAND), 1.0 - walks),
        ];
        for (&node, seconds, weight) in acts {
            if let Some(animation) = player.animation_mut(node) {
                animation.seek_to(seconds).set_weight(weight);
            }
        }
    }
}

/// Moves the left hand to the face while it crouches.
pub(super) fn raise_hand(moment: Res<Moment>, mut joints: Query<(&Name, &mut Transform)>) {
    let now = moment.seconds.rem_euclid(PERIOD);
    let share = smooth((now - 0.3) / 0.4) * smooth((STAND - 0.2 - now) / 0.4);
    if share == 0.0 || !moment.started {
        return;
    }
    for (name, mut place) in &mut joints {
        if let Some((_, turn)) = TO_FACE.iter().find(|(joint, _)| *joint == name.as_str()) {
            place.rotation = place.rotation.slerp(turn.normalize(), share);
        }
    }
}
