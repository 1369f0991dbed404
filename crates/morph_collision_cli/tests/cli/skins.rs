//! Skinned meshes in every command that collides them: their joints at rest and in clips.

use std::path::Path;

use morph_collision_models::generated::rigs::tube;
use morph_collision_models::gltf::write::{Appearance, to_glb};
use serde_json::{Value, json};
use tempfile::tempdir;

use crate::support::{TestResult, bound_and_free, error_of, field, run_program, stdout_of};

fn json_of(args: &[&str], path: &Path) -> Result<Value, Box<dyn std::error::Error>> {
    let mut all = vec![args[0].as_ref(), path.as_os_str(), "--json".as_ref()];
    all.extend(args[1..].iter().map(AsRef::<std::ffi::OsStr>::as_ref));
    Ok(serde_json::from_str(&stdout_of(&run_program(all)?))?)
}

#[test]
fn inspect_tells_the_joints_and_their_clips() -> TestResult {
    let (_dir, path) = bound_and_free()?;
    let report = json_of(&["inspect"], &path)?;
    let [bound, free] = [&report["meshes"][0], &report["meshes"][1]];
    assert_eq!((&bound["skinned"], &free["skinned"]), (&true.into(), &false.into()));
    assert_eq!(free.get("skin"), None);
    let skin = &bound["skin"];
    assert_eq!(skin["joints"], json!(["lift"]));
    assert_eq!(
        (&skin["most_influences"], &skin["weight_sum"]["min"]),
        (&1.into(), &json!(1.0))
    );
    assert_eq!(
        skin["clips"],
        json!([{"animation": 0, "name": "rise", "seconds": 1.0, "nodes_moved": 1}])
    );
    assert_eq!(bound.get("warnings"), None);
    let text = stdout_of(&run_program(["inspect".as_ref(), path.as_os_str()])?);
    assert!(
        text.contains("1 joints; vertices by number of joints that move them: 1: 3\n")
            && text.contains("joint weights sum to 1")
            && text.contains("joints in animation 0 \"rise\": 1.000 s"),
        "{text}"
    );
    Ok(())
}

#[test]
fn inspect_says_that_engines_draw_four_joints_per_vertex() -> TestResult {
    let dir = tempdir()?;
    for (influences, is_said) in [(4, false), (6, true)] {
        let path = dir.path().join(format!("{influences}.glb"));
        std::fs::write(&path, to_glb(&tube(1, 8, influences, 0), &Appearance::default())?)?;
        let text = stdout_of(&run_program(["inspect".as_ref(), path.as_os_str()])?);
        let line = "engines that draw four joints per vertex, such as Bevy, show something else";
        assert_eq!(text.contains(line), is_said, "{text}");
    }
    let twelve = field("c01_twelve_influences.glb");
    let report = json_of(&["inspect"], &twelve)?;
    assert_eq!(report["meshes"][0]["skin"]["most_influences"], 12, "{report}");
    // A third of the weights was dropped.
    assert_eq!(report["meshes"][0]["skin"]["vertices_not_summing_to_1"], 0, "{report}");
    Ok(())
}

#[test]
fn a_mesh_whose_skin_is_broken_says_so() -> TestResult {
    let (_dir, path) = bound_and_free()?;
    let mut gltf: Value = serde_json::from_slice(&std::fs::read(&path)?)?;
    gltf["skins"][0]["joints"] = json!([7]);
    std::fs::write(&path, gltf.to_string())?;
    let report = json_of(&["inspect"], &path)?;
    let error = report["meshes"][0]["error"].as_str().unwrap_or_default();
    assert!(
        error.contains("its skin cannot be read: node 7 does not exist"),
        "{error}"
    );
    let query = ["query".as_ref(), path.as_os_str(), "--self".as_ref()];
    let error = error_of(&run_program(query)?);
    assert!(error.contains("the skin of mesh 0 \"Bound\": node 7"), "{error}");
    Ok(())
}

#[test]
fn a_query_finds_a_mesh_where_its_joints_put_it() -> TestResult {
    let (_dir, path) = bound_and_free()?;
    let t = |flags: &[&str]| {
        let ray = ["--ray", "10.25,0.25,9,0,0,-1"];
        let answer = json_of(&[&["query"], flags, &ray].concat(), &path)?;
        Ok::<_, Box<dyn std::error::Error>>(answer["hits"][0]["t"].as_f64())
    };
    assert_eq!(t(&[])?, Some(9.0));
    // The joint lifts it by 2 and the target by a half.
    assert_eq!(t(&["--clip", "rise", "--time", "0.5"])?, Some(6.5));
    assert_eq!(t(&["--clip", "rise", "--time", "1.5", "--weights", "0"])?, Some(5.0));
    assert_eq!(t(&["--weights", "1"])?, Some(8.0));
    let flags = [
        "query".as_ref(),
        path.as_os_str(),
        "--self".as_ref(),
        "--clip".as_ref(),
        "fall".as_ref(),
    ];
    let error = error_of(&run_program(flags)?);
    assert!(
        error.contains("no clip \"fall\"") && error.contains("the mesh has \"rise\""),
        "{error}"
    );
    Ok(())
}

#[test]
fn a_scene_poses_joints_by_a_clip_and_a_time() -> TestResult {
    let (dir, path) = bound_and_free()?;
    let scene = |frames: Value| {
        let model = path.file_name().map(|name| name.to_string_lossy());
        let scene = json!({"bodies": [{"model": model}, {"model": model, "mesh": 1}], "frames": frames});
        let path = dir.path().join("scene.json");
        std::fs::write(&path, scene.to_string()).map(|()| path)
    };
    // The second triangle is placed where the first one is expected.
    let there = |z: f32| json!({"translation": [10, 0, z]});
    let frames = json!([
        [{}, there(0.0)],
        [{}, {}],
        [{"clip": "rise", "time": 0.5}, there(2.5)],
        [{"clip": "rise", "time": 0.5, "weights": [0]}, there(2.0)],
        [{"clip": "rise", "time": 1.25, "scale": [1, 1, 2], "translation": [0, 0, 1]}, there(11.0)],
        [{"clip": "rise", "time": 0.5}, {"clip": "rise", "translation": [10, 0, 1], "weights": [1.5]}],
    ]);
    let path = scene(frames.clone())?;
    // The clip does not move the second triangle.
    let error = error_of(&run_program(["run".as_ref(), path.as_os_str()])?);
    assert!(
        error.contains("frame 5, body 1") && error.contains("\"rise\" does not move this mesh"),
        "{error}"
    );
    let mut right = frames;
    right[5][1]["clip"].take();
    let path = scene(right)?;
    assert_eq!(json_of(&["run"], &path)?["pairs"], json!([1, 0, 1, 1, 1, 1]));
    let picture = dir.path().join("picture.png");
    let path = scene(json!([[{"clip": "rise", "time": 0.5}, there(2.5)]]))?;
    let drawn = json_of(&["run", "--picture", &picture.to_string_lossy()], &path)?;
    assert_eq!(drawn["picture"]["touching_triangles"], 2);
    Ok(())
}
