//! Clips of other files: `--clip FILE#NAME`.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::support::{TestResult, asset, command, error_of, stdout_of};

fn run(name: &str, args: &[&str], dir: &Path) -> Result<Output, Box<dyn Error>> {
    Ok(command().current_dir(dir).arg(name).args(args).output()?)
}

fn change(path: &Path, to: &Path, change: impl FnOnce(&mut Value)) -> TestResult {
    let mut gltf: Value = serde_json::from_slice(&std::fs::read(path)?)?;
    change(&mut gltf);
    std::fs::write(to, gltf.to_string())?;
    Ok(())
}

/// `model.gltf` is the model of `skins` without animations, and its nodes have names; `lib.gltf` has the animations and no meshes, in another
/// order of nodes.
fn model_and_library() -> Result<(TempDir, PathBuf), Box<dyn Error>> {
    let (dir, path) = crate::support::bound_and_free()?;
    let folder = dir.path().to_owned();
    change(&path, &folder.join("model.gltf"), |gltf| {
        gltf["nodes"][2]["name"] = "face".into();
        gltf["nodes"][3]["name"] = "free".into();
        gltf["animations"] = json!([]);
    })?;
    change(&path, &folder.join("lib.gltf"), |gltf| {
        gltf["nodes"] = json!([{"name": "tail"}, {"name": "face"}, {"name": "lift"}, {}]);
        for key in ["meshes", "skins"] {
            gltf.as_object_mut().map(|file| file.remove(key));
        }
        let channels = [
            (0, 2, "translation"),
            (1, 1, "weights"),
            (0, 0, "translation"),
            (0, 3, "translation"),
        ];
        gltf["animations"][0]["channels"] = channels
            .map(|(sampler, node, path)| json!({"sampler": sampler, "target": {"node": node, "path": path}}))
            .to_vec()
            .into();
    })?;
    Ok((dir, folder))
}

/// The height at which a ray from 9 above hits the first triangle, and what was said.
fn height(clip: &str, time: &str, dir: &Path) -> Result<(Option<f64>, String), Box<dyn Error>> {
    let ray = [
        "model.gltf",
        "--clip",
        clip,
        "--time",
        time,
        "--ray",
        "10.25,0.25,9,0,0,-1",
        "--json",
    ];
    let output = run("query", &ray, dir)?;
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    let answer: Value = serde_json::from_slice(&output.stdout).map_err(|_| told.clone())?;
    Ok((answer["hits"][0]["t"].as_f64().map(|t| 9.0 - t), told))
}

#[test]
fn joints_and_weights_play_a_clip_of_a_library_without_meshes() -> TestResult {
    let (_dir, folder) = model_and_library()?;
    for clip in ["lib.gltf#rise", "lib.gltf#0", "lib.gltf"] {
        // The joint lifts it by 2, and the target by a half.
        let (found, told) = height(clip, "0.5", &folder)?;
        assert_eq!(found, Some(2.5), "{clip}");
        assert_eq!(told.lines().count(), 2, "{told}");
        assert!(
            told.contains("animation \"rise\": the model has nothing of the name of \"tail\"\n"),
            "{told}"
        );
        assert!(told.contains("1 channel moves a node without a name"), "{told}");
    }
    assert_eq!(
        height("lib.gltf#rise", "9", &folder)?.0,
        Some(5.0),
        "it ends in its last pose"
    );
    Ok(())
}

#[test]
fn all_commands_and_scene_files_take_a_clip_of_another_file() -> TestResult {
    let (_dir, folder) = model_and_library()?;
    std::fs::create_dir(folder.join("scenes"))?;
    let clip = ["model.gltf", "--clip", "lib.gltf#rise"];
    let said_once = |output: &Output| {
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{told}");
        assert_eq!(told.matches("\"tail\"").count(), 1, "{told}");
    };
    let sweep = run("sweep", &[&clip[..], &["--fps", "4", "--json"]].concat(), &folder)?;
    said_once(&sweep);
    assert_eq!(serde_json::from_slice::<Value>(&sweep.stdout)?["frames"], 5);
    said_once(&run(
        "lint",
        &[&clip[..], &["--mesh", "0", "--mixtures", "0"]].concat(),
        &folder,
    )?);
    said_once(&run(
        "export",
        &[&clip[..], &["--time", "0.5", "--output", "out.obj"]].concat(),
        &folder,
    )?);
    assert!(std::fs::read_to_string(folder.join("out.obj"))?.contains("v 10 0 2.5 "));
    said_once(&run(
        "scene",
        &[&clip[..], &["--fps", "4", "--output", "scenes/rise.json"]].concat(),
        &folder,
    )?);
    let scene: Value = serde_json::from_slice(&std::fs::read(folder.join("scenes/rise.json"))?)?;
    assert_eq!(scene["frames"][1][0]["clip"], "../lib.gltf#rise");
    said_once(&run(
        "export",
        &["scenes/rise.json", "--frame", "2", "--output", "of_scene.obj"],
        &folder,
    )?);
    assert!(std::fs::read_to_string(folder.join("of_scene.obj"))?.contains("v 10 0 2.5 "));
    Ok(())
}

