//! `lint` searches all meshes of a skeleton or node tree as one.

use std::error::Error;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use crate::lint::{findings, lint, report};
use crate::support::{RawMesh, TestResult, error_of, run_program, stdout_of, write_gltf};

/// A floor that its only target lifts by 0.6, and a wall 1 above it, which its target lowers by 0.6. They touch only if both targets are near 1.
fn meshes(height: f32) -> [RawMesh; 2] {
    let floor = RawMesh {
        positions: vec![[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0]],
        targets: vec![vec![[0.0, 0.0, 0.6]; 3]],
        ..RawMesh::triangle("jaw")
    };
    let wall = RawMesh {
        positions: vec![[1.0, 1.0, height], [2.0, 1.0, height], [1.0, 1.0, height + 4.0]],
        targets: vec![vec![[0.0, 0.0, -0.6]; 3]],
        ..RawMesh::triangle("teeth")
    };
    [floor, wall]
}

/// Writes two meshes and lets `edit` change the file. Node 0 is above node 1, which shows the floor, and node 2, which shows the wall. The clip
/// "bite" moves the nodes that it is given down by 4.
fn model(height: f32, names: [&str; 2], edit: impl Fn(&mut Value)) -> Result<(TempDir, PathBuf), Box<dyn Error>> {
    model_of(&meshes(height), &names, edit)
}

/// The same with other meshes, each of which has one target.
fn model_of(
    meshes: &[RawMesh],
    names: &[&str],
    edit: impl Fn(&mut Value),
) -> Result<(TempDir, PathBuf), Box<dyn Error>> {
    let dir = tempdir()?;
    let path = write_gltf(dir.path(), "face.gltf", meshes)?;
    let mut gltf: Value = serde_json::from_slice(&std::fs::read(&path)?)?;
    for (mesh, name) in names.iter().enumerate() {
        gltf["meshes"][mesh]["extras"] = json!({ "targetNames": [name] });
    }
    gltf["scenes"] = json!([{ "nodes": [0] }]);
    let shown = (0..meshes.len()).map(|mesh| json!({ "mesh": mesh }));
    let root = json!({ "children": (1..=meshes.len()).collect::<Vec<usize>>() });
    gltf["nodes"] = std::iter::once(root).chain(shown).collect();
    edit(&mut gltf);
    std::fs::write(&path, gltf.to_string())?;
    Ok((dir, path))
}

/// Adds a clip of one second that moves a node down by 4.
fn add_clip(gltf: &mut Value, node: usize) {
    let mut add = |uri: String, length: usize, accessor: Value| {
        let list = |gltf: &mut Value, name: &str, value: Value| {
            let list = gltf[name].as_array_mut().expect("the file has this list");
            list.push(value);
            list.len() - 1
        };
        let uri = format!("data:application/octet-stream;base64,{uri}");
        let buffer = list(gltf, "buffers", json!({ "uri": uri, "byteLength": length }));
        let view = list(gltf, "bufferViews", json!({ "buffer": buffer, "byteLength": length }));
        let mut accessor = accessor;
        accessor["bufferView"] = json!(view);
        list(gltf, "accessors", accessor)
    };
    let scalars = json!({ "componentType": 5126, "type": "SCALAR", "count": 2 });
    let times = add("AAAAAAAAgD8=".to_owned(), 8, scalars);
    let vectors = json!({ "componentType": 5126, "type": "VEC3", "count": 2 });
    let down = add("AAAA".repeat(7) + "AIDA", 24, vectors);
    gltf["animations"] = json!([{
        "name": "bite",
        "channels": [{ "sampler": 0, "target": { "node": node, "path": "translation" } }],
        "samplers": [{ "input": times, "output": down }],
    }]);
}

const QUICK: &[&str] = &["--mixtures", "0", "--fps", "8"];

fn found(path: &Path, args: &[&str]) -> Result<Vec<(String, Value)>, Box<dyn Error>> {
    let report = report(path, &[QUICK, args].concat())?;
    let found = findings(&report).into_iter();
    Ok(found
        .map(|finding| {
            (
                finding["found_with"].as_str().unwrap_or_default().to_owned(),
                finding["meshes"].clone(),
            )
        })
        .collect())
}

