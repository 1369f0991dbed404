//! The paper's two experiments, every n-th step of them, and one that its weights do not cover.

use std::f64::consts::TAU;

use glam::{Affine3A, DQuat, DVec3};
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::models::{dolphin, pass_through_body, random::random_blob};
use morph_collision_testkit::scenes::{dolphins, pass_through};

/// A mesh, and what each body of it does in every frame.
pub(crate) struct Experiment {
    pub(crate) name: String,
    pub(crate) meshes: [MorphMesh; 1],
    pub(crate) bodies: usize,
    pub(crate) frames: Vec<Vec<(Vec<f32>, Affine3A)>>,
}

impl Experiment {
    /// The pass-through, the dolphins at three resolutions, and blobs with many targets.
    pub(crate) fn all(every: usize) -> Vec<Self> {
        let mut all = vec![Self::pass_through(every)];
        all.extend([0, 2, 3].map(|level| Self::dolphins(level, every)));
        all.push(Self::blobs(every));
        all
    }

    /// The first 100 steps of the pass-through, of the small and large dolphins, and of two neighbours, one after the other.
    pub(crate) fn consecutive() -> Vec<Self> {
        let mut all = vec![
            Self::pass_through(1),
            Self::dolphins(0, 1),
            Self::dolphins(3, 1),
            Self::neighbours(),
        ];
        for experiment in &mut all {
            experiment.frames.truncate(100);
        }
        all
    }

    fn pass_through(every: usize) -> Self {
        use pass_through::{STEPS, placements, weights};
        let frame = |step| {
            let weights = weights(step, STEPS).to_vec();
            placements(step, STEPS).map(|place| (weights.clone(), place)).to_vec()
        };
        Self {
            name: "Pass-through, 2 x 20480 triangles".to_owned(),
            meshes: [pass_through_body()],
            bodies: 2,
            frames: (0..STEPS).step_by(every).map(frame).collect(),
        }
    }

    fn dolphins(level: u32, every: usize) -> Self {
        use dolphins::{COUNT, FRAMES, placement, weights};
        let mesh = dolphin(level);
        let frame = |frame| {
            let body = |i| (weights(i, frame, FRAMES).to_vec(), placement(i, COUNT, frame, FRAMES));
            (0..COUNT).map(body).collect()
        };
        Self {
            name: format!("Dolphins, {COUNT} x {} triangles", mesh.triangles.len()),
            meshes: [mesh],
            bodies: COUNT,
            frames: (0..FRAMES).step_by(every).map(frame).collect(),
        }
    }

    /// Two bodies that breathe and turn slowly side by side, a little apart though their boxes overlap.
    fn neighbours() -> Self {
        let mesh = pass_through_body();
        let frame = |step: usize| {
            let t = step as f64 / 60.0;
            let body = |side: f64| {
                let breath = (0.03 + 0.02 * (TAU * 0.25 * t + side).sin()) as f32;
                let turned = DQuat::from_rotation_y(0.02 * side * t).as_quat();
                let place = DVec3::splat(0.68 * side).as_vec3();
                (vec![breath, 0.0], Affine3A::from_rotation_translation(turned, place))
            };
            vec![body(-1.0), body(1.0)]
        };
        Self {
            name: format!("Neighbours, 2 x {} triangles", mesh.triangles.len()),
            bodies: 2,
            frames: (0..400).map(frame).collect(),
            meshes: [mesh],
        }
    }

    /// Two bodies that graze each other, with local targets as a face has: most are active, weights have both signs, and
    /// their sum is far beyond 1.
    fn blobs(every: usize) -> Self {
        let mesh = random_blob(7, 5, 40, 0.85);
        let frame = |step: usize| {
            let t = step as f64 / 400.0;
            let body = |side: f64| {
                let wave = |k: usize| (TAU * (t * (1 + k % 3) as f64 + 0.37 * k as f64 + 0.2 * side)).sin();
                let weights = (0..mesh.targets.len()).map(|k| (0.1 + 0.4 * wave(k)) as f32).collect();
                let turned = DQuat::from_rotation_y(side * TAU * 0.25 * t).as_quat();
                let place = DVec3::new(side * (1.15 - 0.5 * t), 0.1 * side, 0.0).as_vec3();
                (weights, Affine3A::from_rotation_translation(turned, place))
            };
            vec![body(-1.0), body(1.0)]
        };
        Self {
            name: format!("Blobs, 2 x {} triangles with 40 targets", mesh.triangles.len()),
            bodies: 2,
            frames: (0..400).step_by(every).map(frame).collect(),
            meshes: [mesh],
        }
    }
}
