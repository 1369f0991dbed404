use std::sync::Arc;

use morph_collision_testkit::models::{degenerate, dolphin, random};

use super::*;
use crate::model::MorphModel;

fn model_of(mesh: &morph_collision_testkit::mesh::MorphMesh) -> Arc<MorphModel> {
    Arc::new(MorphModel::from_displacements(&mesh.positions, &mesh.triangles, &mesh.targets).unwrap())
}

fn every_option() -> Vec<BuildOptions> {
    let leaf_size = |size| BuildOptions::default().with_leaf_size(size);
    [1, 2, 8, 9, 255].map(leaf_size).to_vec()
}

#[test]
fn every_tree_is_valid_and_has_the_leaf_size_asked_for() {
    let meshes = [
        dolphin(0),
        random::triangle_soup(3, 300, 2),
        degenerate::all_equal(500),
        degenerate::slivers(5, 64),
    ];
    for mesh in &meshes {
        let model = model_of(mesh);
        for options in every_option() {
            let bvh = MorphBvh::build(model.clone(), &options).unwrap();
            assert_eq!(bvh.validate(), Ok(()), "{} with {options:?}", mesh.name);
            let stats = bvh.stats();
            assert!(stats.mean_leaf_triangles <= options.leaf_size as f64);
        }
    }
}

#[test]
fn a_leaf_size_out_of_range_is_refused() {
    let model = model_of(&dolphin(0));
    let error = |options: BuildOptions| MorphBvh::build(model.clone(), &options).unwrap_err();
    for leaf_size in [0, 256] {
        let options = BuildOptions::default().with_leaf_size(leaf_size);
        assert_eq!(error(options), BuildError::LeafSize(leaf_size));
    }
}

#[test]
fn a_tree_restored_from_its_layout_is_the_same_tree() {
    let model = model_of(&dolphin(0));
    for options in every_option() {
        let bvh = MorphBvh::build(model.clone(), &options).unwrap();
        let restored = MorphBvh::from_layout(model.clone(), &bvh.layout()).unwrap();
        assert_eq!(restored.layout(), bvh.layout());
        assert_eq!(restored.stats(), bvh.stats());
        assert_eq!(restored.validate(), Ok(()));
    }
}

#[test]
fn a_layout_of_another_mesh_is_refused() {
    let (small, large) = (model_of(&dolphin(0)), model_of(&dolphin(1)));
    let layout = MorphBvh::build(small, &BuildOptions::default()).unwrap().layout();
    assert!(matches!(
        MorphBvh::from_layout(large, &layout),
        Err(LayoutError::OtherMesh { .. })
    ));
}

#[cfg(feature = "serde")]
#[test]
fn corrupt_layouts_are_errors_or_valid_trees() {
    let model = model_of(&random::triangle_soup(9, 40, 2));
    let layout = MorphBvh::build(model.clone(), &BuildOptions::default())
        .unwrap()
        .layout();
    let json = serde_json::to_value(&layout).unwrap();
    let (mut refused, mut accepted) = (0, 0);
    for field in ["nodes", "triangles"] {
        for place in 0..json[field].as_array().unwrap().len() {
            for value in [0, 1, 2, 9, 41, u32::MAX] {
                let mut broken = json.clone();
                broken[field][place] = value.into();
                match MorphBvh::from_layout(model.clone(), &serde_json::from_value(broken).unwrap()) {
                    Ok(bvh) => {
                        assert_eq!(bvh.validate(), Ok(()));
                        accepted += 1;
                    }
                    Err(_) => refused += 1,
                }
            }
        }
    }
    assert!(refused > accepted, "{refused} refused, {accepted} accepted");
    let mut newer = json;
    newer["version"] = 3.into();
    assert_eq!(
        MorphBvh::from_layout(model, &serde_json::from_value(newer).unwrap()).unwrap_err(),
        LayoutError::Version { found: 3 }
    );
}

#[test]
fn subtrees_hold_every_triangle_once() {
    let model = model_of(&dolphin(1));
    for leaf_size in [1, 8] {
        let bvh = MorphBvh::build(model.clone(), &BuildOptions::default().with_leaf_size(leaf_size)).unwrap();
        for most in [0, 1, 16, 100, usize::MAX] {
            let parts = bvh.subtrees(most);
            let mut all: Vec<u32> = parts.concat();
            all.sort_unstable();
            assert_eq!(all, (0..model.triangle_count() as u32).collect::<Vec<_>>());
            let leaf = bvh.options().leaf_size;
            assert!(
                parts
                    .iter()
                    .all(|part| !part.is_empty() && part.len() <= most.max(leaf))
            );
        }
        assert_eq!(bvh.subtrees(usize::MAX).len(), 1);
        assert_eq!(bvh.subtrees(0).len(), bvh.leaf_count());
    }
}
