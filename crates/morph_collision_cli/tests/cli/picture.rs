//! `run --picture` draws what `run` finds, without a graphics driver.

use std::collections::BTreeSet;
use std::error::Error;
use std::ffi::OsStr;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::tempdir;

use crate::support::{RawMesh, TestResult, asset, error_of, run_program, stdout_of, write_gltf, write_scene};

/// Width, height, and three bytes per pixel.
type Pixels = (u32, u32, Vec<u8>);

fn read_png(path: &Path) -> Result<Pixels, Box<dyn Error>> {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path)?)).read_info()?;
    let mut bytes = vec![0; reader.output_buffer_size().ok_or("too large")?];
    let info = reader.next_frame(&mut bytes)?;
    assert_eq!(
        (info.color_type, info.bit_depth),
        (png::ColorType::Rgb, png::BitDepth::Eight)
    );
    bytes.truncate(info.buffer_size());
    Ok((info.width, info.height, bytes))
}

fn red_pixels((_, _, rgb): &Pixels) -> usize {
    rgb.chunks(3)
        .filter(|pixel| pixel[0] > 150 && pixel[1] < 60 && pixel[2] < 60)
        .count()
}

/// Runs the scene of two dolphins and returns the JSON and the picture.
fn dolphins(options: &[&str]) -> Result<(Value, Pixels), Box<dyn Error>> {
    let dir = tempdir()?;
    let path = dir.path().join("out.png");
    let scene = asset("scenes/two_dolphins.json");
    let mut args: Vec<&OsStr> = vec![
        "run".as_ref(),
        scene.as_os_str(),
        "--json".as_ref(),
        "--picture".as_ref(),
    ];
    args.push(path.as_os_str());
    args.extend(options.iter().map(OsStr::new));
    let json = serde_json::from_str(&stdout_of(&run_program(args)?))?;
    Ok((json, read_png(&path)?))
}

#[test]
fn the_frame_with_the_most_pairs_is_drawn_with_its_triangles_in_red() -> TestResult {
    let dir = tempdir()?;
    let csv = dir.path().join("pairs.csv");
    let (json, picture) = dolphins(&["--pairs", csv.to_str().ok_or("not UTF-8")?])?;
    let pairs: Vec<u64> = serde_json::from_value(json["pairs"].clone())?;
    let frame = json["picture"]["frame"].as_u64().ok_or("no frame")?;
    assert_eq!(pairs[usize::try_from(frame)?], *pairs.iter().max().ok_or("no frames")?);

    let mut touching = BTreeSet::new();
    for line in std::fs::read_to_string(csv)?.lines().skip(1) {
        let fields: Vec<u64> = line.split(',').map(str::parse).collect::<Result<_, _>>()?;
        if fields[0] == frame {
            touching.extend([(fields[1], fields[3]), (fields[2], fields[4])]);
        }
    }
    assert_eq!(json["picture"]["touching_triangles"], touching.len());
    assert!(!touching.is_empty());
    assert_eq!((picture.0, picture.1), (960, 540));
    assert!(red_pixels(&picture) > 1_000, "{}", red_pixels(&picture));
    Ok(())
}

#[test]
fn another_frame_is_drawn_on_demand() -> TestResult {
    let (json, apart) = dolphins(&["--picture-frame", "0"])?;
    assert_eq!(
        json["picture"],
        json!({ "file": json["picture"]["file"], "frame": 0, "touching_triangles": 0 })
    );
    assert_eq!(red_pixels(&apart), 0);
    // The bodies are drawn anyway: the background changes only from row to row.
    let row = &apart.2[3 * 960 * 270..][..3 * 960];
    assert!(row.chunks(3).any(|pixel| pixel != &row[..3]));
    Ok(())
}

#[test]
fn the_picture_in_the_readme_is_what_its_command_draws() -> TestResult {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let readme = std::fs::read_to_string(root.join("README.md"))?;
    let command = "run assets/scenes/two_dolphins.json --picture dolphins.png";
    assert!(readme.contains(command) && readme.contains("docs/pictures/two_dolphins.png"));
    let (_, drawn) = dolphins(&[])?;
    assert!(
        read_png(&root.join("docs/pictures/two_dolphins.png"))? == drawn,
        "draw it again: {command}"
    );
    Ok(())
}