#[test]
fn targets_of_the_same_name_move_together_and_findings_name_both_meshes() -> TestResult {
    let (_dir, path) = model(1.0, ["open", "open"], |_| ())?;
    let of_both = json!([
        { "mesh": 0, "name": "jaw", "node": 1, "triangles": [0] },
        { "mesh": 1, "name": "teeth", "node": 2, "triangles": [0] },
    ]);
    // Each mesh was tried alone, and nothing was found.
    assert_eq!(found(&path, &[])?, [("target open".to_owned(), of_both)]);
    for mesh in ["0", "teeth"] {
        assert_eq!(found(&path, &["--mesh", mesh])?, [], "alone");
    }
    let report = report(&path, QUICK)?;
    let subject = &report["meshes"][0];
    assert_eq!(
        (&subject["name"], &subject["targets"]),
        (&"jaw and 1 more".into(), &1.into())
    );
    assert_eq!(subject["joined"][1], json!({ "mesh": 1, "name": "teeth", "node": 2 }));
    assert_eq!(findings(&report)[0]["reproduce"], "--mesh 0 --weights open=1");
    let text = String::from_utf8(lint(&path, &[QUICK, &["--prove", "--suggest"]].concat())?.stdout)?;
    assert!(
        text.contains("jaw piece 0 (1 triangle) and teeth piece 1") && text.contains("open: at most 0.83"),
        "{text}"
    );
    Ok(())
}

#[test]
fn targets_with_other_names_are_tried_in_pairs() -> TestResult {
    let (_dir, path) = model(1.0, ["open", "lower"], |_| ())?;
    assert_eq!(found(&path, &[])?, []);
    let pairs = found(&path, &["--pairs"])?;
    assert_eq!(pairs.len(), 1);
    assert_eq!(pairs[0].0, "pair open + lower");
    Ok(())
}

#[test]
fn rigid_meshes_follow_their_nodes() -> TestResult {
    // The wall is modelled around the origin, and its node is 1 above that of the floor, which is turned over.
    let placed = |gltf: &mut Value| {
        gltf["nodes"][2] = json!({ "mesh": 1, "translation": [0, 0, 1] });
        gltf["nodes"][0]["translation"] = json!([5, 5, 5]);
    };
    let (_dir, path) = model(0.0, ["open", "open"], placed)?;
    assert_eq!(found(&path, &[])?.len(), 1);
    let clipped = |gltf: &mut Value| {
        placed(gltf);
        add_clip(gltf, 2);
    };
    let (_dir, path) = model(0.0, ["open", "lower"], clipped)?;
    let clips = found(&path, &[])?;
    assert_eq!((clips.len(), &*clips[0].0), (1, "clip bite"));
    // If the node above both moves, nothing changes.
    let (_dir, path) = model(1.0, ["open", "lower"], |gltf| add_clip(gltf, 0))?;
    assert_eq!(found(&path, &[])?, []);
    Ok(())
}

#[test]
fn meshes_of_other_trees_are_searched_alone() -> TestResult {
    let apart = |gltf: &mut Value| {
        gltf["scenes"] = json!([{ "nodes": [1, 2] }]);
        gltf["nodes"][0] = json!({});
    };
    let (_dir, path) = model(1.0, ["open", "open"], apart)?;
    let report = report(&path, QUICK)?;
    assert_eq!(report["meshes"].as_array().map(Vec::len), Some(2));
    assert!(findings(&report).is_empty());
    Ok(())
}

#[test]
fn meshes_that_nothing_moves_are_nothing_to_try() -> TestResult {
    let still = |gltf: &mut Value| {
        for mesh in 0..2 {
            let primitive = gltf["meshes"][mesh]["primitives"][0].as_object_mut();
            primitive.expect("the file has this primitive").remove("targets");
            gltf["meshes"][mesh]["extras"] = json!({});
        }
    };
    let (_dir, path) = model(0.0, ["", ""], still)?;
    let error = error_of(&lint(&path, &[])?);
    assert!(error.contains("nothing was tried"), "{error}");
    Ok(())
}

