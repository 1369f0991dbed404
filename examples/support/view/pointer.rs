//! Distinguishes clicks from drags, and moves a scripted pointer for pictures, because there is no mouse off-screen.

use bevy::camera::{NormalizedRenderTarget, RenderTarget};
use bevy::ecs::system::SystemParam;
use bevy::picking::PickingSystems;
use bevy::picking::pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

use super::clock::{self, Clock, Typing};
use super::stage::StageCamera;

/// The pointer's actions, in ascending order of frames, at least two frames apart.
#[derive(Resource, Clone, Debug, Default)]
pub struct Script(pub Vec<Cue>);

/// One action of the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cue {
    /// The frame in which it happens.
    pub frame: u32,
    /// The place to point at, in world space.
    pub at: Vec3,
    /// Whether the left button is pressed and released.
    pub click: bool,
}

impl Script {
    /// Clicks at these places, one after the other from the first frame on.
    #[must_use]
    pub fn clicks(places: &[Vec3]) -> Self {
        let cues = places.iter().zip((1..).step_by(3));
        Self(cues.map(|(&at, frame)| Cue { frame, at, click: true }).collect())
    }
}

/// Removes everything that the user has stuck somewhere, with the key X.
pub fn remove_by_key<T: Component>(
    keys: Res<ButtonInput<KeyCode>>,
    typing: Res<Typing>,
    stuck: Query<Entity, With<T>>,
    mut commands: Commands,
) {
    if keys.just_pressed(KeyCode::KeyX) && !typing.0 {
        stuck.iter().for_each(|entity| commands.entity(entity).despawn());
    }
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
    // No time passes while a picture is being taken.
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
    // Listeners get no events from a pointer that does not move.
    write(location.clone(), PointerAction::Move { delta: Vec2::ONE });
    if cue.click {
        write(location.clone(), PointerAction::Press(PointerButton::Primary));
        *held = Some(location);
    }
}

/// Where each pointer was last pressed.
#[derive(Resource, Debug, Default)]
struct Presses(HashMap<PointerId, Vec2>);

pub(super) fn clicks(app: &mut App) {
    app.init_resource::<Presses>()
        .add_observer(|press: On<PointerPress>, mut presses: ResMut<Presses>| {
            let at = press.pointer.position;
            presses.0.insert(press.pointer.id, at);
        });
}

/// Distinguishes clicks from drags: a finger that orbits can also end on the object it started on.
#[derive(SystemParam, Debug)]
pub struct Clicks<'w> {
    presses: Res<'w, Presses>,
}

impl Clicks<'_> {
    /// Tolerance in pixels, because no hand is quite still.
    const STILL: f32 = 8.0;

    /// Whether the click is one of the left button or a finger that stayed in one place.
    #[must_use]
    pub fn is_plain(&self, click: &PointerClick) -> bool {
        let pressed = self.presses.0.get(&click.pointer.id);
        let moved = pressed.map_or(0.0, |pressed| pressed.distance(click.pointer.position));
        click.button == PointerButton::Primary && moved <= Self::STILL
    }
}
