//! Output files never replace an input, and an earlier file stays as it was if a command fails.

use std::error::Error;
use std::path::Path;

use serde_json::json;
use tempfile::tempdir;

use crate::support::{RawMesh, TestResult, error_of, run_program, stdout_of, write_gltf, write_scene};

fn run(scene: &Path, pairs: &Path) -> Result<std::process::Output, Box<dyn Error>> {
    run_program(["run".as_ref(), scene.as_os_str(), "--pairs".as_ref(), pairs.as_os_str()])
}

#[test]
fn pairs_are_not_written_over_the_scene_its_models_or_their_buffers() -> TestResult {
    let dir = tempdir()?;
    let model = write_gltf(dir.path(), "triangle.gltf", &[RawMesh::triangle("Triangle")])?;
    let body = json!({ "model": "triangle.gltf" });
    let scene = write_scene(dir.path(), &json!({ "bodies": [body, body], "frames": [[{}, {}]] }))?;
    for input in [&scene, &model, &dir.path().join("triangle.gltf.bin")] {
        let before = std::fs::read(input)?;
        let message = error_of(&run(&scene, input)?);
        let name = input.file_name().unwrap_or_default().to_string_lossy();
        assert!(message.contains("--pairs") && message.contains(&*name), "{message}");
        assert_eq!(std::fs::read(input)?, before, "{name}");
    }
    let free = dir.path().join("pairs.csv");
    stdout_of(&run(&scene, &free)?);
    assert!(std::fs::read_to_string(free)?.starts_with("frame,"));
    Ok(())
}

#[cfg(unix)]
#[test]
fn a_run_that_fails_while_it_writes_leaves_the_pairs_of_an_earlier_one() -> TestResult {
    let dir = tempdir()?;
    let pairs = dir.path().join("pairs.csv");
    std::fs::write(&pairs, "earlier")?;
    // The pairs take more than one block, the most that a file may have here.
    let script = "trap '' XFSZ; ulimit -f 1 && exec \"$0\" \"$@\"";
    let mut command = std::process::Command::new("sh");
    command.arg("-c").arg(script).arg(crate::PROGRAM_FILE);
    command
        .arg("run")
        .arg(crate::support::asset("scenes/two_dolphins.json"));
    let message = error_of(&command.arg("--pairs").arg(&pairs).output()?);
    assert!(message.contains("cannot write"), "{message}");
    assert_eq!(std::fs::read_to_string(&pairs)?, "earlier");
    assert_eq!(std::fs::read_dir(dir.path())?.count(), 1);
    Ok(())
}

#[cfg(unix)]
#[test]
fn pairs_to_stdout_go_before_the_summary_in_a_file_too() -> TestResult {
    let dir = tempdir()?;
    let out = dir.path().join("out");
    let mut command = crate::support::command();
    command
        .arg("run")
        .arg(crate::support::asset("scenes/two_dolphins.json"));
    command.args(["--pairs", "/dev/stdout"]);
    assert!(command.stdout(std::fs::File::create(&out)?).status()?.success());
    let text = std::fs::read_to_string(&out)?;
    assert!(
        text.starts_with("frame,body_a") && text.contains("triangle pairs "),
        "{text}"
    );
    Ok(())
}

#[test]
fn a_file_on_stdout_leaves_the_summary_to_stderr() -> TestResult {
    let output = run_program([
        "run".as_ref(),
        crate::support::asset("scenes/two_dolphins.json").as_os_str(),
        "--pairs".as_ref(),
        "-".as_ref(),
    ])?;
    let (table, summary) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert!(output.status.success() && table.starts_with("frame,body_a"), "{table}");
    assert!(
        !table.contains("time per frame") && summary.contains("time per frame"),
        "{summary}"
    );
    let message = error_of(&run_program([
        "run".as_ref(),
        crate::support::asset("scenes/two_dolphins.json").as_os_str(),
        "--pairs".as_ref(),
        "-".as_ref(),
        "--picture".as_ref(),
        "-".as_ref(),
    ])?);
    assert!(message.contains("--picture"), "{message}");
    Ok(())
}
