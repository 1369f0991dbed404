//! Scenes to judge answers on, and the truth about them.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{Affine3A, Mat3, Quat, Vec3};
use morph_collision::{
    Body, BuildOptions, MorphBvh, MorphModel, PairQuery, PairStats, Pose, TrianglePair, WorldFromModel,
};
use morph_collision_testkit::gltf_read::read_meshes;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::models::{degenerate, dolphin, pass_through_body, random};
use morph_collision_testkit::{oracle, scenes};

/// Bodies in one moment: meshes, and for each body its mesh, weights and place.
pub(crate) struct Scene {
    pub(crate) name: String,
    pub(crate) meshes: Vec<MorphMesh>,
    pub(crate) bodies: Vec<(usize, Vec<f32>, Affine3A)>,
}

impl Scene {
    fn pair(name: &str, mesh: &MorphMesh, bodies: [(Vec<f32>, Affine3A); 2]) -> Self {
        Self {
            name: name.to_owned(),
            meshes: vec![mesh.clone()],
            bodies: bodies.into_iter().map(|(weights, place)| (0, weights, place)).collect(),
        }
    }

    /// All intersecting triangle pairs by brute force: `(body a, body b, triangle a, triangle b)`.
    pub(crate) fn truth(&self) -> Vec<[u32; 4]> {
        let bodies: Vec<_> = self
            .bodies
            .iter()
            .map(|(mesh, weights, place)| oracle::BodyPose {
                mesh: &self.meshes[*mesh],
                weights,
                world_from_model: *place,
            })
            .collect();
        let mut all = Vec::new();
        for pairs in oracle::scene_pairs(&bodies) {
            all.extend(pairs.triangles.iter().map(|&(s, t)| [pairs.body_a, pairs.body_b, s, t]));
        }
        all
    }

    /// The same through trees, and what it took.
    pub(crate) fn answer(&self, options: &BuildOptions) -> (Vec<[u32; 4]>, PairStats) {
        let models: Vec<Arc<MorphModel>> = self.meshes.iter().map(|m| Arc::new(m.to_model().unwrap())).collect();
        let bvhs: Vec<_> = models
            .iter()
            .map(|model| Arc::new(MorphBvh::build(model.clone(), options).unwrap()))
            .collect();
        let (mut poses, places): (Vec<Pose>, Vec<_>) = self
            .bodies
            .iter()
            .map(|(mesh, weights, place)| {
                let mut pose = Pose::new(bvhs[*mesh].clone());
                pose.set_weights(weights).unwrap();
                (pose, WorldFromModel::new(*place).unwrap())
            })
            .unzip();
        let (mut all, mut stats) = (Vec::new(), PairStats::default());
        let mut query = PairQuery::new();
        for a in 0..poses.len() {
            for b in a + 1..poses.len() {
                let [pose_a, pose_b] = poses.get_disjoint_mut([a, b]).unwrap();
                let mut pairs: Vec<TrianglePair> = Vec::new();
                let bodies = (Body::new(pose_a, &places[a]), Body::new(pose_b, &places[b]));
                stats += query.all(bodies.0, bodies.1, &mut pairs);
                all.extend(pairs.iter().map(|p| [a as u32, b as u32, p.triangle_a, p.triangle_b]));
            }
        }
        all.sort_unstable();
        (all, stats)
    }
}

/// Where the shared real models lie, if they are there.
pub(crate) fn shared_model(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/models")).join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: {} is not there", path.display());
    None
}

/// The paper's second experiment at one moment.
pub(crate) fn dolphins(frame: usize) -> Scene {
    use scenes::dolphins::{COUNT, FRAMES, placement, weights};
    Scene {
        name: format!("dolphins, frame {frame}"),
        meshes: vec![dolphin(0)],
        bodies: (0..COUNT)
            .map(|i| {
                (
                    0,
                    weights(i, frame, FRAMES).to_vec(),
                    placement(i, COUNT, frame, FRAMES),
                )
            })
            .collect(),
    }
}

/// The paper's first experiment at one moment.
pub(crate) fn pass_through(step: usize) -> Scene {
    use scenes::pass_through::{STEPS, placements, weights};
    let weights = weights(step, STEPS).to_vec();
    let bodies = placements(step, STEPS).map(|place| (weights.clone(), place));
    Scene::pair(&format!("pass-through, step {step}"), &pass_through_body(), bodies)
}

