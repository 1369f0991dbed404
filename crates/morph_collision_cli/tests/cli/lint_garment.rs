//! `lint --garment` compares two meshes while their targets move both.

use std::error::Error;
use std::path::{Path, PathBuf};

use glam::Vec3;
use morph_collision_models::gltf::write::{Appearance, write_glb};
use morph_collision_models::mesh::MorphMesh;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::support::{TestResult, asset, command, error_of};

/// A triangle at a height.
fn wall(x: f32, height: f32) -> [Vec3; 3] {
    [
        Vec3::new(x, 1.0, height),
        Vec3::new(x + 1.0, 1.0, height),
        Vec3::new(x, 1.0, height + 4.0),
    ]
}

fn mesh(name: &str, positions: &[Vec3], targets: &[(&str, Vec<Vec3>)]) -> MorphMesh {
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let mut mesh = MorphMesh::rigid(name, positions.to_vec(), triangles.collect());
    mesh.target_names = targets.iter().map(|(name, _)| (*name).to_owned()).collect();
    mesh.targets = targets.iter().map(|(_, moved)| moved.clone()).collect();
    mesh
}

/// A floor that a wall of its own meets with "own", and a garment above it: a wall that stands on it, and one that hovers at a height of 1. "down" lowers
/// the garment, "both" lifts the floor and lowers the garment by 0.6 each.
fn models() -> Result<(TempDir, [PathBuf; 2]), Box<dyn Error>> {
    let floor = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner * 12.0);
    let by = |x: f32, y: f32| [[Vec3::Z * x; 3], [Vec3::Z * y; 3]].concat();
    let body = mesh(
        "body",
        &[floor, wall(1.0, 0.5)].concat(),
        &[("own", by(0.0, -1.0)), ("both", by(0.6, 0.6))],
    );
    let garment = mesh(
        "shirt",
        &[wall(3.0, 0.0), wall(5.0, 1.0)].concat(),
        &[("down", by(0.0, -2.0)), ("both", by(0.0, -0.6))],
    );
    let dir = tempdir()?;
    let paths = ["body.glb", "shirt.glb"].map(|name| dir.path().join(name));
    for (mesh, path) in [body, garment].iter().zip(&paths) {
        write_glb(path, mesh, &Appearance::default())?;
    }
    Ok((dir, paths))
}

fn report(body: &Path, garment: &Path, more: &[&str]) -> Result<Value, Box<dyn Error>> {
    let output = command()
        .arg("lint")
        .arg(body)
        .arg("--garment")
        .arg(garment)
        .arg("--json")
        .args(more)
        .output()?;
    assert_eq!(
        output.status.code(),
        Some(1),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Ok(serde_json::from_slice(&output.stdout)?)
}

#[test]
fn only_contacts_between_garment_and_mesh_are_reported() -> TestResult {
    let (_dir, [body, garment]) = models()?;
    let report = report(&body, &garment, &["--mixtures", "0", "--suggest"])?;
    let mesh = &report["meshes"][0];
    assert_eq!((&mesh["triangles"], &mesh["targets"]), (&4.into(), &3.into()));
    assert_eq!(mesh["pairs_at_rest"], 1, "the wall that stands on the floor");
    let findings = mesh["findings"].as_array().ok_or("no findings")?;
    let mut found: Vec<_> = findings.iter().map(|finding| finding["found_with"].as_str()).collect();
    found.sort_unstable();
    assert_eq!(found, [Some("target both"), Some("target down")]);
    for finding in findings {
        let of_both = serde_json::json!([
            { "mesh": 0, "name": "body", "triangles": [0] },
            { "mesh": 0, "name": "shirt", "triangles": [1] },
        ]);
        assert_eq!(finding["meshes"], of_both, "numbers are those of the meshes");
        let parts = finding["parts"].to_string();
        assert!(parts.contains("shirt"), "{parts}");
    }
    let down = findings
        .iter()
        .find(|finding| finding["found_with"] == "target down")
        .ok_or("not found")?;
    assert_eq!(
        down["reproduce"], "--mesh 0 --weights ''",
        "the mesh has no such target"
    );
    // The garment is 1 above the floor, and lowered by 2.
    let limit = &mesh["suggestions"].as_array().ok_or("no suggestions")?;
    let limit = limit
        .iter()
        .map(Value::to_string)
        .find(|limit| limit.contains("down"))
        .ok_or("no limit")?;
    assert!(limit.contains("0.49") || limit.contains("0.5"), "{limit}");
    Ok(())
}

#[test]
fn a_proof_finds_what_clips_with_a_garment() -> TestResult {
    let (_dir, [body, garment]) = models()?;
    let report = report(&body, &garment, &["--prove"])?;
    let proof = &report["meshes"][0]["proof"];
    assert_eq!(proof["pairs"], 6);
    assert!(proof["touching"].as_u64() >= Some(3), "{proof}");
    Ok(())
}

#[test]
fn garments_that_do_not_fit_are_errors_that_say_why() -> TestResult {
    let (dir, [body, garment]) = models()?;
    let lint = |model: &Path, garment: &Path, more: &[&str]| {
        command()
            .arg("lint")
            .arg(model)
            .args(["--mesh", "0", "--garment"])
            .arg(garment)
            .args(more)
            .output()
    };
    let error = error_of(&lint(&body, &dir.path().join("none.glb"), &[])?);
    assert!(error.contains("none.glb"), "{error}");
    let error = error_of(&lint(&body, &garment, &["--garment-mesh", "shrt"])?);
    assert!(
        error.contains("--garment-mesh") && error.contains("did you mean \"shirt\"?"),
        "{error}"
    );
    let error = error_of(&lint(&asset("mh_character_low.glb"), &garment, &[])?);
    assert!(
        error.contains("--garment") && error.contains("is moved by joints, \"shirt\" is not"),
        "{error}"
    );
    let error = error_of(&lint(&body, Path::new("-"), &[])?);
    assert!(
        error.contains("only the model can be read from standard input"),
        "{error}"
    );
    Ok(())
}

#[test]
fn a_skinned_mesh_wears_a_garment_on_the_same_skeleton() -> TestResult {
    let character = asset("mh_character_low.glb");
    let output = command()
        .arg("lint")
        .arg(&character)
        .arg("--mesh=0")
        .arg("--garment")
        .arg(&character)
        .args(["--mixtures", "0", "--fps", "1", "--json"])
        .output()?;
    let report: Value = serde_json::from_slice(&output.stdout)?;
    // It is its own garment, so everything touches at rest, and triangles move together.
    let mesh = &report["meshes"][0];
    assert_eq!(mesh["triangles"], 2 * 3196);
    assert!(mesh["shapes"].as_u64() > Some(100), "{}", mesh["shapes"]);
    Ok(())
}
