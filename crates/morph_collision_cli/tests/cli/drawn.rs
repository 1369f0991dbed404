//! Which of a file's meshes become bodies: those that the scene draws, once for each node and each instance.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::support::{TestResult, error_of, run_program, stdout_of, write_scene};

fn data(name: &str) -> PathBuf {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../morph_collision_models/tests/gltf/data");
    Path::new(data).join(name)
}

/// The bodies of `sweep`, its rows as bodies and pairs, and what it says on standard error.
type Swept = (Value, Vec<[u64; 3]>, String);

fn sweep(model: &str, options: &[&str]) -> Result<Swept, Box<dyn std::error::Error>> {
    let model = data(model);
    let args = [&["sweep", "--json", model.to_str().ok_or("not UTF-8")?], options].concat();
    let output = run_program(args)?;
    let report: Value = serde_json::from_slice(&output.stdout)?;
    let rows = report["rows"].as_array().ok_or("no rows")?;
    let row = |row: &Value| ["body_a", "body_b", "pairs"].map(|key| row[key].as_u64().unwrap_or(u64::MAX));
    let rows = rows.iter().map(row).collect();
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    Ok((report["bodies"].clone(), rows, stderr))
}

#[test]
fn meshes_that_the_scene_does_not_draw_are_left_out_and_it_is_said() -> TestResult {
    let (bodies, rows, said) = sweep("mesh_without_a_node.glb", &[])?;
    assert_eq!((&bodies, rows.len()), (&json!(["node_0"]), 0));
    assert!(
        said.contains("the scene does not draw 1 mesh; --all-meshes takes everything"),
        "{said}"
    );
    let (bodies, rows, said) = sweep("mesh_without_a_node.glb", &["--all-meshes"])?;
    assert_eq!(bodies, json!(["node_0", "no_node"]));
    assert_eq!((&rows[..], &*said), (&[[0, 1, 18]][..], ""));
    // A mesh that is named is taken wherever it is.
    let (bodies, ..) = sweep("mesh_without_a_node.glb", &["--mesh", "no_node"])?;
    assert_eq!(bodies, json!(["no_node"]));
    Ok(())
}

#[test]
fn every_node_that_draws_a_skinned_mesh_is_a_body() -> TestResult {
    let (bodies, rows, _) = sweep("one_mesh_three_skins.glb", &[])?;
    assert_eq!(bodies, json!(["limb0", "limb1", "limb2"]));
    assert_eq!(rows, [[0, 1, 318]]);
    // Without the transforms of nodes, too, because joints place them.
    let model = format!("{}#all", data("one_mesh_three_skins.glb").display());
    let scene: Value = serde_json::from_str(&stdout_of(&run_program(["scene", &model])?))?;
    let nodes: Vec<&Value> = scene["bodies"]
        .as_array()
        .ok_or("no bodies")?
        .iter()
        .map(|body| &body["node"])
        .collect();
    assert_eq!(nodes, [1, 3, 5]);
    Ok(())
}

#[test]
fn every_instance_is_a_body() -> TestResult {
    let (bodies, rows, _) = sweep("gpu_instancing.glb", &[])?;
    assert_eq!(bodies, json!(["node_0", "node_0 (2)", "node_0 (3)"]));
    assert_eq!(rows, [[0, 1, 12]]);
    let dir = tempfile::tempdir()?;
    let body = |instance: Value| {
        let mut body = json!({"model": data("gpu_instancing.glb"), "node": 0, "instance": instance});
        body.as_object_mut()
            .into_iter()
            .for_each(|body| body.retain(|_, value| !value.is_null()));
        body
    };
    let run = |bodies: Value| {
        let scene = json!({"bodies": bodies, "frames": [[{}, {}]]});
        let scene = write_scene(dir.path(), &scene).map_err(|error| error.to_string())?;
        run_program(["run".as_ref(), scene.as_os_str()]).map_err(|error| error.to_string())
    };
    let text = stdout_of(&run(json!([body(json!(0)), body(json!(1))]))?);
    assert!(text.contains("triangle pairs      12 over all frames"), "{text}");
    let error = error_of(&run(json!([body(json!(0)), body(json!(3))]))?);
    assert!(error.contains("has no instance 3; it has 3"), "{error}");
    let mut without_node = body(json!(1));
    without_node.as_object_mut().ok_or("an object")?.remove("node");
    let error = error_of(&run(json!([body(json!(0)), without_node]))?);
    assert!(error.contains("\"instance\" has no effect without \"node\""), "{error}");
    Ok(())
}

