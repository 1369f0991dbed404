//! A demo without a window: runs frame by frame and takes pictures.

use std::sync::mpsc;
use std::time::{Duration, Instant};

use bevy::app::TerminalCtrlCHandlerPlugin;
use bevy::image::Image;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::TextureFormat;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::time::TimeUpdateStrategy;
use bevy::winit::WinitPlugin;
use image::RgbImage;

use super::Demo;
use super::clock::{Clock, Trouble};
use super::files::Files;
use super::pointer::{self, Script};
use super::stage::{self, Place};
use crate::app::STEP;
use crate::error::ExampleError;

/// How long to wait for models and trees, or for a picture.
const PATIENCE: Duration = Duration::from_secs(300);

/// Frames until something that newly comes into view is drawn correctly.
const DRAWN: u32 = 4;

/// A demo that is drawn into an image.
pub struct Offscreen {
    app: App,
    target: Handle<Image>,
}

impl std::fmt::Debug for Offscreen {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Offscreen").finish_non_exhaustive()
    }
}

impl Offscreen {
    /// A demo at frame 0. `bare` hides the panel.
    ///
    /// # Errors
    /// There is no graphics driver, or a model cannot be loaded.
    pub fn new(demo: Demo, size: (u32, u32), bare: bool) -> Result<Self, ExampleError> {
        if !stage::has_driver(wgpu::Backends::PRIMARY) {
            return Err(ExampleError::NoDriver);
        }
        // Each frame is drawn before the next one is computed. Logs and signals are left to the caller.
        let plugins = stage::plugins(None)
            .disable::<WinitPlugin>()
            .disable::<LogPlugin>()
            .disable::<TerminalCtrlCHandlerPlugin>()
            .disable::<PipelinedRenderingPlugin>();
        let mut app = stage::app(plugins, &Files::default());
        let target = app
            .world_mut()
            .resource_mut::<Assets<Image>>()
            .add(Image::new_target_texture(
                size.0,
                size.1,
                TextureFormat::Rgba8UnormSrgb,
                None,
            ));
        let place = Place::Image {
            target: target.clone(),
            bare,
        };
        stage::set(&mut app, demo, place);
        app.add_plugins(pointer::plugin)
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
        app.finish();
        app.cleanup();
        let mut offscreen = Self { app, target };
        // The first update spawns the camera. Frames that only wait for files and trees are not drawn: without a graphics card,
        // drawing would take most of the time.
        offscreen.app.update();
        offscreen.draw(false);
        offscreen.update_until(|world| world.resource::<Clock>().started)?;
        offscreen.draw(true);
        for _ in 0..DRAWN {
            offscreen.app.update();
        }
        Ok(offscreen)
    }

    /// Runs this many frames of 1/60 s.
    ///
    /// Only the last of them are drawn, unless a pointer needs to see what it points at.
    pub fn advance(&mut self, frames: u32) {
        self.set_step(STEP);
        let pointed = !self.app.world().resource::<Script>().0.is_empty();
        for left in (0..frames).rev() {
            self.draw(pointed || left < DRAWN);
            self.app.update();
        }
        self.set_step(Duration::ZERO);
    }

    fn draw(&mut self, drawn: bool) {
        let world = self.app.world_mut();
        for mut camera in world.query::<&mut Camera>().iter_mut(world) {
            camera.is_active = drawn;
        }
    }

    /// Jumps to another frame and skips those before it. Everything that moves by the [`Clock`] jumps too; whatever moves step
    /// by step, such as physics, stays where it was.
    pub fn jump(&mut self, frame: u32) {
        self.app.world_mut().resource_mut::<Clock>().frame = f64::from(frame);
    }

    /// The current picture.
    ///
    /// # Errors
    /// The renderer fails.
    pub fn picture(&mut self) -> Result<RgbImage, ExampleError> {
        // Glyphs that the panel needs for the first time appear a frame later.
        self.app.update();
        let (sender, receiver) = mpsc::sync_channel(1);
        self.app
            .world_mut()
            .spawn(Screenshot::image(self.target.clone()))
            .observe(move |captured: On<ScreenshotCaptured>| {
                let picture = captured.image.clone().try_into_dynamic().map(|image| image.to_rgb8());
                // The receiver waits for only one picture.
                let _full = sender.try_send(picture.map_err(|error| error.to_string()));
            });
        let mut picture = None;
        self.update_until(|_| {
            picture = receiver.try_recv().ok();
            picture.is_some()
        })?;
        picture
            .unwrap_or_else(|| Err("there is no picture".into()))
            .map_err(ExampleError::Picture)
    }

    /// The app.
    pub fn app_mut(&mut self) -> &mut App {
        &mut self.app
    }

    fn set_step(&mut self, step: Duration) {
        self.app
            .world_mut()
            .insert_resource(TimeUpdateStrategy::ManualDuration(step));
    }

    /// Runs frames in which no time passes.
    fn update_until(&mut self, mut done: impl FnMut(&World) -> bool) -> Result<(), ExampleError> {
        let start = Instant::now();
        while !done(self.app.world()) {
            if let Some(Trouble(trouble)) = self.app.world().get_resource::<Trouble>() {
                return Err(ExampleError::Read(trouble.clone()));
            }
            if start.elapsed() > PATIENCE {
                return Err(ExampleError::Picture(format!(
                    "nothing came of it after {} s",
                    PATIENCE.as_secs()
                )));
            }
            self.app.update();
        }
        Ok(())
    }
}
