//! The paper's two experiments, using every n-th step, and further ones with weights that the paper does not cover.

use std::f64::consts::TAU;

use glam::{Affine3A, DQuat, DVec3};

use crate::rivals::{CastRay, Method, PoseError};
use morph_collision_models::generated::{dolphin, pass_through_body_at, random::random_blob};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::scenes::{dolphins, pass_through};

/// The weights and the placement of every body in a step.
pub type Frame = Vec<(Vec<f32>, Affine3A)>;

/// A mesh, and the poses of its bodies in every frame.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// A short name for command lines.
    pub name: String,
    /// A heading.
    pub title: String,
    /// The mesh of all bodies.
    pub mesh: MorphMesh,
    /// Number of bodies.
    pub bodies: usize,
    /// The frames.
    pub frames: Vec<Frame>,
    /// For a skinned mesh, the joint matrices of each body in each frame, in world space; empty for others.
    pub joints: Vec<Vec<Vec<Affine3A>>>,
    /// The rays cast at each body in each frame. If there are any, bodies are not queried for pairs. Otherwise empty.
    pub rays: Vec<Vec<CastRay>>,
    /// The step of the script for each frame.
    pub steps: Vec<usize>,
}

/// The names of the experiments of [`Experiment::paper`].
const PAPER: [&str; 4] = ["pass-through-20480", "dolphins-564", "dolphins-9024", "dolphins-36096"];

impl Experiment {
    /// The pass-through, and the dolphins at three resolutions. Uses every `every`-th step, at least 1.
    #[must_use]
    pub fn paper(every: usize) -> Vec<Self> {
        PAPER
            .into_iter()
            .filter_map(|name| Self::generated(name, every))
            .collect()
    }

    /// One with generated bodies, by name.
    #[must_use]
    pub fn generated(name: &str, every: usize) -> Option<Self> {
        match name {
            "blobs" => Some(Self::blobs(every)),
            "pass-through-5120" => Some(Self::pass_through(4, every)),
            "pass-through-20480" => Some(Self::pass_through(5, every)),
            "dolphins-564" => Some(Self::dolphins(0, every)),
            "dolphins-2256" => Some(Self::dolphins(1, every)),
            "dolphins-9024" => Some(Self::dolphins(2, every)),
            "dolphins-36096" => Some(Self::dolphins(3, every)),
            _ => None,
        }
    }

