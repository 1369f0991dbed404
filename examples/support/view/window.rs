//! A demo in a window.

use std::sync::{Arc, OnceLock};

use bevy::prelude::*;
use bevy::window::WindowResolution;

use super::stage::{self, Place};
use super::{Demo, clock::Trouble, files::Files, volumes};
use crate::error::ExampleError;
use crate::options::ViewOptions;

pub(super) fn run(demo: Demo, options: &ViewOptions) -> Result<(), ExampleError> {
    if !has_display() {
        return Err(ExampleError::NoDisplay);
    }
    if !stage::has_driver(wgpu::Backends::all()) {
        return Err(ExampleError::NoDriver);
    }
    let title = format!("morph_collision: {}", demo.name);
    let (width, height) = options.size;
    let window = Window {
        title,
        resolution: WindowResolution::new(width, height),
        ..default()
    };
    let mut app = stage::app(stage::plugins(Some(window)), &Files::default());
    stage::set(&mut app, demo, Place::Window);
    volumes::show_volumes(&mut app, options.volumes);
    // The app is gone after it has run; this remains.
    let trouble = Arc::new(OnceLock::new());
    let told = Arc::clone(&trouble);
    app.add_systems(
        Last,
        move |found: Option<Res<Trouble>>, mut exit: MessageWriter<AppExit>| {
            if let Some(found) = found {
                told.get_or_init(|| found.0.clone());
                exit.write(AppExit::error());
            }
        },
    );
    let exit = app.run();
    match (trouble.get(), exit) {
        (Some(trouble), _) => Err(ExampleError::Read(trouble.clone())),
        (None, AppExit::Success) => Ok(()),
        (None, AppExit::Error(code)) => Err(ExampleError::Picture(format!("the window ended with code {code}"))),
    }
}

/// Whether a window can be opened. On Linux this needs X11, which Wayland desktops provide as well. Other systems always
/// have a display.
fn has_display() -> bool {
    !cfg!(target_os = "linux") || std::env::var_os("DISPLAY").is_some_and(|display| !display.is_empty())
}
