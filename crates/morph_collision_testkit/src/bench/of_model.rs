//! A scene for any model.

use std::f64::consts::TAU;

use glam::{Affine3A, DQuat, DVec3};

use super::Experiment;
use super::played::{Played, is_playable};
use crate::oracle::BodyPose;
use morph_collision_models::clip::looped;
use morph_collision_models::mesh::{MeshSkin, MorphMesh};

/// Steps of the script.
const STEPS: usize = 400;

/// Distance between neighbours, in sizes of the mesh at rest. They overlap, and sometimes come a little apart.
const SPACING: f64 = 0.8;
const SWAY: f64 = 0.15;

impl Experiment {
    /// Bodies of a mesh that stand close together in rows, sway into each other and turn a little, for 400 steps; every
    /// `every`-th is a frame.
    ///
    /// Weights come from the mesh's first clip of the right length, played twice, with each body at a different time. Without
    /// such a clip, a smooth wave runs through each target, from 0 to 0.5, and is 0 half of the time.
    ///
    /// The joints of a skinned mesh play a clip at 60 steps a second, each body at a different time. It is the first clip that
    /// also moves weights, which then follow it, or else the first clip. Without clips the joints rest. The bodies stand where
    /// their joints put them, not at their placements.
    #[must_use]
    pub fn of_model(name: String, mesh: MorphMesh, bodies: usize, every: usize) -> Self {
        let played = Played::of(&mesh);
        let (min, max) = bounds(&mesh, played.as_ref());
        let (size, middle) = ((max - min), (0.5 * (min + max)).as_vec3());
        let columns = (bodies as f64).sqrt().ceil().max(1.0) as usize;
        let title = format!("{name}, {bodies} x {} triangles", mesh.triangles.len());
        let weights = script_of(&mesh);
        let share = |index: usize| index as f64 / bodies as f64;
        let mut experiment = Self::scripted(name, title, mesh, bodies, (STEPS, every), |step| {
            let t = step as f64 / STEPS as f64;
            let body = |index: usize| {
                let own = share(index);
                let sway = |cycles: f64, phase: f64| SWAY * (TAU * (cycles * t + own + phase)).sin();
                let (row, column) = ((index / columns) as f64, (index % columns) as f64);
                let cell = DVec3::new(
                    SPACING * column + sway(2.0, 0.0),
                    SPACING * row + sway(3.0, 0.3),
                    0.5 * sway(1.0, 0.6),
                );
                let turn = DQuat::from_rotation_y(0.4 * (TAU * (t + own)).sin());
                let place = Affine3A::from_rotation_translation(turn.as_quat(), (cell * size).as_vec3());
                let of_clip = played.as_ref().and_then(|played| played.weights(step, own));
                let weights = of_clip.unwrap_or_else(|| weights(t, own));
                (weights, place * Affine3A::from_translation(-middle))
            };
            (0..bodies).map(body).collect()
        });
        if let Some(played) = played {
            for (frame, &step) in experiment.frames.iter_mut().zip(&experiment.steps) {
                let of_body = |(index, (_, place)): (usize, &mut (Vec<f32>, Affine3A))| {
                    let place = std::mem::replace(place, Affine3A::IDENTITY);
                    let joints = played.joints(step, share(index));
                    joints.into_iter().map(|joint| place * joint).collect()
                };
                experiment
                    .joints
                    .push(frame.iter_mut().enumerate().map(of_body).collect());
            }
        }
        experiment
    }

    /// The memory of the frames of [`Experiment::of_model`], in bytes.
    #[must_use]
    pub fn bytes_of_model(mesh: &MorphMesh, bodies: usize, every: usize) -> u64 {
        let joints = mesh.skin.as_ref().map_or(0, MeshSkin::joint_count);
        let of_body = 128 + size_of::<Affine3A>() * joints + size_of::<f32>() * mesh.targets.len();
        (STEPS.div_ceil(every.max(1)) as u64)
            .saturating_mul(bodies as u64)
            .saturating_mul(of_body as u64)
    }
}

/// The smallest and largest coordinates of the mesh with zero weights, and with its joints at the beginning of their clip.
fn bounds(mesh: &MorphMesh, played: Option<&Played>) -> (DVec3, DVec3) {
    let joints = played.map(|played| played.joints(0, 0.0));
    let pose = BodyPose {
        mesh,
        weights: &vec![0.0; mesh.targets.len()],
        world_from_model: Affine3A::IDENTITY,
        joints: joints.as_deref(),
    };
    let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let world = pose.world_vertices();
    world.into_iter().fold(empty, |(min, max), p| (min.min(p), max.max(p)))
}

