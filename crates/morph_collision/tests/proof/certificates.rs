//! Queries with certificates find what they find without.

use std::sync::Arc;

use glam::Vec3;
use morph_collision::proof::{Effort, ProofOutcome, SelfProof, WeightBox};
use morph_collision::{BuildOptions, InputError, LayoutError, MorphBvh, Pose, QueryStats, SelfQuery, TrianglePair};
use morph_collision_models::generated::random::{random_blob, triangle_soup};
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{draw, prove, thorough, tree, tree_of};

/// One tree with certificates and one without, for the same mesh.
struct Both {
    with: Pose,
    without: Pose,
    query: SelfQuery,
    /// The work of all queries with certificates and of all without.
    work: [QueryStats; 2],
}

impl Both {
    fn new(mesh: &MorphMesh, options: &BuildOptions, weights: &WeightBox, effort: Effort) -> Self {
        let model = Arc::new(mesh.to_model().unwrap());
        let [with, without] = [(); 2].map(|()| Arc::new(MorphBvh::build(model.clone(), options)));
        let proof = SelfProof::new(&with, weights, effort).unwrap();
        let certificates = proof.certificates(&proof.run()).unwrap();
        assert_eq!(with.set_certificates(certificates), Ok(true));
        Self {
            with: Pose::new(with),
            without: Pose::new(without),
            query: SelfQuery::new(),
            work: [QueryStats::default(); 2],
        }
    }

    /// The pairs for some weights, which must be the same, in the same order.
    fn pairs(&mut self, weights: &[f32]) -> Vec<TrianglePair> {
        let [with, without] = [&mut self.with, &mut self.without].map(|pose| {
            pose.set_weights(weights).unwrap();
            let mut pairs = Vec::new();
            self.query.all(pose, &mut pairs);
            (pairs, self.query.stats())
        });
        assert_eq!(with.0, without.0, "{weights:?}");
        self.work[0] += with.1;
        self.work[1] += without.1;
        with.0
    }
}

fn low_effort(steps: u64) -> Effort {
    Effort { steps, ..thorough(1) }
}

#[test]
fn the_same_pairs_are_found_inside_the_box_and_outside() {
    let mut rng = Pcg64Mcg::seed_from_u64(27);
    for seed in 0..6 {
        let targets = 1 + seed as usize % 5;
        let mesh = if seed % 3 == 0 {
            triangle_soup(seed, 120, targets)
        } else {
            random_blob(seed, 3, targets, 0.6)
        };
        let weights = WeightBox::new(&vec![-0.1; targets], &vec![0.7; targets]).unwrap();
        // Leaves with one patch and with several. With few steps, whole subtrees stay open.
        for (leaf_size, steps) in [
            (1, u64::MAX),
            (8, u64::MAX),
            (8, 2000),
            (8, 0),
            (20, u64::MAX),
            (20, 1000),
        ] {
            let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
            let mut both = Both::new(&mesh, &options, &weights, low_effort(steps));
            let mut found = 0;
            for _ in 0..25 {
                found += both.pairs(&draw(&weights, &mut rng)).len();
                let anywhere: Vec<f32> = (0..targets).map(|_| rng.random_range(-1.0..2.0)).collect();
                found += both.pairs(&anywhere).len();
            }
            assert!(found > 0, "seed {seed}");
            let [with, without] = both.work.map(|work| work.triangle_tests + work.node_tests);
            assert!(
                if steps == 0 { with == without } else { with < without },
                "seed {seed}: {with} {without}"
            );
        }
    }
}

#[test]
fn a_face_needs_less_work_with_certificates() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/mh_head_eyes_teeth_arkit52.glb"
    );
    let mesh = &read_meshes(path.as_ref()).unwrap()[0];
    let weights = WeightBox::new(&[0.0; 52], &[0.25; 52]).unwrap();
    let mut both = Both::new(mesh, &BuildOptions::default(), &weights, thorough(1));
    let mut rng = Pcg64Mcg::seed_from_u64(28);
    let found: usize = (0..25).map(|_| both.pairs(&draw(&weights, &mut rng)).len()).sum();
    assert!(found > 10_000, "{found}");
    let [with, without] = both.work;
    assert!(
        3 * with.vertices_blended < 2 * without.vertices_blended,
        "{with:?} {without:?}"
    );
    assert!(3 * with.node_tests < without.node_tests, "{with:?} {without:?}");
}

