//! A scene for any model.

use std::f64::consts::TAU;

use glam::{Affine3A, DQuat, DVec3};
use morph_collision::Aabb;

use super::Experiment;
use crate::mesh::MorphMesh;

/// Steps of the script.
const STEPS: usize = 400;

/// Between neighbours, in sizes of the mesh at rest: they reach into each other, and come a little apart at times.
const SPACING: f64 = 0.8;
const SWAY: f64 = 0.15;

impl Experiment {
    /// Bodies of a mesh that stand close together in rows, sway into each other and turn a little, for 400 steps; every
    /// `every`-th is a frame.
    ///
    /// Weights are those of the mesh's first clip of the right length, twice through, each body at another point of it. Without one,
    /// a smooth wave runs through each target, in 0 to 0.5 and half of the time 0.
    #[must_use]
    pub fn of_model(name: String, mesh: MorphMesh, bodies: usize, every: usize) -> Self {
        let bounds = Aabb::from_points(mesh.positions.iter().copied());
        let (size, middle) = (bounds.size().as_dvec3(), bounds.center());
        let columns = (bodies as f64).sqrt().ceil().max(1.0) as usize;
        let title = format!("{name}, {bodies} x {} triangles", mesh.triangles.len());
        let weights = script_of(&mesh);
        Self::scripted(name, title, mesh, bodies, (STEPS, every), |step| {
            let t = step as f64 / STEPS as f64;
            let body = |index: usize| {
                let own = index as f64 / bodies as f64;
                let sway = |cycles: f64, phase: f64| SWAY * (TAU * (cycles * t + own + phase)).sin();
                let (row, column) = ((index / columns) as f64, (index % columns) as f64);
                let cell = DVec3::new(
                    SPACING * column + sway(2.0, 0.0),
                    SPACING * row + sway(3.0, 0.3),
                    0.5 * sway(1.0, 0.6),
                );
                let turn = DQuat::from_rotation_y(0.4 * (TAU * (t + own)).sin());
                let place = Affine3A::from_rotation_translation(turn.as_quat(), (cell * size).as_vec3());
                (weights(t, own), place * Affine3A::from_translation(-middle))
            };
            (0..bodies).map(body).collect()
        })
    }
}

/// Weights at a share of the script, of a body at a share of the way around.
fn script_of(mesh: &MorphMesh) -> Box<dyn Fn(f64, f64) -> Vec<f32>> {
    let targets = mesh.targets.len();
    let fits = |weights: &Vec<f32>| weights.len() == targets;
    let clip = mesh
        .animations
        .iter()
        .find(|clip| !clip.weights.is_empty() && clip.weights.iter().all(fits));
    match clip.cloned() {
        Some(clip) => Box::new(move |t, own| clip.sample(((2.0 * t + own) * f64::from(clip.duration())) as f32)),
        None => Box::new(move |t, own| {
            let wave = |k: usize| (TAU * (t * (1 + k % 3) as f64 + own + 0.37 * k as f64)).sin();
            (0..targets).map(|k| (0.5 * wave(k)).max(0.0) as f32).collect()
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::{dolphin, rigid};

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
}
