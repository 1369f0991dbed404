//! Nothing that is proved free touches, and nothing is found that does not.

use morph_collision::proof::{SelfProof, WeightBox};
use morph_collision_models::generated::dolphin;
use morph_collision_models::generated::random::{random_blob, triangle_soup};
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{draw, open_pairs, prove, thorough, touching, tree_of};

/// Compares a proof with queries. Returns how many pairs are free and how many were found to touch.
fn compare(mesh: &MorphMesh, weights: &WeightBox, boxes_per_pair: u32, poses: u64, seed: u64) -> [u64; 2] {
    let bvh = tree_of(mesh);
    let outcome = prove(&bvh, weights, thorough(boxes_per_pair));
    let open = open_pairs(&outcome);
    for witness in &outcome.witnesses {
        assert!(weights.contains(&witness.weights), "{witness:?}");
        assert!(
            touching(&bvh, &witness.weights).contains(&witness.triangles),
            "{witness:?}"
        );
    }
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut found = 0;
    for _ in 0..poses {
        let drawn = draw(weights, &mut rng);
        for pair in touching(&bvh, &drawn) {
            assert!(
                open.contains(&pair),
                "{}: {pair:?} touches at {drawn:?} but is proved free",
                mesh.name
            );
            found += 1;
        }
    }
    assert_eq!(outcome.pairs(), unrelated_pairs(mesh), "every pair is counted once");
    [outcome.free(), found]
}

/// The number of pairs of triangles that share no vertex, by brute force.
fn unrelated_pairs(mesh: &MorphMesh) -> u64 {
    let model = mesh.to_model().unwrap();
    let corners: Vec<[u32; 3]> = (0..model.triangle_count() as u32)
        .map(|t| model.triangle(t).unwrap())
        .collect();
    let apart = |a: &[u32; 3], b: &[u32; 3]| !a.iter().any(|corner| b.contains(corner));
    let of_triangle = |(i, a): (usize, &[u32; 3])| corners[..i].iter().filter(|b| apart(a, b)).count() as u64;
    corners.iter().enumerate().map(of_triangle).sum()
}

#[test]
fn generated_meshes_do_not_contradict_their_proofs() {
    let mut rng = Pcg64Mcg::seed_from_u64(26);
    for seed in 0..12 {
        let targets = 1 + seed as usize % 5;
        let mesh = if seed % 3 == 0 {
            triangle_soup(seed, 60, targets)
        } else {
            random_blob(seed, 2, targets, 0.6)
        };
        let ends = |rng: &mut Pcg64Mcg| [rng.random_range(-1.0..0.2), rng.random_range(0.2..1.5_f32)];
        let (low, high): (Vec<f32>, Vec<f32>) = (0..targets).map(|_| ends(&mut rng).into()).unzip();
        for weights in [WeightBox::unit(targets), WeightBox::new(&low, &high).unwrap()] {
            for boxes in [1, 20] {
                let [free, found] = compare(&mesh, &weights, boxes, 60, seed);
                assert!(
                    free > 0 && (seed % 3 != 0 || found > 0),
                    "seed {seed}: {free} free, {found} found"
                );
            }
        }
    }
}

#[test]
fn a_dolphin_does_not_contradict_its_proof() {
    let mesh = dolphin(0);
    let [free, found] = compare(&mesh, &WeightBox::unit(2), 16, 40, 1);
    assert!(free > 100_000 && found > 0, "{free} {found}");
}

#[test]
fn a_face_does_not_contradict_its_proof() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/mh_head_eyes_teeth_arkit52.glb"
    );
    let mesh = &read_meshes(path.as_ref()).unwrap()[0];
    // A part of the box, and few boxes per pair, to save time.
    let weights = WeightBox::new(&[0.0; 52], &[0.1; 52]).unwrap();
    let [free, found] = compare(mesh, &weights, 2, 25, 1);
    assert!(free > 40_000_000 && found > 10_000, "{free} {found}");
}

#[test]
fn parts_may_run_in_any_order() {
    let bvh = tree_of(&random_blob(3, 3, 3, 0.5));
    let proof = SelfProof::new(&bvh, &WeightBox::unit(3), thorough(4)).unwrap();
    assert!(proof.parts() > 100);
    let whole = proof.run();
    let mut backwards = morph_collision::proof::ProofOutcome::default();
    for part in (0..proof.parts()).rev() {
        backwards.join(proof.run_part(part));
    }
    assert_eq!(open_pairs(&whole), open_pairs(&backwards));
    assert_eq!([whole.free(), whole.box_tests], [backwards.free(), backwards.box_tests]);
    assert_eq!(proof.run_part(proof.parts()).pairs(), 0, "there is no such part");
}
