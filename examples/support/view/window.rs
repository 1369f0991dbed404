//! A show in a window.

use bevy::prelude::*;
use bevy::window::WindowResolution;

use super::stage::{self, Place};
use super::{Show, clock::Trouble};
use crate::error::ExampleError;
use crate::options::ViewOptions;

pub(super) fn run(show: Show, options: &ViewOptions) -> Result<(), ExampleError> {
    if !has_display() {
        return Err(ExampleError::NoDisplay);
    }
    let title = format!("morph_collision: {}", show.name);
    let (width, height) = options.size;
    let window = Window {
        title,
        resolution: WindowResolution::new(width, height),
        ..default()
    };
    let mut app = stage::app(Some(window));
    stage::set(&mut app, show, Place::Window);
    stage::show_volumes(&mut app, options.volumes);
    app.add_systems(Last, give_up);
    app.run();
    match app.world().get_resource::<Trouble>() {
        Some(Trouble(trouble)) => Err(ExampleError::Read(trouble.clone())),
        None => Ok(()),
    }
}

fn give_up(trouble: Option<Res<Trouble>>, mut exit: MessageWriter<AppExit>) {
    if let Some(trouble) = trouble {
        error!("{}", trouble.0);
        exit.write(AppExit::error());
    }
}

/// Whether a window can be opened. Elsewhere than on Linux there always is a display.
fn has_display() -> bool {
    !cfg!(target_os = "linux")
        || ["WAYLAND_DISPLAY", "DISPLAY"]
            .iter()
            .any(|name| std::env::var_os(name).is_some())
}
