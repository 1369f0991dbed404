//! `--skip-bad`: bad triangles are left out, and every output says how many.

use std::path::PathBuf;

use serde_json::Value;

use crate::support::{TestResult, error_of, field, run_program};

/// Of its 68 triangles, six have a vertex with a weight that is NaN.
fn model() -> PathBuf {
    field("c34_nan_weight_of_one_vertex.glb")
}

const WHY: &str = "vertex 5, influence 0: the weight of joint 0 is NaN, not a number between 0 and 1000";

#[test]
fn a_bad_vertex_refuses_its_mesh_and_names_the_option() -> TestResult {
    let model = model();
    let model = model.to_string_lossy();
    for command in [["query", "--self"], ["lint", "--json"]] {
        let [command, option] = command;
        let error = error_of(&run_program([command, option, &*model])?);
        assert!(error.contains(WHY), "{command}: {error}");
        assert!(
            error.contains("; --skip-bad leaves out what is bad"),
            "{command}: {error}"
        );
    }
    Ok(())
}

#[test]
fn every_output_counts_what_is_left_out() -> TestResult {
    let dir = tempfile::tempdir()?;
    let model = model();
    let model = model.to_string_lossy();
    let at = |name: &str| dir.path().join(name).to_string_lossy().into_owned();
    let (scene, exported) = (at("scene.json"), at("posed.glb"));
    let made = run_program(["scene", &*model, "--skip-bad"])?;
    std::fs::write(&scene, &made.stdout)?;
    for (args, times) in [
        (vec!["inspect", &*model], 1),
        (vec!["inspect", &*model, &*model], 1),
        (vec!["query", "--self", &*model], 1),
        (vec!["sweep", &*model], 1),
        (vec!["lint", &*model], 1),
        (vec!["export", &*model, "-o", &*exported], 1),
        (vec!["run", &*scene], 1),
        (vec!["motion", &*scene], 1),
    ] {
        let output = run_program(args.iter().chain(&["--skip-bad", "--json"]))?;
        let json: Value = serde_json::from_slice(&output.stdout)?;
        // `inspect` tells it of each mesh.
        let of_mesh = &json["meshes"][0]["left_out"];
        let left_out = if of_mesh.is_object() {
            of_mesh
        } else {
            &json["left_out"][0]
        };
        assert_eq!(left_out["triangles"], 6, "{args:?}: {json}");
        assert_eq!(left_out["of_triangles"], 68, "{args:?}: {json}");
        assert_eq!(left_out["reason"], WHY, "{args:?}: {json}");

        let output = run_program(args.iter().chain(&["--skip-bad"]))?;
        let text = [output.stdout, output.stderr].concat();
        let text = String::from_utf8_lossy(&text);
        let line = format!("6 of 68 triangles left out: {WHY}");
        assert_eq!(text.matches(&line).count(), times, "{args:?}: {text}");
    }
    Ok(())
}

#[test]
fn a_good_model_says_nothing() -> TestResult {
    let good = crate::support::asset("ict_face_skin.glb");
    if good.is_file() {
        let output = run_program(["inspect", "--skip-bad", "--json", &*good.to_string_lossy()])?;
        assert!(!String::from_utf8_lossy(&output.stdout).contains("left_out"));
    }
    Ok(())
}
