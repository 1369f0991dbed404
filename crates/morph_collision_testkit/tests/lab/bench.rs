//! `bench` measures methods against each other. No test asserts how fast anything is.

use std::error::Error;

use serde_json::Value;

use crate::support::{TestResult, asset, command, data, error_of, run_program};

/// Runs `bench` as briefly as possible.
fn bench(args: &[&str]) -> Result<Value, Box<dyn Error>> {
    let args = [&["bench", "--json", "--rounds", "1", "--every", "200"], args].concat();
    // If the thread cannot be pinned, stderr says so; nothing else changes.
    let output = command().args(args).output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn list<'a>(value: &'a Value, key: &str) -> Result<&'a Vec<Value>, String> {
    value[key]
        .as_array()
        .ok_or_else(|| format!("no list of {key} in {value}"))
}

#[test]
fn every_method_has_a_row_and_all_find_the_same_pairs() -> TestResult {
    let report = bench(&["--scene", "dolphins-564"])?;
    assert!(report["cpu"].is_string() && report["kernel"].is_string() && report["rounds"] == 1);
    let scenes = list(&report, "scenes")?;
    let modes: Vec<_> = scenes.iter().map(|scene| &scene["mode"]).collect();
    assert_eq!(modes, ["all", "first"]);
    for scene in scenes {
        assert_eq!(scene["name"], "dolphins-564");
        assert!(scene["bodies"] == 12 && scene["triangles"] == 564, "{scene}");
        let methods = list(scene, "methods")?;
        let names: Vec<_> = methods.iter().filter_map(|method| method["name"].as_str()).collect();
        assert_eq!(names[0], "morph");
        for name in [
            "hybrid",
            "bottom-up",
            "rigid-floor",
            "paper",
            "hybrid-scalar",
            "hybrid-binary",
            "bottom-up-scalar",
            "parry-trimesh",
        ] {
            assert!(names.contains(&name), "no {name} in {names:?}");
        }
        for method in methods {
            assert_eq!(method["pairs"], methods[0]["pairs"], "{method}");
            for time in ["blend_us", "refit_us", "query_us", "total_us"] {
                assert!(
                    method[time].as_f64().is_some_and(|time| time >= 0.0),
                    "{time} in {method}"
                );
            }
        }
        assert!(methods[0]["pairs"].as_u64() > Some(0));
    }
    Ok(())
}

#[test]
fn models_scenes_methods_and_modes_can_be_chosen() -> TestResult {
    let model = asset("dolphin_564.glb");
    let model = model.to_str().ok_or("not UTF-8")?;
    let report = bench(&[model, "--bodies", "3", "--method", "hybrid", "--mode", "first"])?;
    let scenes = list(&report, "scenes")?;
    assert_eq!(scenes.len(), 1);
    assert!(
        scenes[0]["name"] == "dolphin_564" && scenes[0]["bodies"] == 3,
        "{report}"
    );
    let names: Vec<_> = list(&scenes[0], "methods")?
        .iter()
        .map(|method| &method["name"])
        .collect();
    assert_eq!(names, ["morph", "hybrid"]);
    Ok(())
}

#[test]
fn a_skinned_model_plays_its_clip_against_the_methods_for_skins() -> TestResult {
    let (_dir, path) = crate::support::bound_and_free()?;
    let model = path.to_str().ok_or("not UTF-8")?;
    let report = bench(&[model, "--mode", "all"])?;
    let scene = &list(&report, "scenes")?[0];
    let methods = list(scene, "methods")?;
    let names: Vec<_> = methods.iter().filter_map(|method| method["name"].as_str()).collect();
    for name in [
        "morph",
        "hybrid",
        "bottom-up",
        "bottom-up-scalar",
        "joint-boxes",
        "rigid-floor",
        "parry-trimesh",
    ] {
        assert!(names.contains(&name), "no {name} in {names:?}");
    }
    // It does not support joints.
    assert!(!names.contains(&"paper"), "{names:?}");
    for method in methods {
        assert_eq!(method["pairs"], methods[0]["pairs"], "{method}");
    }
    Ok(())
}

