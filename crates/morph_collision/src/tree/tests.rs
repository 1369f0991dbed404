//! Tests of what a tree tells of itself, and of layouts.

use std::sync::Arc;

use morph_collision_models::generated::{degenerate, dolphin, random};

use super::build::MAX_DEPTH;
use super::validate_tests::validate;
use super::*;
use crate::input_error::InputError;
use crate::model::MorphModel;

fn model_of(mesh: &morph_collision_models::mesh::MorphMesh) -> Arc<MorphModel> {
    Arc::new(MorphModel::from_displacements(&mesh.positions, &mesh.triangles, &mesh.targets).unwrap())
}

fn every_option() -> Vec<BuildOptions> {
    let leaf_size = |size| BuildOptions::default().with_leaf_size(size).unwrap();
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
            let bvh = MorphBvh::build(model.clone(), &options);
            println!("{} with {options:?}", mesh.name);
            validate(&bvh);
            let groups = bvh.topology.groups.iter();
            let children: usize = groups.map(|group| group.children().len()).sum();
            assert_eq!(bvh.node_count(), children);
        }
    }
}

#[test]
fn a_leaf_size_out_of_range_is_refused_by_name() {
    for leaf_size in [0, 256] {
        let error = BuildOptions::default().with_leaf_size(leaf_size).unwrap_err();
        assert!(
            matches!(&error, InputError::BadNumber { what, .. } if what == "leaf_size"),
            "{error:?}"
        );
        let message = format!("leaf_size is {leaf_size}, it must be a whole number from 1 to 255");
        assert_eq!(error.to_string(), message);
        #[cfg(feature = "serde")]
        {
            let json = serde_json::json!({ "leaf_size": leaf_size });
            let error = serde_json::from_value::<BuildOptions>(json).unwrap_err();
            assert!(error.to_string().contains(&message), "{error}");
        }
    }
}

#[test]
fn a_tree_restored_from_its_layout_is_the_same_tree() {
    let model = model_of(&dolphin(0));
    for options in every_option() {
        let bvh = MorphBvh::build(model.clone(), &options);
        let restored = MorphBvh::from_layout(model.clone(), &bvh.layout()).unwrap();
        assert_eq!(restored.layout(), bvh.layout());
        assert_eq!(restored.bytes(), bvh.bytes());
        assert_eq!(restored.node_count(), bvh.node_count());
        validate(&restored);
    }
}

#[test]
fn a_layout_of_another_mesh_is_refused() {
    let (small, large) = (model_of(&dolphin(0)), model_of(&dolphin(1)));
    let layout = MorphBvh::build(small, &BuildOptions::default()).layout();
    assert!(matches!(
        MorphBvh::from_layout(large, &layout),
        Err(LayoutError::OtherMesh { .. })
    ));
}

#[cfg(feature = "serde")]
#[test]
fn corrupt_layouts_are_errors_or_valid_trees() {
    let model = model_of(&random::triangle_soup(9, 40, 2));
    let layout = MorphBvh::build(model.clone(), &BuildOptions::default()).layout();
    let json = serde_json::to_value(&layout).unwrap();
    let (mut refused, mut accepted) = (0, 0);
    for field in ["nodes", "triangles"] {
        for place in 0..json[field].as_array().unwrap().len() {
            for value in [0, 1, 2, 9, 41, u32::MAX] {
                let mut broken = json.clone();
                broken[field][place] = value.into();
                match MorphBvh::from_layout(model.clone(), &serde_json::from_value(broken).unwrap()) {
                    Ok(bvh) => {
                        validate(&bvh);
                        accepted += 1;
                    }
                    Err(_) => refused += 1,
                }
            }
        }
    }
    assert!(refused > accepted, "{refused} refused, {accepted} accepted");
    let mut bad_options = json.clone();
    bad_options["options"]["leaf_size"] = 0.into();
    assert!(serde_json::from_value::<TreeLayout>(bad_options).is_err());
    let mut newer = json;
    newer["version"] = 4.into();
    assert_eq!(
        MorphBvh::from_layout(model, &serde_json::from_value(newer).unwrap()).unwrap_err(),
        LayoutError::Version { found: 4 }
    );
}

#[test]
fn a_layout_may_be_as_deep_as_a_tree_and_no_deeper() {
    for depth in [MAX_DEPTH, MAX_DEPTH + 1] {
        let triangles = depth + 1;
        let model = model_of(&random::triangle_soup(9, triangles, 0));
        let options = BuildOptions::default().with_leaf_size(1).unwrap();
        let mut json = serde_json::to_value(MorphBvh::build(model.clone(), &options).layout()).unwrap();
        // A chain: each node has a leaf and the rest.
        let chain = (1..triangles).rev().flat_map(|rest| [2, 1, rest, 0]);
        json["nodes"] = chain.chain([0]).collect();
        match MorphBvh::from_layout(model, &serde_json::from_value(json).unwrap()) {
            Ok(bvh) => {
                validate(&bvh);
                assert_eq!(depth, MAX_DEPTH);
            }
            Err(error) => {
                assert_eq!(depth, MAX_DEPTH + 1);
                let entry = 4 * MAX_DEPTH;
                assert_eq!(error, LayoutError::Nodes { entry });
            }
        }
    }
}

#[test]
fn subtrees_hold_every_triangle_once() {
    let model = model_of(&dolphin(1));
    for leaf_size in [1, 8] {
        let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
        let bvh = MorphBvh::build(model.clone(), &options);
        for most in [0, 1, 16, 100, usize::MAX] {
            let parts = bvh.subtrees(most);
            let mut all: Vec<u32> = parts.concat();
            all.sort_unstable();
            assert_eq!(all, (0..model.triangle_count() as u32).collect::<Vec<_>>());
            let leaf = bvh.options().leaf_size();
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