#[test]
fn a_clip_moves_only_the_node_that_it_animates() -> TestResult {
    let dir = tempfile::tempdir()?;
    let out = dir.path().join("posed.obj");
    let model = data("clip_animates_second_node.glb");
    let args = ["--mesh", "all", "--clip", "clip", "--time", "0.5", "--output"].map(AsRef::as_ref);
    let args = [&["export".as_ref(), model.as_os_str()], &args[..], &[out.as_os_str()]].concat();
    stdout_of(&run_program(args)?);
    let obj = std::fs::read_to_string(&out)?;
    let mut ends = [f32::NEG_INFINITY; 2];
    for line in obj.lines().filter_map(|line| line.strip_prefix("v ")) {
        let numbers: Vec<f32> = line.split(' ').flat_map(str::parse).collect();
        // The second node is 5 higher.
        let end = &mut ends[usize::from(numbers[1] > 2.5)];
        *end = end.max(numbers[0]);
    }
    assert_eq!(ends, [0.5, 1.5]);
    Ok(())
}

#[test]
fn a_scene_that_does_not_exist_is_an_error_with_a_hint() -> TestResult {
    let model = data("gpu_instancing.glb");
    for command in ["sweep", "lint"] {
        let args = [
            command.as_ref(),
            model.as_os_str(),
            "--scene".as_ref(),
            "scen_0".as_ref(),
        ];
        let error = error_of(&run_program(args)?);
        assert!(
            error.contains("has no scene \"scen_0\"; it has 1 scene; did you mean \"scene_0\"?"),
            "{error}"
        );
        let args = [&args[..], &["--all-meshes".as_ref()]].concat();
        assert_eq!(run_program(args)?.status.code(), Some(2));
    }
    let args = [
        "sweep".as_ref(),
        model.as_os_str(),
        "--scene".as_ref(),
        "0".as_ref(),
        "--mesh".as_ref(),
        "0".as_ref(),
    ];
    let error = error_of(&run_program(args)?);
    assert!(error.contains("--scene: --mesh names a mesh"), "{error}");
    Ok(())
}

/// `one_mesh_three_skins.glb` with a second scene, which draws the third limb.
fn two_scenes(dir: &Path) -> Result<PathBuf, Box<dyn std::error::Error>> {
    let glb = std::fs::read(data("one_mesh_three_skins.glb"))?;
    let length = u32::from_le_bytes(glb[12..16].try_into()?) as usize;
    let mut json: Value = serde_json::from_slice(&glb[20..20 + length])?;
    json["scenes"] = json!([{"nodes": [0, 1]}, {"nodes": [4, 5]}]);
    json["buffers"][0]["uri"] = json!("limbs.bin");
    std::fs::write(dir.join("limbs.bin"), &glb[20 + length + 8..])?;
    let path = dir.join("limbs.gltf");
    std::fs::write(&path, json.to_string())?;
    Ok(path)
}

#[test]
fn a_body_of_another_scene_has_the_skin_with_which_that_scene_draws_it() -> TestResult {
    let dir = tempfile::tempdir()?;
    let model = format!("{}#all", two_scenes(dir.path())?.display());
    let made = dir.path().join("made.json");
    let out = made.to_str().ok_or("not UTF-8")?;
    let made_it = run_program(["scene", &model, "--scene", "1", "--output", out])?;
    assert!(made_it.status.success());
    let scene: Value = serde_json::from_slice(&std::fs::read(&made)?)?;
    assert_eq!(scene["bodies"][0]["node"], 5);
    let obj = dir.path().join("posed.obj");
    let obj_name = obj.to_str().ok_or("not UTF-8")?;
    stdout_of(&run_program(["export", out, "--output", obj_name])?);
    let text = std::fs::read_to_string(&obj)?;
    let xs = text.lines().filter_map(|line| line.strip_prefix("v "));
    let xs: Vec<f32> = xs.filter_map(|line| line.split(' ').next()?.parse().ok()).collect();
    assert!(xs.iter().all(|x| (9.0..11.0).contains(x)), "{xs:?}");
    Ok(())
}

#[test]
fn without_transforms_of_nodes_a_mesh_with_instances_is_one_body() -> TestResult {
    let dir = tempfile::tempdir()?;
    let model = format!("{}#all", data("gpu_instancing.glb").display());
    let made = dir.path().join("made.json");
    let out = made.to_str().ok_or("not UTF-8")?;
    stdout_of(&run_program(["scene", &model, "--output", out])?);
    let scene: Value = serde_json::from_slice(&std::fs::read(&made)?)?;
    assert_eq!(scene["bodies"].as_array().map(Vec::len), Some(1));
    stdout_of(&run_program(["run", out])?);
    Ok(())
}

#[test]
fn a_mesh_that_the_scene_does_not_draw_is_taken_with_a_note() -> TestResult {
    let model = data("mesh_without_a_node.glb");
    let args = [
        "query".as_ref(),
        model.as_os_str(),
        "--self".as_ref(),
        "--mesh".as_ref(),
        "1".as_ref(),
    ];
    let output = run_program(args)?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success());
    assert!(
        said.contains("the scene does not draw mesh 1 \"no_node\"; the first mesh that it draws is 0"),
        "{said}"
    );
    stdout_of(&run_program([&args[..3], &["--mesh".as_ref(), "0".as_ref()]].concat())?);
    Ok(())
}