/// Weights at a share of the script, for a body at a share of the clip.
fn script_of(mesh: &MorphMesh) -> Box<dyn Fn(f64, f64) -> Vec<f32>> {
    let targets = mesh.targets.len();
    let clip = mesh.animations.iter().find(|clip| is_playable(clip, targets));
    match clip.cloned() {
        Some(clip) => Box::new(move |t, own| {
            let length = clip.duration();
            clip.sample(looped(((2.0 * t + own) * f64::from(length)) as f32, length))
        }),
        None => Box::new(move |t, own| {
            let wave = |k: usize| (TAU * (t * (1 + k % 3) as f64 + own + 0.37 * k as f64)).sin();
            (0..targets).map(|k| (0.5 * wave(k)).max(0.0) as f32).collect()
        }),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec4;

    use super::*;
    use morph_collision_models::clip::WeightAnimation;
    use morph_collision_models::generated::rigs::tube;
    use morph_collision_models::generated::{dolphin, rigid};
    use morph_collision_models::skeleton::{Interpolation, JointChannel, JointClip, Property};

    #[test]
    fn a_clip_gives_the_weights_and_bodies_differ() {
        let experiment = Experiment::of_model("d".to_owned(), dolphin(0), 3, 100);
        assert_eq!(experiment.steps, [0, 100, 200, 300]);
        let frame = &experiment.frames[1];
        assert_eq!(frame.len(), 3);
        assert_ne!(frame[0].0, frame[1].0);
        assert!(frame.iter().all(|(weights, _)| weights.len() == 2));
    }

    #[test]
    fn without_a_clip_weights_stay_small_and_without_targets_there_are_none() {
        let mut mesh = dolphin(0);
        mesh.animations.clear();
        let experiment = Experiment::of_model("d".to_owned(), mesh, 2, 7);
        let all = experiment.frames.iter().flatten().flat_map(|(weights, _)| weights);
        assert!(all.clone().all(|weight| (0.0..=0.5).contains(weight)));
        assert!(all.clone().any(|weight| *weight > 0.4));
        let experiment = Experiment::of_model("g".to_owned(), rigid::grid(1.0, 2), 2, 7);
        assert!(
            experiment
                .frames
                .iter()
                .flatten()
                .all(|(weights, _)| weights.is_empty())
        );
    }

    #[test]
    fn a_skinned_mesh_plays_the_clip_that_moves_joints_and_weights() {
        let mut mesh = tube(1, 3, 2, 2);
        let clip = |name: &str, height: f32| JointClip {
            name: name.to_owned(),
            channels: vec![JointChannel {
                node: 0,
                property: Property::Translation,
                interpolation: Interpolation::Linear,
                times: vec![0.0, 2.0],
                values: vec![Vec4::ZERO, Vec4::Y * height],
            }],
            end: 0.0,
        };
        let skeleton = &mut mesh.skin.as_mut().expect("a tube is skinned").skeleton;
        skeleton.clips = vec![clip("walk", 100.0), clip("both", 8.0)];
        let rest = skeleton.at_rest();
        let weights = |name: &str| WeightAnimation {
            name: name.to_owned(),
            times: vec![0.0, 2.0],
            weights: vec![vec![0.0, 1.0], vec![1.0, 1.0]],
            ..WeightAnimation::default()
        };
        mesh.animations = vec![weights("blink"), weights("both")];
        let experiment = Experiment::of_model("t".to_owned(), mesh.clone(), 2, 60);
        assert_eq!(experiment.joints.len(), experiment.frames.len());
        assert!(
            experiment
                .frames
                .iter()
                .flatten()
                .all(|(_, place)| *place == Affine3A::IDENTITY)
        );
        // A second of two later, the first body is half-way. The second body is half a clip ahead.
        assert_eq!(experiment.frames[1][0].0, [0.5, 1.0]);
        assert_eq!(experiment.frames[0][1].0, [0.5, 1.0]);
        let height = |frame: usize| experiment.joints_of(frame, 0).expect("it is skinned")[0].translation.y;
        let lifted = height(1) - height(0);
        // It also sways, by less than half of the size of a slightly bent tube.
        assert!((lifted - 4.0).abs() < 1.0, "{lifted}");
        let bytes = Experiment::bytes_of_model(&mesh, 2, 60);
        assert!((14 * (3 * 64 + 8)..10_000).contains(&bytes), "{bytes}");

        let skeleton = &mut mesh.skin.as_mut().expect("a tube is skinned").skeleton;
        skeleton.clips.clear();
        let experiment = Experiment::of_model("t".to_owned(), mesh, 2, 60);
        let of_bodies = [0, 1].map(|body| experiment.joints_of(3, body).expect("it is skinned"));
        // About as far apart as bodies without joints: by most of their length of 2.
        let apart = of_bodies[1][0].translation - of_bodies[0][0].translation;
        assert!(apart.x > 1.0 && apart.x < 3.0, "{apart}");
        let joints = of_bodies[1];
        assert!(
            joints.iter().all(|joint| *joint == joints[0] * rest[0]),
            "at rest {joints:?}"
        );
    }
}