/// Sheared, mirrored, stretched and flattened places that bring two models of the given radius together.
fn odd_places(radius: f32) -> Vec<(&'static str, Affine3A)> {
    let offset = Vec3::new(0.5, 0.2, -0.1) * radius;
    let turned = Mat3::from_quat(Quat::from_rotation_x(0.8) * Quat::from_rotation_z(1.9));
    let sheared = turned * Mat3::from_cols(Vec3::X, Vec3::new(0.9, 1.0, 0.0), Vec3::new(0.0, -0.4, 1.0));
    vec![
        ("turned", Affine3A::from_mat3_translation(turned, offset)),
        ("sheared", Affine3A::from_mat3_translation(sheared, offset)),
        (
            "mirrored and stretched",
            Affine3A::from_mat3_translation(turned * Mat3::from_diagonal(Vec3::new(-3.0, 0.2, 1.0)), offset),
        ),
        (
            "flattened",
            Affine3A::from_mat3_translation(turned * Mat3::from_diagonal(Vec3::new(1.0, 0.0, 1.0)), offset),
        ),
        (
            "a line",
            Affine3A::from_mat3_translation(turned * Mat3::from_diagonal(Vec3::X), offset),
        ),
        ("a point", Affine3A::from_mat3_translation(Mat3::ZERO, offset)),
    ]
}

/// Generated models in every kind of place and with weights of every kind.
pub(crate) fn generated() -> Vec<Scene> {
    let blob = random::random_blob(7, 2, 6, 0.5);
    let soup = random::triangle_soup(11, 120, 3);
    let mut all = vec![dolphins(60), dolphins(200)];
    for (name, place) in odd_places(1.0) {
        let weights = [vec![0.3, -0.2, 0.9, 0.0, 2.5, 0.1], vec![1.0, 0.0, 0.0, 0.0, 0.0, 0.0]];
        all.push(Scene::pair(
            &format!("blobs, {name}"),
            &blob,
            [(weights[0].clone(), Affine3A::IDENTITY), (weights[1].clone(), place)],
        ));
        all.push(Scene::pair(
            &format!("blobs both {name}"),
            &blob,
            [(weights[0].clone(), place), (weights[1].clone(), place)],
        ));
    }
    for (name, weights) in [
        ("negative", vec![-1.0, -0.5, 0.25]),
        ("sum of 12", vec![4.0; 3]),
        ("far beyond", vec![1e4, -1e4, 3.0]),
    ] {
        all.push(Scene::pair(
            &format!("soup, {name}"),
            &soup,
            [
                (weights.clone(), Affine3A::IDENTITY),
                (vec![0.5, 0.5, 0.0], Affine3A::IDENTITY),
            ],
        ));
    }
    let ill = [
        degenerate::slivers(1, 60),
        degenerate::zero_area(2, 60),
        degenerate::coplanar_sheets(3, 6),
        degenerate::duplicated_vertices(&dolphin(0)),
        degenerate::all_equal(20),
    ];
    for mesh in ill {
        let weights = vec![0.5; mesh.targets.len()];
        let bodies = [(weights.clone(), Affine3A::IDENTITY), (weights, Affine3A::IDENTITY)];
        all.push(Scene::pair(&format!("{} on itself", mesh.name), &mesh, bodies));
    }
    let mut mixed = Scene {
        name: "dolphin, blob and soup".to_owned(),
        meshes: vec![dolphin(0), blob, soup],
        bodies: Vec::new(),
    };
    mixed.bodies = vec![
        (0, vec![0.2, 0.3], Affine3A::from_scale(Vec3::splat(1.5))),
        (1, vec![0.1; 6], Affine3A::from_translation(Vec3::X)),
        (2, vec![0.0; 3], Affine3A::IDENTITY),
    ];
    all.push(mixed);
    all
}

/// Two copies of a mesh from a file, slightly turned and apart, with given weights each.
pub(crate) fn from_file(name: &str, weights: impl Fn(usize, usize) -> f32) -> Option<Scene> {
    let mesh = read_meshes(&shared_model(name)?).unwrap().swap_remove(0);
    let radius = mesh.positions.iter().map(|p| p.length()).fold(0.0, f32::max);
    let targets = mesh.targets.len();
    let place = Affine3A::from_rotation_translation(
        Quat::from_rotation_y(0.4) * Quat::from_rotation_x(0.1),
        Vec3::new(0.35, 0.05, 0.1) * radius,
    );
    let weights = |body| (0..targets).map(|target| weights(body, target)).collect::<Vec<f32>>();
    let bodies = [(weights(0), Affine3A::IDENTITY), (weights(1), place)];
    Some(Scene::pair(name, &mesh, bodies))
}
