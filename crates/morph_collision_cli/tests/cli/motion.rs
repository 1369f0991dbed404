//! `motion` finds what touches between two frames, however fast bodies move.

use std::error::Error;
use std::ffi::OsString;
use std::path::Path;

use morph_collision_models::scenes::{BodyState, Scene, SceneBody};
use serde_json::Value;
use tempfile::tempdir;

use crate::support::{TestResult, asset, run_program, stdout_of};

/// Two dolphins. The second one is at these places, one in each frame.
fn write_scene(path: &Path, places: &[[f32; 3]]) -> TestResult {
    let state = |translation: [f32; 3]| BodyState {
        translation: Some(translation),
        ..BodyState::default()
    };
    let body = || SceneBody {
        model: asset("dolphin_564.glb"),
        ..SceneBody::default()
    };
    let scene = Scene {
        bodies: vec![body(), body()],
        frames: places.iter().map(|&at| vec![state([0.0; 3]), state(at)]).collect(),
        ..Scene::default()
    };
    Ok(scene.write(path)?)
}

fn motion(scene: &Path, options: &[&str]) -> Result<String, Box<dyn Error>> {
    let mut args: Vec<OsString> = vec!["motion".into(), scene.into()];
    args.extend(options.iter().map(Into::into));
    Ok(stdout_of(&run_program(args)?))
}

#[test]
fn a_dolphin_that_passes_through_another_in_one_step_is_noticed() -> TestResult {
    let dir = tempdir()?;
    let path = dir.path().join("scene.json");
    // Far away, past the other one, through it, and back to where it starts inside.
    write_scene(
        &path,
        &[
            [0.0, 50.0, 0.0],
            [0.0, 50.0, 60.0],
            [0.0, -50.0, -60.0],
            [0.0, 0.1, 0.0],
            [0.0, 0.2, 0.0],
        ],
    )?;
    let report: Value = serde_json::from_str(&motion(&path, &["--json", "--count"])?)?;
    let contacts = report["contacts"].as_array().ok_or("no contacts")?;
    let frames: Vec<_> = contacts.iter().map(|contact| contact["frame"].as_u64()).collect();
    assert_eq!(frames, [Some(1), Some(2), Some(3)]);
    let time =
        |contact: &Value| [contact["earliest"].as_f64(), contact["latest"].as_f64()].map(Option::unwrap_or_default);
    let [earliest, latest] = time(&contacts[0]);
    assert!(
        earliest > 0.45 && latest < 0.5 && latest - earliest <= 1e-6,
        "{earliest} {latest}"
    );
    assert!(contacts[0]["pairs"].as_u64() > Some(100), "{}", contacts[0]);
    let features = contacts[0]["features"].as_str();
    assert!(
        matches!(features, Some("vertex_face" | "face_vertex" | "edge_edge")),
        "{features:?}"
    );
    // The second dolphin comes from above, so the first one leaves it downwards and moves up towards it.
    let vector = |name: &str| -> Vec<f64> {
        let numbers = contacts[0][name].as_array().into_iter().flatten();
        numbers.filter_map(Value::as_f64).collect()
    };
    let (point, normal, velocity) = (vector("point"), vector("normal"), vector("velocity"));
    assert!(point.iter().all(|x| x.abs() < 3.0), "{point:?}");
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    let approach = normal.iter().zip(&velocity).map(|(n, v)| n * v).sum::<f64>();
    assert!(
        (length - 1.0).abs() < 1e-12 && approach < -1.0,
        "{normal:?} {velocity:?}"
    );
    assert_eq!(velocity.len(), 3);
    assert_eq!(
        (time(&contacts[2]), contacts[2]["features"].as_str()),
        ([0.0; 2], Some("at_start"))
    );
    // The same in words, and a coarser time.
    let text = motion(&path, &["--tolerance", "0.1"])?;
    assert!(
        text.starts_with("steps: 4, bodies: 2, first contacts: 3\nframe 1 to 2, bodies 0 and 1, at 0.4"),
        "{text}"
    );
    assert!(text.contains("intersect at the start, at ("), "{text}");
    assert_eq!(text.matches("), normal (").count(), 3, "{text}");
    Ok(())
}

#[test]
fn what_stays_apart_has_no_contact_and_a_wrong_tolerance_is_refused() -> TestResult {
    let dir = tempdir()?;
    let path = dir.path().join("scene.json");
    write_scene(&path, &[[0.0, 50.0, 0.0], [10.0, 50.0, 60.0]])?;
    let text = motion(&path, &[])?;
    assert!(text.starts_with("steps: 1, bodies: 2, first contacts: 0\n"), "{text}");
    let refused = run_program([
        "motion".into(),
        path.into_os_string(),
        "--tolerance".into(),
        OsString::from("0"),
    ])?;
    let complaint = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        complaint.contains("it must be more than 0 and at most 1"),
        "{complaint}"
    );
    Ok(())
}