#[test]
fn the_summary_names_the_picture() -> TestResult {
    let dir = tempdir()?;
    let path = dir.path().join("out.png");
    let scene = asset("scenes/two_dolphins.json");
    let args = [
        "run".as_ref(),
        scene.as_os_str(),
        "--picture".as_ref(),
        path.as_os_str(),
    ];
    let summary = stdout_of(&run_program(args)?);
    assert!(
        summary.contains("out.png: frame 32, 24 touching triangles in red"),
        "{summary}"
    );
    Ok(())
}

#[test]
fn pictures_that_cannot_be_are_refused_before_anything_is_written() -> TestResult {
    let dir = tempdir()?;
    write_gltf(dir.path(), "model.gltf", &[RawMesh::triangle("one")])?;
    let model = json!([{ "model": "model.gltf" }]);
    let scene = write_scene(dir.path(), &json!({ "bodies": model, "frames": [[{}], [{}]] }))?;
    let picture = dir.path().join("out.png");
    let run = |options: &[&str]| -> Result<String, Box<dyn Error>> {
        let args = ["run".as_ref(), scene.as_os_str()];
        let options = options.iter().map(OsStr::new);
        Ok(error_of(&run_program(args.into_iter().chain(options))?))
    };
    let out = picture.to_str().ok_or("not UTF-8")?;

    let beyond = run(&["--picture", out, "--picture-frame", "2"])?;
    assert!(
        beyond.contains("--picture-frame: there is no frame 2; the scene's frames are 0 to 1"),
        "{beyond}"
    );
    let twice = run(&["--picture", out, "--pairs", out])?;
    assert!(twice.contains("--picture: --pairs names the same file"), "{twice}");
    let again = dir.path().join("./").join(picture.file_name().ok_or("no name")?);
    let spelled = run(&["--picture", out, "--pairs", again.to_str().ok_or("not UTF-8")?])?;
    assert!(spelled.contains("--pairs names the same file"), "{spelled}");
    let input = run(&["--picture", scene.to_str().ok_or("not UTF-8")?])?;
    assert!(input.contains("--picture") && input.contains("scene.json"), "{input}");
    assert!(!picture.exists());

    let alone = run_program([
        "run".as_ref(),
        scene.as_os_str(),
        "--picture-frame".as_ref(),
        "0".as_ref(),
    ])?;
    assert_eq!(alone.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&alone.stderr).contains("--picture <OUT.png>"));

    let empty = write_scene(dir.path(), &json!({ "bodies": model, "frames": [] }))?;
    let args = [
        "run".as_ref(),
        empty.as_os_str(),
        "--picture".as_ref(),
        picture.as_os_str(),
    ];
    let error = error_of(&run_program(args)?);
    assert!(error.contains("--picture: the scene has no frames to draw"), "{error}");
    assert!(!picture.exists());
    Ok(())
}

#[test]
fn a_name_that_promises_another_format_is_refused_before_any_work() -> TestResult {
    let dir = tempdir()?;
    let picture = dir.path().join("touch.jpg");
    // The scene does not exist, so the complaint comes before it is read.
    let args = [
        "run".as_ref(),
        "absent.json".as_ref(),
        "--picture".as_ref(),
        picture.as_os_str(),
    ];
    let error = error_of(&run_program(args)?);
    assert!(
        error.contains("--picture: ") && error.contains("touch.jpg: pictures are PNG files"),
        "{error}"
    );
    assert!(!picture.exists());
    // Capitals and names without an extension are fine.
    for name in ["TOUCH.PNG", "touch"] {
        let picture = dir.path().join(name);
        let scene = asset("scenes/two_dolphins.json");
        stdout_of(&run_program([
            "run".as_ref(),
            scene.as_os_str(),
            "--picture".as_ref(),
            picture.as_os_str(),
        ])?);
        read_png(&picture)?;
    }
    Ok(())
}
