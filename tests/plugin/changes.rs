//! The starts and ends that `MorphCollisions` reports, read from different schedules.

use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::support::{Edits, Messages, cube, fixed_app, move_to, settle, spawn, two_cubes};

type Pair = (Entity, Entity);

/// What the systems of each schedule saw: the pairs that started, and those that ended.
#[derive(Resource, Default)]
struct Seen(HashMap<InternedScheduleLabel, [Vec<Pair>; 2]>);

impl Seen {
    fn by(app: &mut App, schedule: impl ScheduleLabel) -> [Vec<Pair>; 2] {
        let mut seen = app.world_mut().resource_mut::<Self>();
        seen.0.remove(&schedule.intern()).unwrap_or_default()
    }
}

fn look_from(app: &mut App, schedule: impl ScheduleLabel) {
    let schedule = schedule.intern();
    let look = move |collisions: Res<MorphCollisions>, mut seen: ResMut<Seen>| {
        let pair = |contact: &MorphContact| (contact.collider1, contact.collider2);
        let [starts, ends] = seen.0.entry(schedule).or_default();
        starts.extend(collisions.started().map(pair));
        ends.extend(collisions.ended().map(pair));
    };
    app.init_resource::<Seen>()
        .add_systems(schedule, look.after(MorphCollisionSystems::Events));
}

#[test]
fn each_change_is_seen_once_from_any_schedule() {
    let (mut app, [a, b]) = two_cubes(3.0);
    let schedules = [PreUpdate.intern(), Update.intern(), PostUpdate.intern(), Last.intern()];
    for schedule in schedules {
        look_from(&mut app, schedule);
    }
    for x in [0.8, 0.8, 0.7, 3.0, 3.0, 0.8, 3.0, 3.0] {
        move_to(&mut app, b, x);
        app.update();
    }
    let pairs = vec![(a.min(b), a.max(b)); 2];
    for schedule in schedules {
        assert_eq!(
            Seen::by(&mut app, schedule),
            [pairs.clone(), pairs.clone()],
            "{schedule:?}"
        );
    }
}

#[test]
fn nothing_starts_or_ends_while_paused() {
    for x in [0.8, 3.0] {
        let (mut app, [_, b]) = two_cubes(3.8 - x);
        move_to(&mut app, b, x);
        app.update();
        app.settings().paused = true;
        app.update();
        let schedules = [PreUpdate.intern(), PostUpdate.intern(), Last.intern()];
        for schedule in schedules {
            look_from(&mut app, schedule);
        }
        for _ in 0..3 {
            app.update();
        }
        for schedule in schedules {
            assert_eq!(Seen::by(&mut app, schedule), [vec![], vec![]], "{schedule:?}");
        }
        // If collisions are paused in this frame, nothing of the frame before is reported.
        app.settings().paused = false;
        move_to(&mut app, b, 3.8 - x);
        app.update();
        let [starts, ends] = Seen::by(&mut app, Last);
        assert_eq!(starts.len() + ends.len(), 1);
        app.settings().paused = true;
        app.update();
        assert_eq!(Seen::by(&mut app, Last), [vec![], vec![]]);
    }
}

/// Runs an app whose collisions run in the fixed schedule, with `frames_per_tick` or `ticks_per_frame`, while a cube comes and
/// goes from tick to tick. Compares what the systems see with the messages.
fn come_and_go(frames_per_tick: u32, ticks_per_frame: u32, schedules: &[InternedScheduleLabel]) {
    let mut app = fixed_app(frames_per_tick, ticks_per_frame);
    let mesh = crate::support::add_mesh(&mut app, &cube());
    let [_, b] = [0.0, 3.0].map(|x| spawn(&mut app, &mesh, x));
    settle(&mut app);
    for _ in 0..2 * frames_per_tick {
        app.update();
    }
    for &schedule in schedules {
        look_from(&mut app, schedule);
    }
    #[derive(Resource)]
    struct Places(Vec<f32>);
    // Near or far, tick by tick. One contact starts and ends twice in three ticks.
    let places = [0.8, 3.0, 0.8, 3.0, 3.0, 0.8, 0.8, 0.8, 3.0, 0.8, 3.0];
    app.insert_resource(Places(places.into_iter().rev().collect()));
    app.add_systems(
        FixedUpdate,
        move |mut transforms: Query<&mut Transform>, mut places: ResMut<Places>| {
            if let Some(x) = places.0.pop() {
                transforms.get_mut(b).unwrap().translation.x = x;
            }
        },
    );
    let mut messages = Messages::default();
    messages.read(&app);
    let (mut starts, mut ends) = (Vec::new(), Vec::new());
    for _ in 0..14 * frames_per_tick.max(1) {
        app.update();
        let (new_starts, new_ends) = messages.read(&app);
        starts.extend(new_starts.iter().map(|start| (start.collider1, start.collider2)));
        ends.extend(new_ends.iter().map(|end| (end.collider1, end.collider2)));
    }
    assert_eq!((starts.len(), ends.len()), (4, 4));
    for &schedule in schedules {
        assert_eq!(
            Seen::by(&mut app, schedule),
            [starts.clone(), ends.clone()],
            "{schedule:?}, {frames_per_tick} frames per tick, {ticks_per_frame} ticks per frame"
        );
    }
}

#[test]
fn each_change_of_a_fixed_schedule_is_seen_once_inside_it_and_outside() {
    let schedules = [
        PreUpdate.intern(),
        FixedUpdate.intern(),
        FixedPostUpdate.intern(),
        FixedLast.intern(),
        Update.intern(),
        PostUpdate.intern(),
    ];
    for (frames_per_tick, ticks_per_frame) in [(1, 1), (3, 1), (1, 3), (1, 4)] {
        come_and_go(frames_per_tick, ticks_per_frame, &schedules);
    }
}
