//! Small files that claim gigabytes end with an error that says so. The system limits memory, so
//! allocating it would abort.
#![cfg(unix)]

use std::error::Error;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::{Value, json};
use tempfile::tempdir;

use crate::support::{RawMesh, TestResult, error_of, write_gltf};

/// Most memory that a process may take, in KiB: twice the tool's own limit.
const SYSTEM_LIMIT: u32 = 2_000_000;

fn limited(args: &[&OsStr]) -> Result<Output, Box<dyn Error>> {
    let script = format!("ulimit -v {SYSTEM_LIMIT} && exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.arg("-c").arg(script).arg(crate::PROGRAM_FILE);
    Ok(command.args(args).output()?)
}

fn unstored(kind: u32, shape: &str, count: u64) -> Value {
    json!({"componentType": kind, "type": shape, "count": count})
}

/// Stores only one of many elements.
fn sparse(count: u64) -> Value {
    let mut accessor = unstored(5126, "VEC3", count);
    accessor["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": 0, "componentType": 5121},
        "values": {"bufferView": 1},
    });
    accessor
}

fn model(accessors: &[Value], primitives: &[Value]) -> Value {
    json!({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 16, "uri": "data:;base64,AAAAAAAAAAAAAAAAAAAAAA=="}],
        "bufferViews": [{"buffer": 0, "byteLength": 1}, {"buffer": 0, "byteOffset": 4, "byteLength": 12}],
        "accessors": accessors,
        "meshes": [{"name": "bomb", "primitives": primitives}],
    })
}

/// Models, each with a part of the message that refuses it.
fn bombs() -> Vec<(&'static str, Value)> {
    let positions = |count| json!({"attributes": {"POSITION": 0}, "targets": vec![json!({"POSITION": 1}); count]});
    let indexed = json!({"attributes": {"POSITION": 0}, "indices": 1});
    vec![
        (
            "vertices",
            model(&[unstored(5126, "VEC3", 3_000_000_000)], &[positions(0)]),
        ),
        (
            "vertices",
            model(
                &[unstored(5126, "VEC3", 15_999_999), sparse(15_999_999)],
                &[positions(100)],
            ),
        ),
        (
            "vertices",
            model(&[sparse(15_999_999), sparse(15_999_999)], &[positions(60)]),
        ),
        (
            "triangles",
            model(
                &[unstored(5126, "VEC3", 3), unstored(5125, "SCALAR", 300_000_000)],
                std::slice::from_ref(&indexed),
            ),
        ),
        (
            "triangles",
            model(
                &[unstored(5126, "VEC3", 3), unstored(5125, "SCALAR", 16_000_002)],
                &vec![indexed; 60],
            ),
        ),
        // Small enough to be read, but too large for a tree.
        ("tree", model(&[unstored(5126, "VEC3", 15_000_000)], &[positions(0)])),
        ("tree", model(&[sparse(9_999_999), sparse(9_999_999)], &[positions(1)])),
    ]
}

#[test]
fn a_bomb_is_refused_by_every_command_that_reads_models() -> TestResult {
    let dir = tempdir()?;
    let path = dir.path().join("bomb.gltf");
    let scene = dir.path().join("scene.json");
    std::fs::write(
        &scene,
        r#"{"bodies": [{"model": "bomb.gltf"}, {"model": "bomb.gltf"}], "frames": [[{}, {}]]}"#,
    )?;
    for (index, (says, bomb)) in bombs().into_iter().enumerate() {
        let text = bomb.to_string();
        assert!(text.len() < 3000, "{} bytes are no small file", text.len());
        std::fs::write(&path, text)?;
        let model: &OsStr = path.as_os_str();
        let commands: [&[&OsStr]; 3] = [
            &["inspect".as_ref(), model],
            &["run".as_ref(), scene.as_os_str()],
            &["query".as_ref(), model, "--self".as_ref()],
        ];
        for args in commands {
            let message = error_of(&limited(args)?);
            let said = message.contains(says);
            let named = message.contains("bomb.gltf") && message.contains("mesh 0") && message.contains("GiB");
            assert!(said && named, "bomb {index}, {args:?}: {message}");
            assert!(message.contains("--memory-limit"), "bomb {index}, {args:?}: {message}");
        }
    }
    Ok(())
}