#[test]
fn a_skinned_mesh_meets_what_hangs_on_its_skeleton() -> TestResult {
    let (_dir, path) = crate::support::bound_and_free()?;
    let mut gltf: Value = serde_json::from_slice(&std::fs::read(&path)?)?;
    // The second triangle hangs on the same tree, 1 above the first one, which the clip lifts by 4.
    gltf["nodes"][0]["children"] = json!([1, 3]);
    gltf["nodes"][3]["translation"] = json!([0, 0, 1.9]);
    gltf["nodes"][3]["rotation"] = json!([0.70710677, 0, 0, 0.70710677]);
    std::fs::write(&path, gltf.to_string())?;
    let clips = found(&path, &["--clip", "rise"])?;
    assert!(
        clips
            .iter()
            .any(|(with, meshes)| with == "clip rise" && meshes.as_array().map(Vec::len) == Some(2)),
        "{clips:?}"
    );
    Ok(())
}

#[test]
fn a_character_that_takes_too_much_memory_says_which_option_helps() -> TestResult {
    let [mut jaw, teeth] = meshes(1.0);
    jaw.positions.resize(4000, [0.0; 3]);
    jaw.targets[0].resize(4000, [0.0; 3]);
    let (_dir, path) = model_of(&[jaw, teeth], &["open", "open"], |_| ())?;
    let mut of_all = 0;
    for limit in (1..30).map(|step| 40_000 * step) {
        let output = lint(&path, &["--memory-limit", &limit.to_string()])?;
        if output.status.code() == Some(2) {
            let error = String::from_utf8_lossy(&output.stderr);
            assert!(error.contains("memory-limit"), "{error}");
            if error
                .contains("\"jaw\" and the other meshes of its skeleton or node tree: its 2 meshes as one would take")
            {
                assert!(error.contains("; --mesh takes one mesh"), "{error}");
                of_all += 1;
            }
        }
    }
    assert!(of_all > 0, "no limit has room for each mesh but not for both as one");
    Ok(())
}

/// Writes meshes that only their places tell from others: each is shown by `copies` nodes without a parent.
fn forest(dir: &Path, meshes: &[RawMesh], copies: usize) -> Result<PathBuf, Box<dyn Error>> {
    let path = write_gltf(dir, "forest.gltf", meshes)?;
    let mut gltf: Value = serde_json::from_slice(&std::fs::read(&path)?)?;
    let node = |place: usize| json!({ "mesh": place % meshes.len(), "translation": [place, 0, 0] });
    let nodes: Vec<Value> = (0..copies * meshes.len()).map(node).collect();
    gltf["scenes"] = json!([{ "nodes": (0..nodes.len()).collect::<Vec<usize>>() }]);
    gltf["nodes"] = json!(nodes);
    std::fs::write(&path, gltf.to_string())?;
    Ok(path)
}

#[test]
fn a_mesh_that_many_trees_show_takes_its_memory_once() -> TestResult {
    let mut tree = RawMesh::triangle("tree");
    let corner = |place: usize| [(place / 3) as f32 * 2.0 + (place % 3) as f32, (place % 2) as f32, 0.0];
    tree.positions = (0..3000).map(corner).collect();
    tree.targets = vec![vec![[0.0, 0.0, 1.0]; 3000]];
    tree.indices = Vec::new();
    let dir = tempdir()?;
    let path = forest(dir.path(), &[tree], 200)?;
    // Before, all that was read was counted, and most were left out with a warning.
    let output = lint(
        &path,
        &[QUICK, &["--memory-limit", "8MiB", "--threads", "1", "--json"]].concat(),
    )?;
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code() != Some(2) && !complaint.contains("left out"),
        "{complaint}"
    );
    let report: Value = serde_json::from_slice(&output.stdout)?;
    assert_eq!(report["meshes"].as_array().map(Vec::len), Some(1));
    Ok(())
}

#[test]
fn a_bad_mesh_that_many_trees_show_is_named_once() -> TestResult {
    let mut bad = RawMesh::triangle("bad");
    bad.positions[1][2] = f32::NAN;
    let dir = tempdir()?;
    let path = forest(dir.path(), &[RawMesh::triangle("good"), bad], 30)?;
    let output = lint(&path, QUICK)?;
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{complaint}");
    assert_eq!(complaint.matches("left out: ").count(), 1, "{complaint}");
    assert!(complaint.contains("mesh 1 \"bad\""), "{complaint}");
    Ok(())
}

