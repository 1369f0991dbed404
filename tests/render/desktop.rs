//! Pictures can be drawn without a desktop.

use std::path::Path;
use std::process::Command;

use bevy::prelude::*;
use morph_collision_workspace::options::ViewOptions;
use morph_collision_workspace::view::run;

use crate::support::{alone, scene};

/// Names the picture folder of the program that the test starts.
const FOLDER: &str = "MORPH_COLLISION_PICTURES";

/// The test starts itself in a bare environment, like that of a service or a container. The child does what a drawn example
/// does.
#[test]
fn pictures_are_drawn_without_a_runtime_directory_or_display_and_without_complaint() {
    if let Some(folder) = std::env::var_os(FOLDER) {
        return draw(folder.as_ref());
    }
    let _alone = alone();
    let folder = std::env::temp_dir().join(format!("morph_collision_desktop_{}", std::process::id()));
    let output = Command::new(std::env::current_exe().unwrap())
        .args([
            "desktop::pictures_are_drawn_without_a_runtime_directory_or_display_and_without_complaint",
            "--exact",
            "--nocapture",
        ])
        .env(FOLDER, &folder)
        .env_remove("XDG_RUNTIME_DIR")
        .env_remove("NODEVICE_SELECT")
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .unwrap();
    let (stdout, stderr) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert!(output.status.success(), "{stdout}{stderr}");
    assert!(!stderr.contains("error"), "{stderr}");
    let picture = image::open(folder.join("test_001.png")).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (64, 48));
    // Checks that the program drew, and not that the test harness found no such test.
    assert!(stdout.contains("test_001.png: 0 triangles are red"), "{stdout}");
    std::fs::remove_dir_all(folder).unwrap();
}

/// Does what a drawn example does with `--screenshots FOLDER --at 1 --size 64x48 --bare`.
fn draw(folder: &Path) {
    let options = ViewOptions {
        screenshots: Some(folder.to_owned()),
        at: vec![1],
        size: (64, 48),
        animate: None,
        volumes: None,
        bare: true,
    };
    run(scene(Vec3::Z, |_| ()), &options).unwrap();
}