#[test]
fn talking_heads_are_among_the_scenes() -> TestResult {
    let report = bench(&["--scene", "heads-crowd", "--method", "hybrid"])?;
    let scenes = list(&report, "scenes")?;
    assert_eq!(scenes.len(), 2);
    for scene in scenes {
        assert!(scene["name"] == "heads-crowd" && scene["triangles"] == 9534, "{scene}");
        let methods = list(scene, "methods")?;
        assert!(methods[0]["pairs"].as_u64() > Some(0) && methods.len() == 2, "{scene}");
    }
    Ok(())
}

#[test]
fn the_papers_method_takes_its_volumes() -> TestResult {
    let paper = ["--scene", "dolphins-564", "--method", "paper", "--mode", "all"];
    for volume in ["kdop26", "sphere"] {
        let report = bench(&[&paper[..], &["--volume", volume, "--in-betweens"]].concat())?;
        let methods = list(&list(&report, "scenes")?[0], "methods")?;
        assert_eq!(methods[1]["name"], "paper");
        assert!(methods[1]["pairs"] == methods[0]["pairs"] && methods[0]["pairs"].as_u64() > Some(0));
    }
    Ok(())
}

#[test]
fn the_tables_say_what_the_numbers_are() -> TestResult {
    let args = [
        "bench",
        "--scene",
        "dolphins-564",
        "--method",
        "hybrid",
        "--rounds",
        "1",
        "--every",
        "200",
    ];
    let output = run_program(args)?;
    let text = String::from_utf8(output.stdout)?;
    assert!(
        text.contains("microseconds per frame") && text.contains("/ morph"),
        "{text}"
    );
    Ok(())
}

#[test]
fn wrong_names_and_files_are_told_and_what_there_is() -> TestResult {
    let error = |args: &[&str]| Ok::<_, Box<dyn Error>>(error_of(&run_program([&["bench"], args].concat())?));
    let scene = error(&["--scene", "dolphin-564"])?;
    assert!(
        scene.contains("'dolphin-564'") && scene.contains("dolphins-564, dolphins-9024"),
        "{scene}"
    );
    assert!(
        scene.contains("heads-cheek, heads-crowd, horse-gallop, samba"),
        "{scene}"
    );
    let method = error(&["--method", "hybird"])?;
    assert!(
        method.contains("'hybird'") && method.contains("hybrid-binary"),
        "{method}"
    );
    let volume = error(&["--volume", "cube"])?;
    assert!(volume.contains("'cube'") && volume.contains("aabb, kdop14"), "{volume}");
    let volume = error(&["--method", "hybrid", "--volume", "kdop18"])?;
    assert!(volume.contains("--volume") && volume.contains("paper"), "{volume}");
    let model = error(&["absent.glb"])?;
    assert!(model.contains("absent.glb"), "{model}");
    let bodies = error(&["--bodies", "3"])?;
    assert!(bodies.contains("MODELS"), "{bodies}");
    let rounds = error(&["--rounds", "0"])?;
    assert!(rounds.contains("--rounds"), "{rounds}");
    Ok(())
}

#[test]
fn options_about_files_need_a_file() -> TestResult {
    for option in [&["--memory-limit", "2GiB"][..], &["--allow-any-path"], &["--skip-bad"]] {
        let message = error_of(&run_program(["bench"].iter().chain(option).copied())?);
        assert!(message.contains(option[0]) && message.contains("no model"), "{message}");
    }
    Ok(())
}

#[test]
fn a_bad_clip_spoils_only_itself() -> TestResult {
    // Its only clip has a sampler whose interpolation is a number.
    let model = data("c47_interpolation_is_a_number.glb");
    let args = ["--every", "100", "--rounds", "1"];
    let output = command().arg("bench").arg(&model).args(args).output()?;
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    assert!(told.contains("warning: left out: "), "{told}");
    assert_eq!(told.matches("animation 0 \"clip\"").count(), 1, "{told}");
    Ok(())
}