/// It was an error, although a clip of the model's own file with such a channel is played.
#[test]
fn channels_that_are_not_applied_are_named_and_the_others_are_played() -> TestResult {
    let (_dir, folder) = model_and_library()?;
    let lib = folder.join("lib.gltf");
    let pointer = "/nodes/0/extensions/KHR_node_visibility/visible";
    change(&lib, &lib, |gltf| {
        let target = json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}});
        gltf["animations"][0]["channels"][3] = json!({"sampler": 0, "target": target});
        gltf["extensionsUsed"] = json!(["KHR_animation_pointer", "KHR_node_visibility"]);
    })?;
    let (found, told) = height("lib.gltf#rise", "0.5", &folder)?;
    assert_eq!(found, Some(2.5));
    assert!(
        told.contains(&format!("animation \"rise\": does not apply \"{pointer}\"\n")),
        "{told}"
    );
    Ok(())
}

/// The copy is the model's own file under another name.
#[test]
fn a_character_moves_as_by_its_own_clip() -> TestResult {
    let dir = tempfile::tempdir()?;
    for name in ["own.glb", "copy#1.glb"] {
        std::fs::copy(asset("mh_character_low.glb"), dir.path().join(name))?;
    }
    let out = |name: &str, args: &[&str]| {
        let args = [&["own.glb", "--time", "1.0", "--output", name], args].concat();
        stdout_of(&run("export", &args, dir.path())?);
        Ok::<_, Box<dyn Error>>(std::fs::read(dir.path().join(name))?)
    };
    for clip in ["talk", "wave_and_crouch"] {
        let own = out("a.ply", &["--clip", clip])?;
        assert!(
            own == out("b.ply", &["--clip", &format!("copy#1.glb#{clip}")])?,
            "{clip}"
        );
    }
    Ok(())
}

#[test]
fn what_does_not_fit_is_said() -> TestResult {
    let (_dir, folder) = model_and_library()?;
    let lib = folder.join("lib.gltf");
    change(&lib, &folder.join("other.gltf"), |gltf| {
        for node in [0, 1, 2] {
            gltf["nodes"][node]["name"] = format!("bone_{node}").into();
        }
        let mut second = gltf["animations"][0].clone();
        second["name"] = "fall".into();
        second["samplers"][0]["output"] = 99.into();
        gltf["animations"] = json!([gltf["animations"][0], second]);
    })?;
    for (clip, parts) in [
        ("absent.glb#rise", &["absent.glb"][..]),
        (
            "lib.gltf#ries",
            &["lib.gltf has no animation \"ries\"; it has \"rise\"; did you mean \"rise\"?"],
        ),
        ("other.gltf", &["several animations", "\"rise\", \"fall\""]),
        (
            "other.gltf#rise",
            &[
                "fits no node that moves this mesh",
                "\"bone_0\"",
                "\"the weights of bone_1\"",
            ],
        ),
        ("other.gltf#fall", &["other.gltf: animation 1 \"fall\": channel 0"]),
        ("model.gltf#rise", &["has no animations"]),
    ] {
        for (name, args) in [("query", &["--self"][..]), ("sweep", &[]), ("lint", &["--mesh", "0"])] {
            let args = [&["model.gltf", "--clip", clip], args].concat();
            let message = error_of(&run(name, &args, &folder)?);
            for part in parts {
                assert!(
                    message.contains("--clip") && message.contains(part),
                    "{name} {clip}: no {part:?} in {message}"
                );
            }
        }
    }
    // Nothing but the first of two nodes with one name is moved.
    change(&folder.join("model.gltf"), &folder.join("model.gltf"), |gltf| {
        gltf["nodes"][0]["name"] = "lift".into();
    })?;
    let (_, told) = height("lib.gltf#rise", "0.5", &folder)?;
    assert!(
        told.contains("several nodes of the model are named \"lift\"; the first one counts"),
        "{told}"
    );
    Ok(())
}

#[test]
fn targets_are_matched_by_their_names() -> TestResult {
    let dir = tempfile::tempdir()?;
    let mut mesh = morph_collision_models::generated::dolphin(0);
    let looks = morph_collision_models::gltf::write::Appearance::default();
    let write =
        |name: &str, mesh: &_| morph_collision_models::gltf::write::write_glb(&dir.path().join(name), mesh, &looks);
    mesh.name = "dolphin".to_owned();
    write("lib.glb", &mesh)?;
    mesh.target_names = vec!["smile".to_owned(), mesh.target_names[0].clone()];
    mesh.targets.swap(0, 1);
    mesh.animations.clear();
    write("model.glb", &mesh)?;
    let args = [
        "model.glb",
        "--clip",
        "lib.glb#swim",
        "--time",
        "0.4",
        "--point",
        "0,0,0",
        "--json",
    ];
    let output = run("query", &args, dir.path())?;
    let answer: Value = serde_json::from_slice(&output.stdout)?;
    assert_eq!(answer["shape"]["weights"], json!([0.0, 1.0]));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        told.contains("the model has nothing of the name of \"target tail_up of dolphin\""),
        "{told}"
    );
    Ok(())
}
