//! `run` finds what the oracle finds. Its modes and options change how much is reported, not the
//! answer.

use std::error::Error;
use std::ffi::OsString;
use std::path::Path;

use glam::{Affine3A, Vec3};
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::scenes::{BodyState, Scene, SceneBody};
use morph_collision_models::weight_list::TargetNames;
use morph_collision_testkit::oracle::{BodyPose, scene_pairs};
use serde_json::Value;
use tempfile::tempdir;

use crate::support::{TestResult, asset, command, mixed_scene, run_program, stdout_of};

/// A row of the CSV file: frame, bodies, triangles.
type Row = (usize, u32, u32, u32, u32);

/// Runs a scene and returns its JSON and the text of its CSV file.
fn run(scene: &Path, options: &[&str]) -> Result<(Value, String), Box<dyn Error>> {
    let dir = tempdir()?;
    let csv = dir.path().join("pairs.csv");
    let mut args: Vec<OsString> = vec![
        "run".into(),
        scene.into(),
        "--json".into(),
        "--pairs".into(),
        csv.clone().into(),
    ];
    args.extend(options.iter().map(Into::into));
    let stdout = stdout_of(&run_program(args)?);
    Ok((serde_json::from_str(&stdout)?, std::fs::read_to_string(csv)?))
}

fn rows(csv: &str) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("frame,body_a,body_b,triangle_a,triangle_b"));
    lines
        .map(|line| {
            let fields: Vec<u32> = line.split(',').map(str::parse).collect::<Result<_, _>>()?;
            match fields[..] {
                [frame, body_a, body_b, triangle_a, triangle_b] => {
                    Ok((frame as usize, body_a, body_b, triangle_a, triangle_b))
                }
                _ => Err(format!("not five fields: {line}").into()),
            }
        })
        .collect()
}

fn expected_rows(path: &Path) -> Result<Vec<Row>, Box<dyn Error>> {
    let scene = Scene::read(path)?;
    let mut meshes: Vec<MorphMesh> = Vec::new();
    for body in &scene.bodies {
        meshes.push(read_meshes(&body.model_path(path))?.swap_remove(body.mesh));
    }
    let mut rows = Vec::new();
    for (frame, states) in scene.frames.iter().enumerate() {
        let weights = |(mesh, state): (&MorphMesh, &BodyState)| {
            TargetNames::new(&mesh.target_names).resolve(&state.weights, mesh.weights_at_rest())
        };
        let weights: Vec<Vec<f32>> = meshes.iter().zip(states).map(weights).collect::<Result<_, _>>()?;
        let bodies: Vec<_> = states
            .iter()
            .enumerate()
            .map(|(body, state)| BodyPose {
                mesh: &meshes[body],
                weights: &weights[body],
                world_from_model: state.world_from_model(),
                joints: None,
            })
            .collect();
        for pair in scene_pairs(&bodies) {
            rows.extend(
                pair.triangles
                    .iter()
                    .map(|&(a, b)| (frame, pair.body_a, pair.body_b, a, b)),
            );
        }
    }
    Ok(rows)
}

fn sum(report: &Value, field: &str) -> Option<u64> {
    report[field].as_array()?.iter().map(Value::as_u64).sum()
}

#[test]
fn two_dolphins_meet_where_the_oracle_says() -> TestResult {
    let scene = asset("scenes/two_dolphins.json");
    let (report, csv) = run(&scene, &[])?;
    let expected = expected_rows(&scene)?;
    assert!(!expected.is_empty());
    assert_eq!(rows(&csv)?, expected);
    assert_eq!(report["bodies"], 2);
    assert_eq!(report["frames"], Scene::read(&scene)?.frames.len());
    Ok(())
}

#[test]
fn mirrored_flat_rigid_and_many_part_bodies_meet_where_the_oracle_says() -> TestResult {
    let dir = tempdir()?;
    let scene = mixed_scene(dir.path())?;
    let (report, csv) = run(&scene, &[])?;
    let expected = expected_rows(&scene)?;
    assert!(expected.len() > 1000, "{} pairs try little", expected.len());
    assert!(
        expected.iter().any(|row| row.2 == 2 && row.4 >= 12),
        "the second primitive must be touched"
    );
    assert_eq!(rows(&csv)?, expected);

    for frame in 0..6 {
        let of_frame = expected.iter().filter(|row| row.0 == frame);
        assert_eq!(report["pairs"][frame], of_frame.clone().count());
        let mut body_pairs: Vec<_> = of_frame.map(|row| (row.1, row.2)).collect();
        body_pairs.dedup();
        assert_eq!(report["body_pairs"][frame], body_pairs.len());
    }
    Ok(())
}

