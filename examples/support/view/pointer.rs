//! What a pointer does: whether it clicks; and one that a show moves itself, for pictures: off-screen there is no mouse.

use bevy::camera::{NormalizedRenderTarget, RenderTarget};
use bevy::ecs::system::SystemParam;
use bevy::picking::PickingSystems;
use bevy::picking::pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

use super::clock::{self, Clock};
use super::stage::StageCamera;

/// What the pointer does, in ascending order of frames, two or more apart.
#[derive(Resource, Clone, Debug, Default)]
pub struct Script(pub Vec<Cue>);

/// One thing that the pointer does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cue {
    /// When.
    pub frame: u32,
    /// Above this place, in world space.
    pub at: Vec3,
    /// Whether the left button is pressed and released.
    pub click: bool,
}

const POINTER: PointerId = PointerId::Custom(bevy::asset::uuid::Uuid::from_u128(
    0x6d6f_7270_6820_706f_696e_7465_7200_0001,
));

pub(super) fn plugin(app: &mut App) {
    app.init_resource::<Script>()
        .add_systems(Startup, |mut commands: Commands| {
            commands.spawn(POINTER);
        })
        .add_systems(First, play.in_set(PickingSystems::Input).after(clock::tick));
}

fn play(
    clock: Res<Clock>,
    time: Res<Time>,
    script: Res<Script>,
    camera: Single<(&Camera, &GlobalTransform, &RenderTarget), With<StageCamera>>,
    mut inputs: MessageWriter<PointerInput>,
    mut done: Local<usize>,
    mut held: Local<Option<Location>>,
) {
    // While a picture is waited for, no time passes.
    if !clock.started || time.delta().is_zero() {
        return;
    }
    let (camera, place, target) = *camera;
    let RenderTarget::Image(image) = target else { return };
    let mut write = |location: Location, action| inputs.write(PointerInput::new(POINTER, location, action));
    // A click takes two frames.
    if let Some(location) = held.take() {
        write(location, PointerAction::Release(PointerButton::Primary));
        return;
    }
    let Some(cue) = script
        .0
        .get(*done)
        .filter(|cue| f64::from(cue.frame) <= clock.frame + 0.5)
    else {
        return;
    };
    *done += 1;
    let Ok(position) = camera.world_to_viewport(place, cue.at) else {
        return;
    };
    let location = Location {
        target: NormalizedRenderTarget::Image(image.clone()),
        position,
    };
    // Listeners hear nothing of a pointer that does not move.
    write(location.clone(), PointerAction::Move { delta: Vec2::ONE });
    if cue.click {
        write(location.clone(), PointerAction::Press(PointerButton::Primary));
        *held = Some(location);
    }
}

/// Where each pointer was pressed last.
#[derive(Resource, Debug, Default)]
struct Presses(HashMap<PointerId, Vec2>);

pub(super) fn clicks(app: &mut App) {
    app.init_resource::<Presses>()
        .add_observer(|press: On<PointerPress>, mut presses: ResMut<Presses>| {
            let at = press.pointer.position;
            presses.0.insert(press.pointer.id, at);
        });
}

/// Tells clicks from drags: a finger that orbits also ends on what it began on.
#[derive(SystemParam, Debug)]
pub struct Clicks<'w> {
    presses: Res<'w, Presses>,
}

impl Clicks<'_> {
    /// In pixels: no hand is quite still.
    const STILL: f32 = 8.0;

    /// Whether it is one with the left button, or a finger, in one place.
    #[must_use]
    pub fn is_plain(&self, click: &PointerClick) -> bool {
        let pressed = self.presses.0.get(&click.pointer.id);
        let moved = pressed.map_or(0.0, |pressed| pressed.distance(click.pointer.position));
        click.button == PointerButton::Primary && moved <= Self::STILL
    }
}