#[test]
fn a_scene_of_many_states_is_counted() -> TestResult {
    let dir = tempdir()?;
    let model = dir.path().join("model.gltf");
    let triangle = json!({"attributes": {"POSITION": 0}, "targets": vec![json!({}); 20_000]});
    std::fs::write(
        &model,
        self::model(&[unstored(5126, "VEC3", 3)], &[triangle]).to_string(),
    )?;
    // Bodies at rest share their weights. Otherwise, 20,000 targets in 40,000 states would take 3.2 GB.
    let scene = dir.path().join("scene.json");
    let frames = vec!["[{}]"; 40_000].join(",");
    std::fs::write(
        &scene,
        format!(r#"{{"bodies": [{{"model": "model.gltf"}}], "frames": [{frames}]}}"#),
    )?;
    let output = limited(&["run".as_ref(), scene.as_os_str()])?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let output = limited(&[
        "run".as_ref(),
        scene.as_os_str(),
        "--memory-limit".as_ref(),
        "1MiB".as_ref(),
    ])?;
    let message = error_of(&output);
    assert!(
        message.contains("scene.json") && message.contains("--memory-limit"),
        "{message}"
    );
    Ok(())
}

#[test]
fn what_is_no_regular_file_is_not_read() -> TestResult {
    let dir = tempdir()?;
    let zero = Path::new("/dev/zero");
    let message = error_of(&limited(&["inspect".as_ref(), zero.as_os_str()])?);
    assert!(
        message.contains("not a regular file") && message.contains("--allow-any-path"),
        "{message}"
    );
    let message = error_of(&limited(&[
        "inspect".as_ref(),
        zero.as_os_str(),
        "--allow-any-path".as_ref(),
    ])?);
    assert!(
        message.contains("/dev/zero: it is longer than") && message.contains("--memory-limit"),
        "{message}"
    );
    let message = error_of(&limited(&["run".as_ref(), zero.as_os_str()])?);
    assert!(message.contains("/dev/zero"), "{message}");

    let path: PathBuf = dir.path().join("model.gltf");
    let mut gltf = model(&[sparse(3)], &[json!({"attributes": {"POSITION": 0}})]);
    gltf["buffers"][0]["uri"] = "/dev/zero".into();
    std::fs::write(&path, gltf.to_string())?;
    let message = error_of(&limited(&["inspect".as_ref(), path.as_os_str()])?);
    assert!(
        message.contains("/dev/zero") && message.contains("buffer 0"),
        "{message}"
    );
    Ok(())
}

#[test]
fn counts_that_overflow_are_refused() -> TestResult {
    let dir = tempdir()?;
    let path = dir.path().join("bomb.gltf");
    for count in [u64::MAX, 1_537_228_672_809_129_303] {
        let primitive = json!({"attributes": {"POSITION": 0}, "indices": 1});
        let accessors = [unstored(5126, "VEC3", 3), unstored(5125, "SCALAR", count)];
        std::fs::write(&path, model(&accessors, &[primitive]).to_string())?;
        let message = error_of(&limited(&["inspect".as_ref(), path.as_os_str()])?);
        assert!(message.contains("beyond 2^32"), "{count}: {message}");
    }
    Ok(())
}

/// Triangles that are all the same point.
fn collapsed(triangles: u64) -> Value {
    let primitive = json!({"attributes": {"POSITION": 0}});
    model(&[unstored(5126, "VEC3", 3 * triangles)], &[primitive])
}

#[test]
fn pairs_of_collapsed_bodies_are_counted() -> TestResult {
    let dir = tempdir()?;
    // 400 million pairs, which would take 12 GB.
    let model = dir.path().join("point.gltf");
    std::fs::write(&model, collapsed(20_000).to_string())?;
    let scene = dir.path().join("scene.json");
    let bodies = r#"{"bodies": [{"model": "point.gltf"}, {"model": "point.gltf"}], "frames": [[{}, {}]]}"#;
    std::fs::write(&scene, bodies)?;
    let limit: [&OsStr; 2] = ["--memory-limit".as_ref(), "256MiB".as_ref()];
    let run: [&OsStr; 2] = ["run".as_ref(), scene.as_os_str()];
    let message = error_of(&limited(&[&run[..], &limit[..]].concat())?);
    // 256 MiB have room for 2097152 pairs, and the models take some of it.
    let most = message
        .split("more than ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next());
    let most: u32 = most.unwrap_or_default().parse()?;
    let named = message.contains("frame 0, bodies 0 and 1") && (1_000_000..2_097_152).contains(&most);
    assert!(named && message.contains("--memory-limit"), "{message}");
    let first = ["run".as_ref(), scene.as_os_str(), "--mode".as_ref(), "first".as_ref()];
    assert!(limited(&first)?.status.success());
    Ok(())
}

#[test]
fn pairs_of_a_mesh_that_collapses_into_itself_are_counted() -> TestResult {
    let dir = tempdir()?;
    let corners = (0..3000_u16).map(f32::from);
    let mesh = RawMesh {
        name: "point",
        positions: corners.clone().map(|c| [c, (7.0 * c) % 11.0, c % 3.0]).collect(),
        indices: (0..3000).collect(),
        targets: vec![corners.map(|c| [-c, -((7.0 * c) % 11.0), -(c % 3.0)]).collect()],
    };
    let model = write_gltf(dir.path(), "point.gltf", &[mesh])?;
    let query = |limit: &str| {
        limited(&[
            "query".as_ref(),
            model.as_os_str(),
            "--self".as_ref(),
            "--weights".as_ref(),
            "1".as_ref(),
            "--memory-limit".as_ref(),
            limit.as_ref(),
        ])
    };
    let message = error_of(&query("4MiB")?);
    let named = message.contains("point.gltf: mesh 0") && message.contains("more than 8192 pairs");
    assert!(named && message.contains("--memory-limit"), "{message}");
    let output = query("1GiB")?;
    assert!(String::from_utf8_lossy(&output.stdout).contains("\n499500 pairs"));
    Ok(())
}

#[test]
fn the_models_of_a_scene_share_the_memory_limit() -> TestResult {
    let dir = tempdir()?;
    // About 100 MB each once it is read.
    let bomb = model(
        &[sparse(1_999_998), sparse(1_999_998)],
        &[json!({
            "attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}],
        })],
    );
    let bomb = bomb.to_string();
    let mut bodies = Vec::new();
    for number in 0..60 {
        let name = format!("{number}.gltf");
        std::fs::write(dir.path().join(&name), &bomb)?;
        bodies.push(json!({"model": name}));
    }
    let states = vec![json!({}); bodies.len()];
    let scene = dir.path().join("scene.json");
    std::fs::write(&scene, json!({"bodies": bodies, "frames": [states]}).to_string())?;
    let message = error_of(&limited(&["run".as_ref(), scene.as_os_str()])?);
    assert!(
        message.contains(".gltf") && message.contains("over the limit"),
        "{message}"
    );
    Ok(())
}

/// Scenes, tables and accepted findings are refused before they are read if they are longer than the limit, or as soon as it is clear.
#[test]
fn text_is_refused_for_its_length() -> TestResult {
    let dir = tempdir()?;
    write_gltf(dir.path(), "model.gltf", &[RawMesh::triangle("one")])?;
    let write = |name: &str, text: String| std::fs::write(dir.path().join(name), text);
    let comment = "x".repeat(1 << 20);
    write(
        "scene.json",
        json!({"comment": comment, "bodies": [], "frames": []}).to_string(),
    )?;
    write("take.csv", format!("near\n# {comment}\n1\n"))?;
    write(
        "known.json",
        json!({"version": 2, "accepted": [], "comment": comment}).to_string(),
    )?;
    let path = |name: &str| dir.path().join(name).into_os_string();
    let (model, _keep) = {
        let (keep, model) = crate::lint::model(0.0)?;
        (model.into_os_string(), keep)
    };
    for (name, before) in [
        ("scene.json", vec!["run".into()]),
        ("take.csv", vec!["lint".into(), model.clone(), "--capture".into()]),
        ("known.json", vec!["lint".into(), model.clone(), "--baseline".into()]),
    ] {
        let with = |limit: &str| {
            let args = before
                .iter()
                .cloned()
                .chain([path(name), "--memory-limit".into(), limit.into()]);
            let args: Vec<std::ffi::OsString> = args.collect();
            limited(&args.iter().map(AsRef::as_ref).collect::<Vec<_>>())
        };
        let message = error_of(&with("1MiB")?);
        let named = message.contains(name) && message.contains("it is longer than");
        assert!(named && message.contains("--memory-limit"), "{name}: {message}");
        let output = with("64MiB")?;
        assert!(
            output.status.code() != Some(2),
            "{name}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    Ok(())
}

/// Text of a mebibyte that stands for more than it says.
#[test]
fn what_is_made_of_text_is_counted() -> TestResult {
    let (dir, model) = crate::lint::model(0.0)?;
    let columns = ",".repeat(1 << 20);
    let findings = vec![r#"{"found_with":"","depth":0,"meshes":[]}"#; 1 << 15].join(",");
    for (name, flag, text, says) in [
        ("take.csv", "--capture", format!("near{columns}\n"), "its columns"),
        (
            "known.json",
            "--baseline",
            format!(r#"{{"version":2,"accepted":[{findings}]}}"#),
            "its findings",
        ),
    ] {
        let path = dir.path().join(name);
        std::fs::write(&path, text)?;
        let args = ["lint".as_ref(), model.as_os_str(), flag.as_ref(), path.as_os_str()];
        let limit = ["--memory-limit".as_ref(), "8MiB".as_ref()];
        let message = error_of(&limited(&[&args[..], &limit].concat())?);
        let named = message.contains(name) && message.contains(says);
        assert!(named && message.contains("--memory-limit"), "{name}: {message}");
    }
    Ok(())
}

#[test]
fn accepted_findings_and_the_model_share_the_memory_limit() -> TestResult {
    let (dir, model) = crate::lint::model(0.0)?;
    let known = dir.path().join("known.json");
    std::fs::write(
        &known,
        json!({"version": 2, "accepted": [], "comment": "x".repeat(1 << 20)}).to_string(),
    )?;
    let args = ["lint".as_ref(), model.as_os_str(), "--mixtures".as_ref(), "0".as_ref()];
    // 5 bytes for each of the text.
    let limit = ["--memory-limit".as_ref(), "5250000".as_ref()];
    let output = limited(&[&args[..], &limit].concat())?;
    assert!(
        output.status.code() != Some(2),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let baseline = ["--baseline".as_ref(), known.as_os_str()];
    let message = error_of(&limited(&[&args[..], &limit, &baseline].concat())?);
    assert!(
        message.contains("over the limit of 5.0 MiB") && !message.contains("known.json"),
        "{message}"
    );
    Ok(())
}

#[test]
fn devices_and_pipes_are_no_text() -> TestResult {
    let (dir, model) = crate::lint::model(0.0)?;
    let pipe = dir.path().join("pipe.json");
    assert!(Command::new("mkfifo").arg(&pipe).status()?.success());
    let at_pipe = format!("@{}", pipe.display());
    let (model, pipe) = (model.as_os_str(), pipe.as_os_str());
    // Each would wait for ever for somebody who writes.
    for args in [
        &["run".as_ref(), pipe][..],
        &["lint".as_ref(), model, "--capture".as_ref(), pipe],
        &["lint".as_ref(), model, "--baseline".as_ref(), pipe],
        &[
            "query".as_ref(),
            model,
            "--self".as_ref(),
            "--weights".as_ref(),
            at_pipe.as_ref(),
        ],
    ] {
        let message = error_of(&limited(args)?);
        let named = message.contains("pipe.json") && message.contains("not a regular file");
        assert!(
            named && (message.contains("--allow-any-path") || message.contains("@-")),
            "{args:?}: {message}"
        );
    }
    // With the option they are read, up to the limit.
    for args in [
        &["run".as_ref(), "/dev/zero".as_ref()][..],
        &["lint".as_ref(), model, "--capture".as_ref(), "/dev/zero".as_ref()],
        &["lint".as_ref(), model, "--baseline".as_ref(), "/dev/zero".as_ref()],
    ] {
        let limit = ["--allow-any-path".as_ref(), "--memory-limit".as_ref(), "16MiB".as_ref()];
        let message = error_of(&limited(&[args, &limit].concat())?);
        assert!(
            message.contains("/dev/zero") && message.contains("it is longer than"),
            "{args:?}: {message}"
        );
    }
    Ok(())
}

#[test]
fn the_text_the_models_and_the_frames_of_a_scene_share_the_memory_limit() -> TestResult {
    let dir = tempdir()?;
    write_gltf(dir.path(), "model.gltf", &[RawMesh::triangle("one")])?;
    let scene = dir.path().join("scene.json");
    let frames = vec!["[{}]"; 40_000].join(",");
    let text = format!(r#"{{"bodies": [{{"model": "model.gltf"}}], "frames": [{frames}]}}"#);
    std::fs::write(&scene, text)?;
    let mut messages = Vec::new();
    for mebibytes in (20..100).step_by(4) {
        let limit = format!("{mebibytes}MiB");
        let output = limited(&[
            "run".as_ref(),
            scene.as_os_str(),
            "--memory-limit".as_ref(),
            limit.as_ref(),
        ])?;
        if output.status.success() {
            break;
        }
        messages.push(error_of(&output));
    }
    let any = |says: &str| {
        messages
            .iter()
            .any(|message| message.contains(says) && message.contains("--memory-limit"))
    };
    assert!(any("scene.json: the scene would take"), "{messages:?}");
    assert!(any("scene.json: the scene's frames would take"), "{messages:?}");
    // A large text leaves nothing for a small model.
    let text = format!(
        r#"{{"comment": "{}", "bodies": [{{"model": "model.gltf"}}], "frames": [[{{}}]]}}"#,
        "x".repeat(1 << 20)
    );
    std::fs::write(&scene, text)?;
    let run = |limit: &str| {
        limited(&[
            "run".as_ref(),
            scene.as_os_str(),
            "--memory-limit".as_ref(),
            limit.as_ref(),
        ])
    };
    let message = error_of(&run("4198000")?);
    assert!(
        message.contains("model.gltf") && message.contains("4.0 MiB taken before"),
        "{message}"
    );
    assert!(run("5MiB")?.status.success());
    Ok(())
}

#[test]
fn deep_json_is_an_error() -> TestResult {
    let dir = tempdir()?;
    let scene = dir.path().join("scene.json");
    let [open, close] = ["[", "]"].map(|bracket| bracket.repeat(100_000));
    for text in [
        format!(r#"{{"bodies": [], "frames": {open}{close}}}"#),
        format!(r#"{{"bodies": [], "frames": [], "deep": {open}{close}}}"#),
    ] {
        std::fs::write(&scene, text)?;
        let message = error_of(&limited(&["run".as_ref(), scene.as_os_str()])?);
        assert!(
            message.contains("scene.json") && message.contains("line 1"),
            "{message}"
        );
    }
    let (_keep, model) = crate::lint::model(0.0)?;
    std::fs::write(&scene, format!(r#"{{"version":2,"accepted":[],"deep":{open}{close}}}"#))?;
    let baseline = [
        "lint".as_ref(),
        model.as_os_str(),
        "--baseline".as_ref(),
        scene.as_os_str(),
    ];
    // What it does not know is passed over, without recursion. The model has findings.
    let output = limited(&baseline)?;
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{told}");
    Ok(())
}

#[test]
fn a_model_and_a_clip_of_another_file_share_the_memory_limit() -> TestResult {
    let dir = tempdir()?;
    write_gltf(dir.path(), "model.gltf", &[RawMesh::triangle("one")])?;
    let model = dir.path().join("model.gltf");
    let library = dir.path().join("library.gltf");
    let gltf = json!({"asset": {"version": "2.0"}, "animations": [{"name": "walk"}], "extras": "x".repeat(1 << 20)});
    std::fs::write(&library, gltf.to_string())?;
    let clip = format!("{}#walk", library.display());
    let args = [
        "query".as_ref(),
        model.as_os_str(),
        "--self".as_ref(),
        "--clip".as_ref(),
        clip.as_ref(),
    ];
    let limit = ["--memory-limit".as_ref(), "1MiB".as_ref()];
    let message = error_of(&limited(&[&args[..], &limit].concat())?);
    assert!(
        message.contains("library.gltf: the file would take") && message.contains("--memory-limit"),
        "{message}"
    );
    Ok(())
}

/// What is beyond a limit on standard input is refused, and what is within it is read.
#[test]
fn a_model_from_standard_input_is_refused_for_its_length() -> TestResult {
    let dir = tempdir()?;
    let model = dir.path().join("model.gltf");
    std::fs::write(&model, collapsed(1).to_string())?;
    let length = std::fs::metadata(&model)?.len();
    let inspect = |limit: u64| {
        let mut command = Command::new(crate::PROGRAM_FILE);
        command.args(["inspect", "-", "--memory-limit", &limit.to_string()]);
        command.stdin(std::fs::File::open(&model)?).output()
    };
    let message = error_of(&inspect(4 * length - 4)?);
    assert!(
        message.contains("it is longer than") && message.contains("--memory-limit"),
        "{message}"
    );
    let output = inspect(1 << 20)?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}
