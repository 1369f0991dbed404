//! The paper's two experiments, every n-th step of them.

use glam::Affine3A;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::models::{dolphin, pass_through_body};
use morph_collision_testkit::scenes::{dolphins, pass_through};

/// A mesh, and what each body of it does in every frame.
pub(crate) struct Experiment {
    pub(crate) name: String,
    pub(crate) meshes: [MorphMesh; 1],
    pub(crate) bodies: usize,
    pub(crate) frames: Vec<Vec<(Vec<f32>, Affine3A)>>,
}

impl Experiment {
    /// The pass-through, and the dolphins at three resolutions.
    pub(crate) fn all(every: usize) -> Vec<Self> {
        let mut all = vec![Self::pass_through(every)];
        all.extend([0, 2, 3].map(|level| Self::dolphins(level, every)));
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
}