#[test]
fn a_bad_mesh_of_a_character_is_left_out_and_named() -> TestResult {
    let [jaw, teeth] = meshes(1.0);
    let mut tongue = RawMesh::triangle("tongue");
    tongue.positions[1][2] = f32::NAN;
    let (_dir, path) = model_of(&[jaw, teeth, tongue], &["open"; 3], |_| ())?;
    let output = lint(&path, &[QUICK, &["--json"]].concat())?;
    let warning = String::from_utf8_lossy(&output.stderr);
    assert!(
        warning.contains("warning: left out: ")
            && warning.contains("mesh 2 \"tongue\": ")
            && warning.contains("vertex 1"),
        "{warning}"
    );
    // The others are searched; before, nothing was.
    let report: Value = serde_json::from_slice(&output.stdout)?;
    assert_eq!(findings(&report).len(), 1);
    assert_eq!(report["meshes"][0]["joined"].as_array().map(Vec::len), Some(2));
    Ok(())
}

#[test]
fn a_bad_skinned_mesh_that_two_nodes_show_is_mended_for_both() -> TestResult {
    let whole = std::fs::read(crate::support::field("c34_nan_weight_of_one_vertex.glb"))?;
    let length =
        |at: usize| -> Result<usize, Box<dyn Error>> { Ok(u32::from_le_bytes(whole[at..at + 4].try_into()?) as usize) };
    let (json_bytes, binary) = whole[20..].split_at(length(12)?);
    let mut gltf: Value = serde_json::from_slice(json_bytes)?;
    let nodes = gltf["nodes"].as_array_mut().ok_or("no nodes")?;
    let shows = nodes.iter().find(|node| node.get("mesh").is_some());
    let mut copy = shows.ok_or("no mesh is shown")?.clone();
    copy["name"] = json!("copy");
    nodes.push(copy);
    let added = nodes.len() - 1;
    gltf["scenes"][0]["nodes"]
        .as_array_mut()
        .ok_or("no scene")?
        .push(json!(added));
    gltf["buffers"][0]["uri"] = json!("c34.bin");
    let dir = tempdir()?;
    std::fs::write(dir.path().join("c34.bin"), &binary[8..])?;
    let path = dir.path().join("c34.gltf");
    std::fs::write(&path, gltf.to_string())?;
    let output = lint(&path, &[QUICK, &["--skip-bad", "--json"]].concat())?;
    let complaint = String::from_utf8_lossy(&output.stderr);
    // The second one had the skin of the file, with its NaN, and `lint` ended with an error.
    assert!(matches!(output.status.code(), Some(0 | 1)), "{complaint}");
    let report: Value = serde_json::from_slice(&output.stdout)?;
    assert_eq!(report["meshes"][0]["joined"].as_array().map(Vec::len), Some(2));
    assert_eq!(report["meshes"][0]["triangles"], 2 * (68 - 6));
    Ok(())
}

/// An avatar whose expression "happy" lifts the floor and lowers the wall.
fn avatar() -> Result<(TempDir, PathBuf), Box<dyn Error>> {
    model(1.0, ["open", "lower"], |gltf| {
        let bind = |node: usize| json!({ "node": node, "index": 0, "weight": 1.0 });
        let expressions = json!({
            "preset": { "happy": { "morphTargetBinds": [bind(1), bind(2)] }, "blink": { "morphTargetBinds": [bind(1)] } },
            "custom": { "shut": { "morphTargetBinds": [bind(1), bind(2)], "isBinary": true } },
        });
        gltf["extensionsUsed"] = json!(["VRMC_vrm"]);
        gltf["extensions"] = json!({ "VRMC_vrm": { "specVersion": "1.0", "expressions": expressions } });
    })
}

#[test]
fn expressions_of_an_avatar_are_a_source_of_their_own() -> TestResult {
    let (_dir, path) = avatar()?;
    let report = report(&path, QUICK)?;
    let found = findings(&report);
    let with: Vec<&Value> = found.iter().map(|finding| &finding["found_with"]).collect();
    assert_eq!(with, ["expression happy", "expression shut"]);
    assert_eq!(found[0]["kind"], "expression");
    assert_eq!(found[0]["weights"], json!({ "open": 1.0, "lower": 1.0 }));
    // Two at half and at full strength, and one only in full.
    let source = json!({ "kind": "expression", "shapes": 5, "findings": 2 });
    assert!(
        report["meshes"][0]["sources"]
            .as_array()
            .is_some_and(|sources| sources.contains(&source)),
        "{report}"
    );
    Ok(())
}

