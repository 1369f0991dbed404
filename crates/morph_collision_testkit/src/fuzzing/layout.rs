use std::sync::{Arc, LazyLock};

use glam::{Affine3A, Vec3};
use morph_collision::{
    Body, BuildOptions, MorphBvh, MorphModel, PairQuery, Pose, SelfQuery, TreeFile, TreeLayout, WorldFromModel,
};
use serde_json::Value;

use super::pairs::{sorted, truth};
use crate::verify::check_containment;
use morph_collision_models::generated::{degenerate, random};
use morph_collision_models::mesh::MorphMesh;

/// The meshes for which layouts are read.
static MESHES: LazyLock<[(MorphMesh, Arc<MorphModel>); 4]> = LazyLock::new(|| {
    let one = MorphMesh::rigid("one", vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    let meshes = [
        one,
        random::triangle_soup(3, 12, 2),
        degenerate::all_equal(5),
        random::random_blob(4, 0, 3, 0.3),
    ];
    meshes.map(|mesh| {
        let model = mesh.to_model().expect("generated meshes are valid");
        (mesh, Arc::new(model))
    })
});

/// Reads one byte that selects a mesh, then a tree's layout as JSON. The layout must be refused, or give a tree
/// with correct answers.
///
/// If the byte's upper bit is not set, version, fingerprint and checksum are corrected first, so that the remaining checks
/// are reached.
///
/// # Panics
/// If a restored tree answers wrongly.
pub fn layout(data: &[u8]) {
    let Some((&first, json)) = data.split_first() else {
        return;
    };
    let (mesh, model) = &MESHES[usize::from(first & 3)];
    let Ok(mut value) = serde_json::from_slice::<Value>(json) else {
        return;
    };
    let is_whole = first & 128 != 0;
    if !is_whole {
        correct(model, &mut value);
    }
    if let Ok(mut layout) = serde_json::from_value::<TreeLayout>(value) {
        if !is_whole {
            layout.correct_certificates();
        }
        check(mesh, model, &layout);
    }
}

/// Reads one byte that selects a mesh, then what follows the header of a [`TreeFile`]. Each tree in it must be refused, or give correct
/// answers.
///
/// If the byte's upper bit is set, the header is among the bytes, too. Otherwise it is added, with the right checksum, and version,
/// fingerprint and checksum of the trees are corrected.
///
/// # Panics
/// If a restored tree answers wrongly.
pub fn tree_file(data: &[u8]) {
    let Some((&first, rest)) = data.split_first() else {
        return;
    };
    let (mesh, model) = &MESHES[usize::from(first & 3)];
    let is_whole = first & 128 != 0;
    let file = if is_whole {
        TreeFile::from_bytes(rest)
    } else {
        TreeFile::from_bytes(&TreeFile::forged(rest))
    };
    for saved in file.map_or(Vec::new(), |file| file.trees) {
        let mut value = serde_json::to_value(&saved.layout).expect("a layout is serialisable");
        if !is_whole {
            correct(model, &mut value);
        }
        // JSON has no NaN and no infinite numbers.
        let Ok(mut layout) = serde_json::from_value::<TreeLayout>(value) else {
            let refused = MorphBvh::from_layout(model.clone(), &saved.layout).is_err();
            assert!(refused, "a layout that JSON cannot hold is accepted");
            continue;
        };
        if !is_whole {
            layout.correct_certificates();
        }
        check(mesh, model, &layout);
    }
}

/// Corrects version and fingerprint, so that the remaining checks are reached.
fn correct(model: &Arc<MorphModel>, layout: &mut Value) {
    if let Value::Object(fields) = layout {
        let right = MorphBvh::build(model.clone(), &BuildOptions::default()).layout();
        let right = serde_json::to_value(right).expect("a layout is serialisable");
        for name in ["version", "fingerprint"] {
            fields.insert(name.to_owned(), right[name].clone());
        }
    }
}

/// The layout must be refused, or give a tree with correct answers.
fn check(mesh: &MorphMesh, model: &Arc<MorphModel>, layout: &TreeLayout) {
    let bvh = match MorphBvh::from_layout(model.clone(), layout) {
        Ok(bvh) => Arc::new(bvh),
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    assert_eq!(&bvh.layout(), layout, "a tree has the layout it was restored from");
    let mut poses = [Pose::new(bvh.clone()), Pose::new(bvh.clone())];
    let mut plain = Pose::new(Arc::new(MorphBvh::build(model.clone(), &BuildOptions::default())));
    for (i, pose) in poses.iter_mut().enumerate() {
        let weights: Vec<f32> = (0..pose.weights().len())
            .map(|k| 0.6 * k as f32 - 0.4 * i as f32)
            .collect();
        pose.set_weights(&weights).expect("the weights are small");
        let report = check_containment(mesh, pose);
        assert_eq!(report.first, None, "a vertex outside its box");
        plain.set_weights(&weights).expect("the weights are small");
        let [found, all] = [&mut *pose, &mut plain].map(|pose| {
            let mut found = Vec::new();
            SelfQuery::new().all(pose, &mut found);
            sorted(&found)
        });
        if bvh.certificates().is_some() {
            // Certificates are believed if their checksum is right, so forged ones may leave pairs out.
            assert!(
                found.iter().all(|pair| all.binary_search(pair).is_ok()),
                "a pair that does not touch"
            );
        } else {
            assert_eq!(found, all);
        }
    }
    let places = [
        Affine3A::IDENTITY,
        Affine3A::from_translation(Vec3::new(0.125, 0.25, 0.0)),
    ];
    let truth = truth([mesh, mesh], &poses, [&places[0], &places[1]]);
    let [world_from_a, world_from_b] = places.map(|place| WorldFromModel::new(place).expect("the place is finite"));
    let [a, b] = &mut poses;
    let mut found = Vec::new();
    PairQuery::new().all(Body::new(a, &world_from_a), Body::new(b, &world_from_b), &mut found);
    assert_eq!(sorted(&found), truth);
}
