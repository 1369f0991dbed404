//! Writes a demo's pictures into a folder.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::Duration;

use bevy::app::App;
use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, RgbImage};
use indicatif::ProgressBar;

use super::offscreen::Offscreen;
use super::overlay::Overlay;
use super::{Demo, stage, volumes};
use crate::app::STEP;
use crate::error::ExampleError;
use crate::options::{Animation, ViewOptions};

/// Writes the requested pictures, `NAME_FRAME.png` and `NAME.gif`, and prints their paths.
pub(super) fn write(demo: Demo, options: &ViewOptions, folder: &Path) -> Result<(), ExampleError> {
    let cannot =
        |path: &Path, error: &dyn std::fmt::Display| ExampleError::Picture(format!("{}: {error}", path.display()));
    std::fs::create_dir_all(folder).map_err(|error| cannot(folder, &error))?;

    let name = demo.name;
    let stills = if options.at.is_empty() {
        demo.pictures.to_vec()
    } else {
        options.at.clone()
    };
    let moving = options.animate.map(frames_of).unwrap_or_default();
    let mut wanted: Vec<u32> = stills.iter().chain(&moving).copied().collect();
    wanted.sort_unstable();
    wanted.dedup();
    // A program has only one log, and an off-screen demo does not set it up.
    App::new().add_plugins(stage::log());
    let mut offscreen = Offscreen::new(demo, options.size, options.bare)?;
    let mut film = match options.animate {
        Some(_) => Some(Film::create(&folder.join(format!("{name}.gif")))?),
        None => None,
    };
    volumes::show_volumes(offscreen.app_mut(), options.volumes);
    let progress = ProgressBar::new(wanted.len() as u64);
    let mut now = 0;
    for frame in wanted {
        offscreen.advance(frame - now);
        now = frame;
        let picture = offscreen.picture()?;
        if let (Some(film), true) = (&mut film, moving.contains(&frame)) {
            let step = options.animate.map_or(1, |animation| animation.step);
            film.add(&picture, STEP * step)?;
        }
        if stills.contains(&frame) {
            let path = folder.join(format!("{name}_{frame:03}.png"));
            picture.save(&path).map_err(|error| cannot(&path, &error))?;
            let red = offscreen.app_mut().world().resource::<Overlay>().triangles;
            progress.suspend(|| println!("{}: {red} triangles are red", path.display()));
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    if let Some(film) = film {
        println!("{}", film.path.display());
    }
    Ok(())
}

fn frames_of(animation: Animation) -> Vec<u32> {
    (animation.first..=animation.last)
        .step_by(animation.step as usize)
        .collect()
}

/// An animated picture that loops forever.
struct Film {
    path: std::path::PathBuf,
    encoder: GifEncoder<BufWriter<File>>,
}

impl Film {
    /// GIF encoding speed from 1, best and slowest, to 30.
    const SPEED: i32 = 8;

    fn create(path: &Path) -> Result<Self, ExampleError> {
        let cannot = |error: &dyn std::fmt::Display| ExampleError::Picture(format!("{}: {error}", path.display()));
        let file = File::create(path).map_err(|error| cannot(&error))?;
        let mut encoder = GifEncoder::new_with_speed(BufWriter::new(file), Self::SPEED);
        encoder.set_repeat(Repeat::Infinite).map_err(|error| cannot(&error))?;
        Ok(Self {
            path: path.into(),
            encoder,
        })
    }

    fn add(&mut self, picture: &RgbImage, shown: Duration) -> Result<(), ExampleError> {
        let opaque = image::DynamicImage::ImageRgb8(picture.clone()).to_rgba8();
        let frame = Frame::from_parts(opaque, 0, 0, Delay::from_saturating_duration(shown));
        self.encoder
            .encode_frame(frame)
            .map_err(|error| ExampleError::Picture(format!("{}: {error}", self.path.display())))
    }
}
