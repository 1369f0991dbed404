//! The common base of all demos: Bevy with a renderer, a camera, light, and a background.

use bevy::app::{PluginGroup, PluginGroupBuilder};
use bevy::asset::AssetMetaCheck;
use bevy::camera::{CameraUpdateSystems, ClearColorConfig, RenderTarget};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::gizmos::config::GizmoConfigStore;
use bevy::light::GlobalAmbientLight;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::settings::{Backends, WgpuSettings};
use bevy::window::ExitCondition;
use bevy_morph_collision::prelude::*;
use bevy_panorbit_camera::{PanOrbitCamera, PanOrbitCameraPlugin};

use super::files::Files;
use super::{Demo, clock, models, overlay, pointer, sliders, volumes};

/// The colour behind everything.
pub const BACKGROUND: Color = Color::srgb(0.93, 0.95, 0.97);

/// A demo's description, for the panel.
#[derive(Resource, Clone, Debug)]
#[cfg_attr(
    target_arch = "wasm32",
    allow(dead_code, reason = "a page describes its demo itself")
)]
pub(super) struct Playbill {
    pub(super) name: &'static str,
    pub(super) about: &'static str,
    pub(super) keys: &'static [(&'static str, &'static str)],
    /// Whether a user watches, rather than a camera that takes pictures.
    pub(super) live: bool,
}