#[test]
fn certificates_are_of_all_parts_and_of_one_tree() {
    let mesh = random_blob(3, 3, 3, 0.5);
    let bvh = tree_of(&mesh);
    let proof = SelfProof::new(&bvh, &WeightBox::unit(3), thorough(1)).unwrap();
    let mut outcome = ProofOutcome::default();
    for part in 0..proof.parts() {
        assert!(
            matches!(proof.certificates(&outcome), Err(InputError::WrongCount { .. })),
            "{part} parts"
        );
        outcome.join(proof.run_part(part));
    }
    let certificates = proof.certificates(&outcome).unwrap();
    assert_eq!(certificates.weights(), &WeightBox::unit(3));
    outcome.join(proof.run_part(0));
    assert!(proof.certificates(&outcome).is_err(), "a part twice");
    // Of a smaller box, of another tree, and of parts of both.
    let narrow = SelfProof::new(&bvh, &WeightBox::new(&[0.0; 3], &[0.1; 3]).unwrap(), thorough(1)).unwrap();
    let other = SelfProof::new(&tree_of(&random_blob(4, 3, 3, 0.5)), &WeightBox::unit(3), thorough(1)).unwrap();
    let mut mixed = narrow.run_part(0);
    (1..proof.parts()).for_each(|part| mixed.join(proof.run_part(part)));
    for wrong in [narrow.run(), other.run(), mixed] {
        assert!(matches!(
            proof.certificates(&wrong),
            Err(InputError::DifferentTrees { .. })
        ));
    }
    assert!(matches!(
        tree_of(&mesh).set_certificates(certificates.clone()),
        Err(InputError::DifferentTrees { .. })
    ));
    let before = bvh.bytes();
    assert_eq!(bvh.set_certificates(certificates.clone()), Ok(true));
    assert!(bvh.bytes() > before);
    let other = SelfProof::new(&bvh, &WeightBox::new(&[0.0; 3], &[2.0; 3]).unwrap(), thorough(1)).unwrap();
    let other = other.certificates(&other.run()).unwrap();
    assert_eq!(bvh.set_certificates(other), Ok(false));
    let kept = MorphBvh::clone(&bvh).certificates().map(|kept| kept.weights().clone());
    assert_eq!(kept, Some(WeightBox::unit(3)));
}

#[test]
fn a_mesh_that_is_free_needs_no_work() {
    // Two triangles that approach each other, but never touch.
    let base = [
        Vec3::ZERO,
        Vec3::X,
        Vec3::Y,
        Vec3::Z,
        Vec3::Z + Vec3::X,
        Vec3::Z + Vec3::Y,
    ];
    let lower = [
        Vec3::ZERO,
        Vec3::ZERO,
        Vec3::ZERO,
        Vec3::NEG_Z,
        Vec3::NEG_Z,
        Vec3::NEG_Z,
    ];
    let bvh = tree(&base, &[[0, 1, 2], [3, 4, 5]], &[lower.to_vec()]);
    let weights = WeightBox::new(&[0.0], &[0.9]).unwrap();
    let outcome = prove(&bvh, &weights, thorough(1));
    let proof = SelfProof::new(&bvh, &weights, thorough(1)).unwrap();
    bvh.set_certificates(proof.certificates(&outcome).unwrap()).unwrap();
    let (mut pose, mut query) = (Pose::new(bvh), SelfQuery::new());
    pose.set_weights(&[0.9]).unwrap();
    assert!(!query.any(&mut pose));
    assert_eq!(query.stats(), QueryStats::default());
    // Beyond the box, the certificates do not hold.
    pose.set_weights(&[1.0]).unwrap();
    assert!(query.any(&mut pose));
}

