//! Bodies for the tests: generated, degenerate and real ones, with ordinary and unusual transforms.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Mat3, Quat, Vec3};
use morph_collision::{BuildOptions, MorphBvh, Pose, WorldFromModel};
use morph_collision_models::generated::{degenerate, dolphin, random};
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::moments::real_model;
use morph_collision_testkit::oracle;

use crate::reference::Corners;

/// A mesh with weights and a transform.
#[derive(Clone)]
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) mesh: MorphMesh,
    pub(crate) weights: Vec<f32>,
    pub(crate) world_from_model: Affine3A,
}

impl Case {
    pub(crate) fn new(name: &str, mesh: MorphMesh, weights: Vec<f32>, world_from_model: Affine3A) -> Self {
        let name = name.to_owned();
        Self {
            name,
            mesh,
            weights,
            world_from_model,
        }
    }

    /// The triangles in world space, by the oracle's own definition of a vertex.
    pub(crate) fn world_triangles(&self) -> Vec<Corners> {
        let posed = oracle::posed_vertices(&self.mesh.positions, &self.mesh.targets, &self.weights);
        let world = oracle::world_vertices(&posed, &self.world_from_model);
        let corners = |triangle: &[u32; 3]| triangle.map(|v| world[v as usize]);
        self.mesh.triangles.iter().map(corners).collect()
    }

    pub(crate) fn world_from_model(&self) -> WorldFromModel {
        WorldFromModel::new(self.world_from_model).unwrap()
    }

    /// Poses of the mesh in several different trees.
    pub(crate) fn poses(&self) -> Vec<Pose> {
        let model = Arc::new(self.mesh.to_model().unwrap());
        let all = [
            BuildOptions::default(),
            BuildOptions::default().with_leaf_size(1).unwrap(),
            BuildOptions::default().with_leaf_size(20).unwrap(),
        ];
        let pose = |options: &BuildOptions| {
            let mut pose = Pose::new(Arc::new(MorphBvh::build(model.clone(), options)));
            pose.set_weights(&self.weights).unwrap();
            pose
        };
        all.iter().map(pose).collect()
    }
}

/// The lowest and the highest corner of the box around the triangles.
pub(crate) fn box_around(triangles: &[Corners]) -> (DVec3, DVec3) {
    let corners = triangles.iter().flatten();
    corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| {
        (min.min(*p), max.max(*p))
    })
}

/// Unusual transforms: sheared, mirrored, stretched and flattened.
pub(crate) fn odd_places() -> Vec<(&'static str, Affine3A)> {
    let offset = Vec3::new(0.5, 0.25, -0.125);
    let turned = Mat3::from_quat(Quat::from_rotation_x(0.8) * Quat::from_rotation_z(1.9));
    let sheared = turned * Mat3::from_cols(Vec3::X, Vec3::new(0.9, 1.0, 0.0), Vec3::new(0.0, -0.4, 1.0));
    let stretched = |x, y, z| turned * Mat3::from_diagonal(Vec3::new(x, y, z));
    [
        ("at the origin", Mat3::IDENTITY),
        ("turned", turned),
        ("sheared", sheared),
        ("mirrored and stretched", stretched(-3.0, 0.2, 1.0)),
        ("flattened", stretched(1.0, 0.0, 1.0)),
        ("a slanted line", stretched(1.0, 0.0, 0.0)),
        ("a line", Mat3::from_diagonal(Vec3::X)),
        ("a sheet", Mat3::from_diagonal(Vec3::new(1.0, -1.0, 0.0))),
        ("a point", Mat3::ZERO),
        // The part of an axis along another one is much longer than the rest of it.
        (
            "strongly sheared",
            turned * Mat3::from_cols(Vec3::X, Vec3::new(10.0, 3.0, 0.0), Vec3::Z),
        ),
    ]
    .map(|(name, linear)| (name, Affine3A::from_mat3_translation(linear, offset)))
    .to_vec()
}

/// Generated and degenerate bodies with every kind of transform, and with weights of any sign and sum.
pub(crate) fn generated() -> Vec<Case> {
    let mut all = Vec::new();
    for (name, world_from_model) in odd_places() {
        let weights = vec![0.3, -0.2, 0.9, 0.0, 2.5, 0.1];
        let blob = random::random_blob(7, 1, 6, 0.5);
        all.push(Case::new(&format!("blob {name}"), blob, weights, world_from_model));
    }
    let soup = random::triangle_soup(11, 90, 3);
    for weights in [vec![-1.0, -0.5, 0.25], vec![4.0; 3], vec![200.0, -300.0, 3.0]] {
        let world_from_model =
            Affine3A::from_rotation_translation(Quat::from_rotation_y(0.7), Vec3::new(0.0, 4.0, 1.0));
        all.push(Case::new(
            &format!("soup {weights:?}"),
            soup.clone(),
            weights,
            world_from_model,
        ));
    }
    let (_, turned) = odd_places()[1];
    for world_from_model in [Affine3A::IDENTITY, turned] {
        all.push(Case::new("dolphin", dolphin(0), vec![0.7, -0.4], world_from_model));
        for mesh in [
            degenerate::slivers(1, 60),
            degenerate::zero_area(2, 60),
            degenerate::coplanar_sheets(3, 4),
            degenerate::all_equal(20),
        ] {
            all.push(Case::new(&mesh.name.clone(), mesh, vec![0.5], world_from_model));
        }
    }
    all
}

/// Real models with weights of any sign and sum: the head in `assets/`, and others if they are present.
pub(crate) fn real() -> Vec<Case> {
    const HEAD: &str = "mh_head_eyes_teeth_arkit52.glb";
    let names = [
        HEAD,
        "AnimatedMorphCube.gltf",
        "SimpleMorph.gltf",
        "MorphStressTest.gltf",
        "ict_face_skin.glb",
    ];
    let mut all = Vec::new();
    for name in names {
        let Some(path) = real_model(name) else { continue };
        let mesh = read_meshes(&path).unwrap().swap_remove(0);
        let weights = (0..mesh.targets.len()).map(|k| ((3 + 7 * k) % 11) as f32 * 0.2 - 0.6);
        let world_from_model =
            Affine3A::from_rotation_translation(Quat::from_rotation_y(0.4), Vec3::new(0.5, -0.25, 0.0));
        all.push(Case::new(name, mesh.clone(), weights.collect(), world_from_model));
    }
    assert!(all[0].name == HEAD, "the head is in assets/");
    all
}

/// A generator that always gives the same numbers (splitmix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// A random number from 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A random point in the cube from -1 to 1.
    pub(crate) fn point(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| 2.0 * self.unit() - 1.0))
    }

    /// A random point in a box that is enlarged by its own size.
    pub(crate) fn around(&mut self, (min, max): (DVec3, DVec3)) -> DVec3 {
        let size = (max - min).max(DVec3::splat(0.5));
        0.5 * (min + max) + self.point() * size
    }
}

/// The nearest multiple of `step`, a power of two.
pub(crate) fn snap(point: DVec3, step: f64) -> DVec3 {
    (point / step).round() * step
}