/// Lines that a demo adds to the panel: a name and a value.
#[derive(Resource, Clone, Debug, Default)]
pub struct Notes(pub Vec<(&'static str, String)>);

/// The camera that looks at the demo.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct StageCamera;

/// Where the demo is drawn.
#[derive(Clone, Debug)]
pub(super) enum Place {
    Window,
    #[cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "a page takes no pictures"))]
    Image {
        target: Handle<Image>,
        bare: bool,
    },
}

/// Logs only what a user can act on. Files that cannot be loaded are reported in another way.
pub(super) fn log() -> LogPlugin {
    LogPlugin {
        filter: "error,bevy_asset=off,bevy_morph_collision=warn".into(),
        ..LogPlugin::default()
    }
}

/// Bevy's default plugins, with a window or without.
pub(super) fn plugins(window: Option<Window>) -> PluginGroupBuilder {
    let live = window.is_some();
    let assets = AssetPlugin {
        file_path: concat!(env!("CARGO_MANIFEST_DIR"), "/assets").into(),
        meta_check: AssetMetaCheck::Never,
        // A user's own model may be anywhere.
        unapproved_path_mode: bevy::asset::UnapprovedPathMode::Allow,
        ..AssetPlugin::default()
    };
    let windows = WindowPlugin {
        exit_condition: if live {
            ExitCondition::OnPrimaryClosed
        } else {
            ExitCondition::DontExit
        },
        // Bevy's picking needs a primary window, even if it is never opened.
        primary_window: window.or_else(|| Some(Window::default())),
        ..WindowPlugin::default()
    };
    let drivers = WgpuSettings {
        // Without a window, no other backend is searched, because the search prints complaints.
        backends: if live {
            WgpuSettings::default().backends
        } else {
            Some(Backends::PRIMARY)
        },
        ..WgpuSettings::default()
    };
    let renderer = RenderPlugin {
        render_creation: drivers.into(),
        // Makes the first off-screen picture complete.
        synchronous_pipeline_compilation: !live,
        ..RenderPlugin::default()
    };
    DefaultPlugins.set(assets).set(windows).set(renderer).set(log())
}

/// An app with these plugins. The plugins of this project come with the demo, except the one that draws bounding volumes.
pub(super) fn app(plugins: PluginGroupBuilder, files: &Files) -> App {
    let mut app = App::new();
    files.serve(&mut app);
    app.add_plugins(plugins).add_plugins(MorphGizmosPlugin);
    app
}

/// Puts a demo on the stage.
pub(super) fn set(app: &mut App, demo: Demo, place: Place) {
    let live = matches!(place, Place::Window);
    app.insert_resource(ClearColor(BACKGROUND))
        .insert_resource(GlobalAmbientLight {
            brightness: AMBIENT,
            ..default()
        })
        .insert_resource(Playbill {
            name: demo.name,
            about: demo.about,
            keys: demo.keys,
            live,
        })
        .init_resource::<Notes>()
        .add_plugins((
            clock::plugin,
            models::plugin,
            overlay::plugin,
            pointer::clicks,
            sliders::plugin,
            volumes::plugin,
        ));
    #[cfg(feature = "render_ui")]
    app.add_plugins(super::diagnostic_panel::plugin);
    #[cfg(not(target_arch = "wasm32"))]
    if !matches!(place, Place::Image { bare: true, .. }) {
        app.add_plugins(super::panel::plugin);
    }
    if live {
        app.add_plugins(PanOrbitCameraPlugin);
    }
    // The overlay shows the touching triangles instead.
    let gizmos = &mut app.world_mut().resource_mut::<GizmoConfigStore>();
    let (_, gizmos) = gizmos.config_mut::<MorphGizmos>();
    (gizmos.triangles, gizmos.contacts) = (None, None);
    let (eye, target) = (demo.eye, demo.target);
    app.add_systems(Startup, move |mut commands: Commands| {
        light(&mut commands);
        camera(&mut commands, eye, target, &place);
    })
    .add_systems(PostUpdate, widen.before(CameraUpdateSystems));
    (demo.scene)(app);
}

/// The renderer on a web page supports one directional light. There, ambient light replaces the second one.
#[cfg(target_arch = "wasm32")]
const AMBIENT: f32 = 620.0;
#[cfg(target_arch = "wasm32")]
const LIGHTS: [(f32, Vec3); 1] = [KEY_LIGHT];
#[cfg(not(target_arch = "wasm32"))]
const AMBIENT: f32 = 430.0;
#[cfg(not(target_arch = "wasm32"))]
const LIGHTS: [(f32, Vec3); 2] = [KEY_LIGHT, (900.0, Vec3::new(3.0, 1.0, -2.0))];

/// Illuminance, and where the light comes from.
const KEY_LIGHT: (f32, Vec3) = (2500.0, Vec3::new(-2.0, 4.0, 3.0));

fn light(commands: &mut Commands) {
    for (illuminance, from) in LIGHTS {
        commands.spawn((
            DirectionalLight {
                illuminance,
                ..default()
            },
            Transform::from_translation(from).looking_at(Vec3::ZERO, Vec3::Y),
        ));
    }
}

fn camera(commands: &mut Commands, eye: Vec3, target: Vec3, place: &Place) {
    let mut camera = commands.spawn((
        StageCamera,
        Camera3d::default(),
        Camera {
            clear_color: ClearColorConfig::Default,
            ..default()
        },
        // Keeps the background's brightness.
        Tonemapping::None,
        Transform::from_translation(eye).looking_at(target, Vec3::Y),
    ));
    match place {
        Place::Window => {
            camera.insert(PanOrbitCamera {
                focus: target,
                button_orbit: MouseButton::Right,
                button_pan: MouseButton::Middle,
                use_real_time: true,
                ..default()
            });
        }
        Place::Image { target, .. } => {
            camera.insert(RenderTarget::Image(target.clone().into()));
        }
    }
}

/// If the picture is higher than wide, it shows as much from left to right as a square one.
fn widen(mut camera: Single<(&Camera, &mut Projection), With<StageCamera>>) {
    let (camera, projection) = &mut *camera;
    let Some(size) = camera.physical_target_size().map(UVec2::as_vec2) else {
        return;
    };
    let higher = (size.y / size.x.max(1.0)).max(1.0);
    let fov = 2.0 * ((0.5 * PerspectiveProjection::default().fov).tan() * higher).atan();
    if matches!(&**projection, Projection::Perspective(now) if now.fov != fov)
        && let Projection::Perspective(perspective) = &mut **projection
    {
        perspective.fov = fov;
    }
}

/// Whether there is any graphics driver, including software renderers.
#[cfg(not(target_arch = "wasm32"))]
pub(super) fn has_driver(backends: Backends) -> bool {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    !bevy::tasks::block_on(instance.enumerate_adapters(backends)).is_empty()
}