#[test]
fn certificates_are_stored_with_the_tree() {
    let mesh = random_blob(3, 3, 3, 0.8);
    let (model, weights) = (Arc::new(mesh.to_model().unwrap()), WeightBox::unit(3));
    let bvh = Arc::new(MorphBvh::build(model.clone(), &BuildOptions::default()));
    let plain = serde_json::to_value(bvh.layout()).unwrap();
    assert!(plain["certificates"].is_null());
    let proof = SelfProof::new(&bvh, &weights, thorough(1)).unwrap();
    bvh.set_certificates(proof.certificates(&proof.run()).unwrap()).unwrap();
    let json = serde_json::to_value(bvh.layout()).unwrap();
    let restored = MorphBvh::from_layout(model.clone(), &serde_json::from_value(json.clone()).unwrap()).unwrap();
    assert_eq!(restored.layout(), bvh.layout());
    let mut rng = Pcg64Mcg::seed_from_u64(29);
    let mut poses = [Pose::new(bvh), Pose::new(Arc::new(restored))];
    let mut query = SelfQuery::new();
    let mut found = 0;
    for _ in 0..20 {
        let drawn = draw(&weights, &mut rng);
        let [one, other] = poses.each_mut().map(|pose| {
            pose.set_weights(&drawn).unwrap();
            let mut pairs = Vec::new();
            query.all(pose, &mut pairs);
            (pairs, query.stats())
        });
        assert_eq!(one, other);
        found += one.0.len();
    }
    assert!(found > 0);
    // Any number that is changed is noticed.
    let mut seen = 0;
    for list in ["low", "high", "neighbours", "apart"] {
        for place in 0..json["certificates"][list].as_array().unwrap().len().min(20) {
            let mut broken = json.clone();
            let number = &mut broken["certificates"][list][place];
            if let Some(numbers) = number.as_array_mut() {
                let entry = seen % numbers.len();
                let changed = numbers[entry].as_u64().unwrap() ^ 1;
                numbers[entry] = changed.into();
            } else {
                *number = 0.125.into();
            }
            let error = MorphBvh::from_layout(model.clone(), &serde_json::from_value(broken).unwrap()).unwrap_err();
            assert!(matches!(error, LayoutError::Certificates { .. }), "{error}");
            seen += 1;
        }
    }
    assert!(seen > 30, "{seen}");
    let mut shorter = json.clone();
    shorter["certificates"]["neighbours"].as_array_mut().unwrap().pop();
    let mut other = json;
    other["certificates"]["is_complete"] = false.into();
    for broken in [shorter, other] {
        assert!(MorphBvh::from_layout(model.clone(), &serde_json::from_value(broken).unwrap()).is_err());
    }
}

#[test]
fn a_vertex_of_very_many_leaves_is_no_problem() {
    // A fan around a vertex, and a blade that the target pushes through it.
    let rim = (0..2000).map(|i| Vec3::new((i as f32 * 0.003).cos(), (i as f32 * 0.003).sin(), 0.0));
    let mut positions: Vec<Vec3> = std::iter::once(Vec3::ZERO).chain(rim).collect();
    let mut triangles: Vec<[u32; 3]> = (1..2000).map(|i| [0, i, i + 1]).collect();
    let first = positions.len() as u32;
    positions.extend([
        Vec3::new(0.3, -0.5, 0.5),
        Vec3::new(0.3, 0.5, 0.5),
        Vec3::new(0.4, 0.0, 1.0),
    ]);
    triangles.push([first, first + 1, first + 2]);
    let mut mesh = MorphMesh::rigid("fan", positions.clone(), triangles);
    mesh.targets = vec![
        positions
            .iter()
            .map(|p| if p.z > 0.0 { Vec3::NEG_Z } else { Vec3::ZERO })
            .collect(),
    ];
    mesh.target_names = vec!["down".into()];
    let mut both = Both::new(&mesh, &BuildOptions::default(), &WeightBox::unit(1), thorough(1));
    let found: usize = [0.0, 0.4, 0.5, 0.8, 1.0]
        .iter()
        .map(|&weight| both.pairs(&[weight]).len())
        .sum();
    assert!(found > 100, "{found}");
}
