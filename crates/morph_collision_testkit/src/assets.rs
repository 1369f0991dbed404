//! Generates the contents of `assets/` at the root of the repository, so that a test can compare them.

use morph_collision_models::generated;
use morph_collision_models::gltf::write::Appearance;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::scenes::{BodyState, Scene, SceneBody, dolphins, pass_through};

/// Blue-grey.
const DOLPHIN: Appearance = Appearance {
    base_color: [0.22, 0.32, 0.42, 1.0],
    roughness: 0.45,
};
/// Moss.
const HILL: Appearance = Appearance {
    base_color: [0.20, 0.33, 0.27, 1.0],
    roughness: 0.8,
};
/// Warm clay.
const BODY: Appearance = Appearance {
    base_color: [0.62, 0.36, 0.22, 1.0],
    roughness: 0.7,
};

/// The models: file name, mesh and appearance; the small ones first.
pub fn models() -> impl Iterator<Item = (String, MorphMesh, Appearance)> {
    let mut dolphins = (0..4).map(|level| (generated::dolphin(level), DOLPHIN));
    let small: Vec<_> = dolphins.by_ref().take(2).collect();
    let hill = std::iter::once_with(|| (generated::heaving_body(), HILL));
    let body = std::iter::once_with(|| (generated::pass_through_body(), BODY));
    small
        .into_iter()
        .chain(hill)
        .chain(dolphins)
        .chain(body)
        .map(|(mesh, appearance)| (format!("{}.glb", mesh.name), mesh, appearance))
}

/// The scenes: file name relative to `assets/`, and content.
pub fn scenes() -> [(&'static str, Scene); 2] {
    [
        ("scenes/two_dolphins.json", two_dolphins()),
        ("scenes/pass_through.json", passing_bodies()),
    ]
}

/// Two neighbours of a small group, every tenth of 400 frames.
fn two_dolphins() -> Scene {
    let frames = (0..dolphins::FRAMES).step_by(10).map(|frame| {
        let state = |index| {
            let place = dolphins::placement(index, 2, frame, dolphins::FRAMES);
            BodyState::rigid(&dolphins::weights(index, frame, dolphins::FRAMES), &place)
        };
        vec![state(0), state(1)]
    });
    Scene {
        bodies: bodies("../dolphin_564.glb"),
        frames: frames.collect(),
        ..Scene::default()
    }
}

/// Every twentieth of the 400 steps.
fn passing_bodies() -> Scene {
    let frames = (0..pass_through::STEPS).step_by(20).map(|step| {
        let weights = pass_through::weights(step, pass_through::STEPS);
        pass_through::placements(step, pass_through::STEPS)
            .map(|place| BodyState::rigid(&weights, &place))
            .to_vec()
    });
    Scene {
        bodies: bodies("../pass_through_20480.glb"),
        frames: frames.collect(),
        ..Scene::default()
    }
}

fn bodies(model: &str) -> Vec<SceneBody> {
    vec![
        SceneBody {
            model: model.into(),
            ..SceneBody::default()
        };
        2
    ]
}