    /// The names of the experiments of [`Experiment::paper`].
    #[must_use]
    pub fn paper_names() -> &'static [&'static str] {
        &PAPER
    }

    /// The paper's experiments and the blobs, for comparing options.
    #[must_use]
    pub fn tuning(every: usize) -> Vec<Self> {
        let mut all = Self::paper(every);
        all.push(Self::blobs(every));
        all
    }

    /// The first `steps` consecutive steps of the pass-through, of the small and large dolphins, and of two neighbours. There are
    /// `rate` frames for every two steps: with the paper's 60 steps a second, 1 is 30 frames a second and 8 is 240.
    #[must_use]
    pub fn consecutive(steps: usize, rate: usize) -> Vec<Self> {
        let mut all = vec![
            Self::pass_through_in(5, pass_through::STEPS * rate / 2, 1),
            Self::dolphins_in(dolphins::COUNT, 0, dolphins::FRAMES * rate / 2, 1),
            Self::dolphins_in(dolphins::COUNT, 3, dolphins::FRAMES * rate / 2, 1),
            Self::neighbours(rate),
        ];
        for experiment in &mut all {
            experiment.frames.truncate(steps * rate / 2);
            experiment.steps.truncate(steps * rate / 2);
            experiment.title += &format!(", {} frames a second", 30 * rate);
        }
        all
    }

    /// Frames from the steps of a script.
    pub(super) fn scripted(
        name: String,
        title: String,
        mesh: MorphMesh,
        bodies: usize,
        (steps, every): (usize, usize),
        frame: impl Fn(usize) -> Frame,
    ) -> Self {
        let steps: Vec<usize> = (0..steps).step_by(every.max(1)).collect();
        Self {
            name,
            title,
            mesh,
            bodies,
            frames: steps.iter().map(|&step| frame(step)).collect(),
            joints: Vec::new(),
            rays: Vec::new(),
            steps,
        }
    }

    /// The matrices of a body's joints in a frame, if its mesh is skinned.
    #[must_use]
    pub fn joints_of(&self, frame: usize, body: usize) -> Option<&[Affine3A]> {
        Some(self.joints.get(frame)?.get(body)?)
    }

    /// Sets the joints, weights and placements of all bodies of a method for a frame.
    ///
    /// # Errors
    /// See [`Method::set_joints`] and [`Method::set_body`].
    pub fn set_bodies(&self, method: &mut dyn Method, frame: usize) -> Result<(), PoseError> {
        for (body, (weights, place)) in self.frames[frame].iter().enumerate() {
            if let Some(joints) = self.joints_of(frame, body) {
                method.set_joints(body, joints)?;
            }
            method.set_body(body, weights, place)?;
        }
        Ok(())
    }

    /// The paper's first experiment with bodies of `20 * 4^level` triangles; the paper's level is 5.
    #[must_use]
    pub fn pass_through(level: u32, every: usize) -> Self {
        Self::pass_through_in(level, pass_through::STEPS, every)
    }

    fn pass_through_in(level: u32, steps: usize, every: usize) -> Self {
        use pass_through::{placements, weights};
        let mesh = pass_through_body_at(level);
        let triangles = mesh.triangles.len();
        let (name, title) = (
            format!("pass-through-{triangles}"),
            format!("Pass-through, 2 x {triangles} triangles"),
        );
        Self::scripted(name, title, mesh, 2, (steps, every), |step| {
            let weights = weights(step, steps).to_vec();
            placements(step, steps).map(|place| (weights.clone(), place)).to_vec()
        })
    }

    /// The paper's second experiment with bodies of `564 * 4^level` triangles.
    #[must_use]
    pub fn dolphins(level: u32, every: usize) -> Self {
        Self::many_dolphins(dolphins::COUNT, level, every)
    }

    /// The same with any number of dolphins, at the same distances.
    #[must_use]
    pub fn many_dolphins(count: usize, level: u32, every: usize) -> Self {
        Self::dolphins_in(count, level, dolphins::FRAMES, every)
    }

    fn dolphins_in(count: usize, level: u32, frames: usize, every: usize) -> Self {
        use dolphins::{placement, weights};
        let mesh = dolphin(level);
        let triangles = mesh.triangles.len();
        let (name, title) = (
            format!("dolphins-{triangles}"),
            format!("Dolphins, {count} x {triangles} triangles"),
        );
        Self::scripted(name, title, mesh, count, (frames, every), |frame| {
            let body = |i| (weights(i, frame, frames).to_vec(), placement(i, count, frame, frames));
            (0..count).map(body).collect()
        })
    }

    /// Two bodies that breathe and turn slowly side by side, a little apart although their boxes overlap; `30 * rate` frames a
    /// second.
    #[must_use]
    pub fn neighbours(rate: usize) -> Self {
        let mesh = pass_through_body_at(5);
        let title = format!("Neighbours, 2 x {} triangles", mesh.triangles.len());
        Self::scripted("neighbours".to_owned(), title, mesh, 2, (200 * rate, 1), |step| {
            let t = step as f64 / (30 * rate) as f64;
            let body = |side: f64| {
                let breath = (0.03 + 0.02 * (TAU * 0.25 * t + side).sin()) as f32;
                let turned = DQuat::from_rotation_y(0.02 * side * t).as_quat();
                let place = DVec3::splat(0.68 * side).as_vec3();
                (vec![breath, 0.0], Affine3A::from_rotation_translation(turned, place))
            };
            vec![body(-1.0), body(1.0)]
        })
    }

    /// Two bodies that graze each other, with local targets like those of a face. Most targets are active, weights have both
    /// signs, and their sum is far beyond 1.
    #[must_use]
    pub fn blobs(every: usize) -> Self {
        let mesh = random_blob(7, 5, 40, 0.85);
        Self::grazing("blobs", mesh, 1.0, every)
    }

    /// The blobs' motion for two bodies of any mesh of radius about 1. Weights are `share` times those of the blobs.
    #[must_use]
    pub fn grazing(name: &str, mesh: MorphMesh, share: f64, every: usize) -> Self {
        let targets = mesh.targets.len();
        let title = format!("Blobs, 2 x {} triangles with {targets} targets", mesh.triangles.len());
        Self::scripted(name.to_owned(), title, mesh, 2, (400, every), |step| {
            let t = step as f64 / 400.0;
            let body = |side: f64| {
                let wave = |k: usize| (TAU * (t * (1 + k % 3) as f64 + 0.37 * k as f64 + 0.2 * side)).sin();
                let weights = (0..targets).map(|k| (share * (0.1 + 0.4 * wave(k))) as f32).collect();
                let turned = DQuat::from_rotation_y(side * TAU * 0.25 * t).as_quat();
                let place = DVec3::new(side * (1.15 - 0.5 * t), 0.1 * side, 0.0).as_vec3();
                (weights, Affine3A::from_rotation_translation(turned, place))
            };
            vec![body(-1.0), body(1.0)]
        })
    }
}