/// Neither `inspect` nor `lint` said anything of expressions that are broken in part.
#[test]
fn broken_parts_of_expressions_are_named() -> TestResult {
    let (_dir, path) = model(1.0, ["open", "lower"], |gltf| {
        let bind = |node: usize, index: usize| json!({ "node": node, "index": index, "weight": 1.0 });
        let binds = [bind(1, 0), bind(2, 7), bind(99, 0)];
        let expressions = json!({ "preset": { "happy": { "morphTargetBinds": binds } } });
        gltf["extensionsUsed"] = json!(["VRMC_vrm"]);
        gltf["extensions"] = json!({ "VRMC_vrm": { "specVersion": "1.0", "expressions": expressions } });
    })?;
    let told = String::from_utf8(lint(&path, QUICK)?.stderr)?;
    assert!(
        told.contains("the expression \"happy\" moves target 7 of mesh 1, which has 1 target\n"),
        "{told}"
    );
    assert!(told.contains("left out: expression \"happy\": "), "{told}");
    let inspect = |more: &[&str]| {
        let mut args = vec!["inspect".as_ref(), path.as_os_str()];
        args.extend(more.iter().map(AsRef::<std::ffi::OsStr>::as_ref));
        Ok::<_, Box<dyn Error>>(stdout_of(&run_program(args)?))
    };
    let text = inspect(&[])?;
    let is_row = |line: &str| line.split_whitespace().eq(["happy", "2"]);
    assert!(
        text.lines().any(is_row) && text.contains("warning: expression \"happy\": "),
        "{text}"
    );
    let report: Value = serde_json::from_str(&inspect(&["--json"])?)?;
    let happy = &report["expressions"][0];
    assert_eq!((&happy["name"], &happy["targets"]), (&json!("happy"), &json!(2)));
    assert_eq!(happy["problems"].as_array().map(Vec::len), Some(1));
    Ok(())
}

#[test]
fn a_query_can_show_an_expression() -> TestResult {
    let (_dir, path) = avatar()?;
    let hit = |args: &[&str]| {
        let mut all = vec![
            "query".as_ref(),
            path.as_os_str(),
            "--ray=1,1,5,0,0,-1".as_ref(),
            "--json".as_ref(),
        ];
        all.extend(args.iter().map(AsRef::<std::ffi::OsStr>::as_ref));
        let answer: Value = serde_json::from_str(&stdout_of(&run_program(all)?))?;
        Ok::<_, Box<dyn Error>>(answer["hits"][0]["t"].as_f64().map(|t| (t * 100.0).round()))
    };
    assert_eq!(hit(&[])?, Some(500.0));
    assert_eq!(hit(&["--expression", "happy"])?, Some(440.0));
    assert_eq!(
        hit(&["--expression", "happy=0.5", "--expression", "blink=1"])?,
        Some(410.0)
    );
    assert_eq!(hit(&["--expression", "happy", "--weights", "open=0"])?, Some(500.0));
    for (args, part) in [
        (
            ["--expression", "happi"],
            "there is no expression \"happi\"; did you mean \"happy\"",
        ),
        (["--expression", "happy=x"], "NAME=STRENGTH"),
    ] {
        let mut all = vec!["query".as_ref(), path.as_os_str(), "--self".as_ref()];
        all.extend(args.iter().map(AsRef::<std::ffi::OsStr>::as_ref));
        let message = error_of(&run_program(all)?);
        assert!(message.contains(part), "{message}");
    }
    let out = path.with_extension("obj");
    let export = |args: &[&str]| {
        let mut all = vec![
            "export".as_ref(),
            path.as_os_str(),
            "--output".as_ref(),
            out.as_os_str(),
        ];
        all.extend(args.iter().map(AsRef::<std::ffi::OsStr>::as_ref));
        Ok::<_, Box<dyn Error>>(stdout_of(&run_program(all)?))
    };
    let both = ["--mesh", "all", "--expression", "happy"];
    assert!(export(&both)?.contains("2 of them touch others"));
    let weaker = export(&[&both[..], &["--weights", "open=0.2"]].concat())?;
    assert!(!weaker.contains("2 of them touch others"), "{weaker}");
    let alone = ["query", "--self", "--mesh", "1", "--expression", "blink"].map(AsRef::<std::ffi::OsStr>::as_ref);
    let message = error_of(&run_program(alone.into_iter().chain([path.as_os_str()]))?);
    assert!(message.contains("\"blink\" does not move this mesh"), "{message}");
    Ok(())
}
