//! Triangles of a skinned mesh with a vertex that has no joint weights: `lint` leaves them out and says so.

use std::error::Error;
use std::path::PathBuf;

use glam::Vec3;
use morph_collision_models::generated::rigs::tube;
use morph_collision_models::gltf::write::{Appearance, write_glb};
use morph_collision_models::mesh::{InfluenceSet, MorphMesh};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::support::{TestResult, command};

/// A tube, a strip of 1,396 vertices without weights, and a wall that a target lowers through a floor. Returns the number of all triangles, too.
fn model() -> Result<(TempDir, PathBuf, usize), Box<dyn Error>> {
    let tube = tube(3, 6, 4, 0);
    let part = |name: &str, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>, weight: f32| {
        let mut skin = tube.skin.clone();
        if let Some(skin) = &mut skin {
            skin.sets = vec![InfluenceSet {
                joints: vec![[0; 4]; positions.len()],
                weights: vec![[weight, 0.0, 0.0, 0.0]; positions.len()],
            }];
        }
        MorphMesh {
            skin,
            ..MorphMesh::rigid(name, positions, triangles)
        }
    };
    let strip = (0..1396).map(|i| Vec3::new(i as f32, (i % 2) as f32, 9.0)).collect();
    let strip = part("strip", strip, (0..1394).map(|i| [i, i + 1, i + 2]).collect(), 0.0);
    let floor = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner * 8.0 + Vec3::Z * 20.0);
    let wall = [
        Vec3::new(1.0, 1.0, 21.0),
        Vec3::new(2.0, 1.0, 21.0),
        Vec3::new(1.0, 1.0, 25.0),
    ];
    let mut press = part("press", [floor, wall].concat(), vec![[0, 1, 2], [3, 4, 5]], 1.0);
    press.target_names = vec!["down".to_owned()];
    press.targets = vec![[[Vec3::ZERO; 3], [-Vec3::Z * 2.0; 3]].concat()];
    let mesh = tube.joined(&strip)?.joined(&press)?;
    let dir = tempdir()?;
    let path = dir.path().join("rig.glb");
    write_glb(&path, &mesh, &Appearance::default())?;
    Ok((dir, path, mesh.triangles.len()))
}

const SENTENCE: &str =
    "1,396 vertices have no joint weights, so they are all at the origin; left out the 1,394 triangles";

#[test]
fn lint_says_so_at_once_and_searches_the_rest() -> TestResult {
    // It reported hundreds of thousands of pairs of these triangles at rest.
    let (_dir, path, triangles) = model()?;
    let output = command()
        .arg("lint")
        .arg(&path)
        .args(["--mixtures", "0", "--json"])
        .output()?;
    let warning = String::from_utf8_lossy(&output.stderr);
    assert!(warning.contains(SENTENCE) && warning.contains("mesh 0"), "{warning}");
    let report: Value = serde_json::from_slice(&output.stdout)?;
    let mesh = &report["meshes"][0];
    assert_eq!(
        (&mesh["left_out"], &mesh["triangles"]),
        (&1394.into(), &(triangles - 1394).into())
    );
    assert!(mesh["pairs_at_rest"].as_u64() < Some(1000), "{}", mesh["pairs_at_rest"]);
    let findings = mesh["findings"].as_array().ok_or("no findings")?;
    assert_eq!(findings.len(), 1);
    let numbers = serde_json::json!([triangles - 2, triangles - 1]);
    assert_eq!(
        findings[0]["meshes"][0]["triangles"], numbers,
        "the numbers of the file"
    );
    Ok(())
}

#[test]
fn a_mesh_without_any_weights_has_nothing_to_search() -> TestResult {
    let mut mesh = tube(3, 6, 4, 1);
    if let Some(skin) = &mut mesh.skin {
        skin.sets.iter_mut().for_each(|set| set.weights.fill([0.0; 4]));
    }
    let dir = tempdir()?;
    let path = dir.path().join("none.glb");
    write_glb(&path, &mesh, &Appearance::default())?;
    let output = command().arg("lint").arg(&path).output()?;
    assert_eq!(output.status.code(), Some(2));
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        stderr.contains("have no joint weights") && stderr.contains("error: "),
        "{stderr}"
    );
    Ok(())
}