#[test]
fn a_real_face_capture_meets_where_the_oracle_says() -> TestResult {
    let models = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/models"));
    let model = models.join("mh_head_eyes_teeth_arkit52_dao.glb");
    if !model.exists() {
        println!("skipped: there is no {}", model.display());
        return Ok(());
    }
    let meshes = read_meshes(&model)?;
    let clip = &meshes[0].animations[0];
    let size = meshes[0].positions.iter().fold(0f32, |size, p| size.max(p.x.abs()));
    let frames = [0.5f32, 1.7].map(|seconds| {
        let place = Affine3A::from_translation(Vec3::new(1.7 * size, 0.1 * size, 0.0));
        vec![
            BodyState::rigid(&clip.sample(seconds), &Affine3A::IDENTITY),
            BodyState::rigid(&clip.sample(seconds + 0.4), &place),
        ]
    });
    let dir = tempdir()?;
    let scene = dir.path().join("scene.json");
    let bodies = vec![
        SceneBody {
            model: std::fs::canonicalize(&model)?,
            ..SceneBody::default()
        };
        2
    ];
    Scene {
        bodies,
        frames: frames.to_vec(),
        ..Scene::default()
    }
    .write(&scene)?;
    let expected = expected_rows(&scene)?;
    assert!(!expected.is_empty());
    assert_eq!(rows(&run(&scene, &[])?.1)?, expected);
    Ok(())
}

#[test]
fn first_gives_one_true_pair_per_touching_pair_of_bodies() -> TestResult {
    let dir = tempdir()?;
    let scene = mixed_scene(dir.path())?;
    let all = rows(&run(&scene, &[])?.1)?;
    let (report, csv) = run(&scene, &["--mode", "first"])?;
    let first = rows(&csv)?;
    let mut touching: Vec<_> = all.iter().map(|row| (row.0, row.1, row.2)).collect();
    touching.dedup();
    assert_eq!(
        first.iter().map(|row| (row.0, row.1, row.2)).collect::<Vec<_>>(),
        touching
    );
    assert!(first.iter().all(|row| all.contains(row)));
    assert_eq!(sum(&report, "pairs"), Some(touching.len() as u64));
    assert_eq!(report["pairs"], report["body_pairs"]);
    Ok(())
}

#[test]
fn any_names_the_touching_bodies_and_a_pair_of_triangles_as_first_does() -> TestResult {
    let scene = asset("scenes/two_dolphins.json");
    let (first, of_first) = run(&scene, &["--mode", "first"])?;
    let (any, csv) = run(&scene, &["--mode", "any"])?;
    assert_eq!(any["body_pairs"], first["body_pairs"]);
    assert_eq!(csv, of_first);
    assert_eq!(rows(&csv)?.len() as u64, sum(&any, "body_pairs").unwrap_or(0));
    Ok(())
}

#[test]
fn the_leaf_size_changes_the_work_and_not_the_answer() -> TestResult {
    let scene = asset("scenes/two_dolphins.json");
    let (small, csv_small) = run(&scene, &["--leaf", "1"])?;
    let (large, csv_large) = run(&scene, &["--leaf", "40"])?;
    assert_eq!(csv_small, csv_large);
    assert!(small["triangle_tests"].as_u64() < large["triangle_tests"].as_u64());
    assert!(small["node_tests"].as_u64() > large["node_tests"].as_u64());
    Ok(())
}

#[test]
fn the_json_counts_the_work_and_the_time() -> TestResult {
    let (report, _) = run(&asset("scenes/two_dolphins.json"), &[])?;
    for field in ["node_tests", "triangle_tests", "nodes_blended", "vertices_blended"] {
        assert!(report[field].as_u64() > Some(0), "{field}: {report}");
    }
    let times = ["median", "mean", "worst"].map(|which| report["us_per_frame"][which].as_f64());
    assert!(times.iter().all(|time| *time > Some(0.0)), "{report}");
    assert!(times[0] <= times[2] && times[1] <= times[2], "{report}");
    Ok(())
}

#[test]
fn the_summary_is_readable_and_a_scene_without_frames_is_one() -> TestResult {
    let dir = tempdir()?;
    let scene = dir.path().join("scene.json");
    std::fs::write(&scene, r#"{"bodies": [], "frames": []}"#)?;
    let stdout = stdout_of(&run_program(["run".as_ref(), scene.as_os_str()])?);
    assert!(stdout.contains("frames touching     0\n"), "{stdout}");
    let stdout = stdout_of(&run_program([
        "run".as_ref(),
        asset("scenes/two_dolphins.json").as_os_str(),
    ])?);
    assert!(
        stdout.contains("bodies              2\n") && stdout.contains("time per frame"),
        "{stdout}"
    );
    Ok(())
}

#[test]
fn a_reader_that_has_left_is_no_error() -> TestResult {
    let mut child = command()
        .args(["run", "--json"])
        .arg(asset("scenes/two_dolphins.json"))
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()?;
    drop(child.stdout.take());
    let output = child.wait_with_output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}
