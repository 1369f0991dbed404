//! Buffers in other files: only regular files in the model's directory and below, unless more is allowed.

use std::fs;
use std::path::Path;

use crate::support::Document;
use morph_collision_models::gltf::read::{FoundMesh, GltfFile, ReadError, ReadOptions, Remedy};
use serde_json::json;

/// Writes a model whose buffer has this URI into `models/` below `directory`, and reads its mesh.
fn read(directory: &Path, uri: &str, any_path: bool) -> Result<FoundMesh, ReadError> {
    let mut document = Document::square(1);
    document.json["buffers"] = json!([{"byteLength": document.bin.len(), "uri": uri}]);
    let models = directory.join("models");
    fs::create_dir_all(models.join("parts")).expect("a temporary folder can be made");
    for place in [
        models.join("in.bin"),
        models.join("parts/in.bin"),
        directory.join("out.bin"),
    ] {
        fs::write(place, &document.bin).expect("a temporary file can be written");
    }
    let path = models.join("model.gltf");
    fs::write(&path, document.json.to_string()).expect("a temporary file can be written");
    let options = ReadOptions {
        any_path,
        ..ReadOptions::default()
    };
    GltfFile::open(&path, &options)?.mesh(0)
}

#[track_caller]
fn assert_refused(directory: &Path, uri: &str, why: &str) {
    let error = read(directory, uri, false).expect_err("it leads out");
    let message = error.to_string();
    assert_eq!(error.remedy(), Some(Remedy::AnyPath), "{message}");
    for part in ["model.gltf", "buffer 0", uri, why] {
        assert!(message.contains(part), "no {part:?} in: {message}");
    }
}

#[test]
fn files_in_the_models_directory_and_below_are_read() {
    let directory = tempfile::tempdir().expect("a temporary directory can be made");
    for uri in ["in.bin", "parts/in.bin", "./parts/../in.bin", "%69n.bin"] {
        let mesh = read(directory.path(), uri, false).expect("it stays inside").mesh;
        assert_eq!(mesh.triangles.len(), 2, "{uri}");
    }
}

#[test]
fn what_leads_out_needs_to_be_allowed() {
    let directory = tempfile::tempdir().expect("a temporary directory can be made");
    let out = directory.path().join("out.bin").display().to_string();
    for (uri, why) in [
        ("../out.bin", "leads out"),
        ("parts/../../out.bin", "leads out"),
        (&out, "absolute"),
        (&format!("file://{out}"), "file:"),
    ] {
        assert_refused(directory.path(), uri, why);
        let mesh = read(directory.path(), uri, true).expect("it is allowed").mesh;
        assert_eq!(mesh.triangles.len(), 2, "{uri}");
    }
}

#[cfg(unix)]
#[test]
fn links_that_lead_out_and_what_is_no_regular_file_need_to_be_allowed() {
    let directory = tempfile::tempdir().expect("a temporary directory can be made");
    let models = directory.path().join("models");
    fs::create_dir_all(models.join("folder")).expect("a temporary folder can be made");
    let link = |to: &str, name: &str| std::os::unix::fs::symlink(to, models.join(name)).expect("links can be made");
    link("../out.bin", "out-link.bin");
    link("parts/in.bin", "in-link.bin");
    link("/dev/zero", "zero.bin");
    assert!(read(directory.path(), "in-link.bin", false).is_ok());
    assert_refused(directory.path(), "out-link.bin", "symbolic link");
    assert_refused(directory.path(), "zero.bin", "symbolic link");
    assert_refused(directory.path(), "folder", "not a regular file");
    assert!(read(directory.path(), "out-link.bin", true).is_ok());
    // It reads only as much as the buffer declares; all vertices are at the origin.
    let zeros = read(directory.path(), "/dev/zero", true).expect("it is allowed").mesh;
    assert_eq!(zeros.positions, [glam::Vec3::ZERO; 4]);
    assert!(read(directory.path(), "folder", true).is_err());

    let pipe = std::process::Command::new("mkfifo").arg(models.join("pipe")).status();
    if pipe.is_ok_and(|status| status.success()) {
        // Opening it would wait forever.
        assert_refused(directory.path(), "pipe", "not a regular file");
        let error = GltfFile::open(&models.join("pipe"), &ReadOptions::default()).expect_err("no regular file");
        assert_eq!(error.remedy(), Some(Remedy::AnyPath), "{error}");
    }
}

#[test]
fn nothing_is_fetched() {
    let directory = tempfile::tempdir().expect("a temporary directory can be made");
    for any_path in [false, true] {
        let error = read(directory.path(), "https://example.org/a.bin", any_path).expect_err("no file");
        assert!(
            error.remedy().is_none() && error.to_string().contains("https:"),
            "{error}"
        );
    }
}
