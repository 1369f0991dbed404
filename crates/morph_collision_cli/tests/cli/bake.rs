//! `bake` writes the trees of a model's meshes.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use morph_collision::{MorphBvh, TreeFile};
use morph_collision_models::gltf::read::read_meshes;
use serde_json::Value;
use tempfile::tempdir;

use crate::support::{TestResult, asset, command, error_of, run_program, stdout_of};

#[test]
fn a_baked_tree_is_the_tree_of_the_mesh() -> TestResult {
    let dir = tempdir()?;
    for name in ["dolphin_564.glb", "mh_character_low.glb"] {
        let model = dir.path().join(name);
        fs::copy(asset(name), &model)?;
        let report: Value = serde_json::from_str(&stdout_of(
            &command()
                .arg("bake")
                .arg(&model)
                .args(["--json", "--leaf", "5"])
                .output()?,
        ))?;
        let out = dir.path().join(format!("{name}.morphtree"));
        assert_eq!(report["file"], out.display().to_string());
        let bytes = fs::read(&out)?;
        assert_eq!(report["bytes"], bytes.len());
        let file = TreeFile::from_bytes(&bytes)?;
        let [saved] = &file.trees[..] else { panic!("{report}") };
        let mesh = read_meshes(&model)?.remove(0);
        assert_eq!(report["trees"][0]["label"], saved.label);
        assert_eq!(report["trees"][0]["triangles"], mesh.triangles.len());
        assert_eq!(saved.label, "Mesh0/Primitive0");
        assert_eq!(saved.joints, mesh.skin.as_ref().map(|skin| skin.joint_count() as u32));
        let tree = MorphBvh::from_layout(Arc::new(mesh.to_model()?), &saved.layout)?;
        assert_eq!(tree.options().leaf_size(), 5);
    }
    Ok(())
}

#[test]
fn rigid_meshes_and_certificates_are_baked_on_request() -> TestResult {
    let dir = tempdir()?;
    let out = dir.path().join("out.morphtree");
    let bake = |model: &Path, args: &[&str]| command().arg("bake").arg(model).arg("-o").arg(&out).args(args).output();
    let text = stdout_of(&bake(&asset("dolphin_564.glb"), &["--certificates"])?);
    assert!(text.contains("out.morphtree: 1 tree of 564 triangles in all"), "{text}");
    let file = TreeFile::from_bytes(&fs::read(&out)?)?;
    let model = Arc::new(read_meshes(&asset("dolphin_564.glb"))?.remove(0).to_model()?);
    let tree = MorphBvh::from_layout(model, &file.trees[0].layout)?;
    assert!(tree.certificates().is_some());

    let rigid = dir.path().join("rigid.glb");
    let export = command()
        .arg("export")
        .arg(asset("dolphin_564.glb"))
        .arg("-o")
        .arg(&rigid)
        .output()?;
    stdout_of(&export);
    let error = error_of(&bake(&rigid, &[])?);
    assert!(
        error.contains("no mesh to bake") && error.contains("--rigid"),
        "{error}"
    );
    let report: Value = serde_json::from_str(&stdout_of(&bake(&rigid, &["--rigid", "--json"])?))?;
    assert!(!report["trees"].as_array().unwrap().is_empty(), "{report}");
    Ok(())
}

#[test]
fn models_without_a_name_or_with_bad_parts_are_refused() -> TestResult {
    let model = asset("dolphin_564.glb");
    let error = error_of(&run_program([Path::new("bake"), Path::new("-")])?);
    assert!(
        error.contains("--output") && error.contains("standard input"),
        "{error}"
    );
    let error = error_of(&command().arg("bake").arg(&model).arg("--skip-bad").output()?);
    assert!(
        error.contains("--skip-bad") && error.contains("bad triangles"),
        "{error}"
    );
    let error = error_of(&command().arg("bake").arg(&model).arg("-o").arg(&model).output()?);
    assert!(error.contains("--output"), "{error}");
    Ok(())
}
