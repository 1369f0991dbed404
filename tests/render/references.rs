//! Compares pictures with references that people have checked. `just references` rewrites them; check
//! them again after that.

use std::path::{Path, PathBuf};

use image::RgbImage;
use morph_collision_workspace::demos;
use morph_collision_workspace::view::Demo;
use morph_collision_workspace::view::overlay::Overlay;

use crate::support::{alone, count, is_red, offscreen};

const SIZE: (u32, u32) = (320, 180);

/// A difference in a colour value, out of 255, that is visible.
const NOTICED: u8 = 24;

/// Compares a frame of a demo with the stored picture, or stores it if the environment says so.
fn compare(name: &str, demo: Demo, frame: u32) {
    let _alone = alone();
    let mut demo = offscreen(demo, SIZE);
    demo.jump(frame - 2);
    demo.advance(2);
    let picture = demo.picture().unwrap();
    let path = folder().join(format!("{name}.png"));
    if std::env::var_os("MORPH_COLLISION_STORE_REFERENCES").is_some() {
        picture.save(&path).unwrap();
        return;
    }
    let reference = image::open(&path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
        .to_rgb8();
    assert_eq!(picture.dimensions(), reference.dimensions());
    if !is_alike(&reference, &picture) {
        let actual = std::env::temp_dir().join(format!("{name}_actual.png"));
        picture.save(&actual).unwrap();
        panic!(
            "{:.1} % of {} differ, or {:.1} % of what is red; what was drawn is in {}",
            100.0 * noticed(&picture, &reference),
            path.display(),
            100.0 * off_in_red(&reference, &picture),
            actual.display()
        );
    }
}

/// Whether the two pictures look the same.
fn is_alike(reference: &RgbImage, picture: &RgbImage) -> bool {
    noticed(picture, reference) <= 0.01 && off_in_red(reference, picture) <= 0.3
}

/// The relative difference in the number of red pixels.
fn off_in_red(reference: &RgbImage, picture: &RgbImage) -> f64 {
    let red = |picture: &RgbImage| count(picture, is_red) as f64;
    (red(picture) - red(reference)).abs() / red(reference)
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/render/references")
}

/// The share of pixels that look different.
fn noticed(a: &RgbImage, b: &RgbImage) -> f64 {
    let differ =
        |(a, b): &(&image::Rgb<u8>, &image::Rgb<u8>)| a.0.iter().zip(b.0).any(|(&a, b)| a.abs_diff(b) > NOTICED);
    let pixels = a.width() * a.height();
    a.pixels().zip(b.pixels()).filter(differ).count() as f64 / f64::from(pixels)
}

#[test]
fn dolphins() {
    compare("dolphins", demos::dolphins(Path::new("dolphin_564.glb"), 12, false), 60);
}

#[test]
fn pass_through() {
    compare("pass_through", demos::pass_through(), 120);
}

#[test]
fn face() {
    compare("face", demos::face(), 60);
}

#[test]
fn a_missing_overlay_is_another_picture() {
    let _alone = alone();
    let mut demo = offscreen(demos::pass_through(), SIZE);
    demo.jump(118);
    demo.advance(2);
    let with = demo.picture().unwrap();
    demo.app_mut().world_mut().resource_mut::<Overlay>().shown = false;
    demo.advance(2);
    let without = demo.picture().unwrap();
    assert!(!is_alike(&with, &without), "the comparison would not notice");
}

#[test]
fn another_moment_is_another_picture() {
    let _alone = alone();
    let mut demo = offscreen(demos::pass_through(), SIZE);
    demo.jump(118);
    demo.advance(2);
    let then = demo.picture().unwrap();
    demo.advance(8);
    let later = demo.picture().unwrap();
    assert!(!is_alike(&then, &later), "the comparison would not notice eight frames");
}
