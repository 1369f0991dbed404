//! Going back in a fixed schedule, whose ticks are then simulated again outside of the frame's loop.

use bevy::app::FixedMain;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::support::{Edits, add_mesh, cube, fixed_app, move_to, settle, spawn};

/// What started and ended, after each tick.
#[derive(Resource, Default)]
struct Ticks(Vec<(usize, usize)>);

fn note(collisions: Res<MorphCollisions>, mut ticks: ResMut<Ticks>) {
    ticks.0.push((collisions.started().count(), collisions.ended().count()));
}

#[test]
fn ticks_that_are_simulated_again_see_their_own_changes() {
    let mut app = fixed_app(1, 1);
    app.init_resource::<Ticks>().add_systems(FixedLast, note);
    let mesh = add_mesh(&mut app, &cube());
    let [a, _] = [0.0, 5.0].map(|x| spawn(&mut app, &mesh, x));
    let list = MorphCollidingEntities::default();
    app.insert(a, list);
    settle(&mut app);
    // Saved within the loop by one system, or between frames: both are saved once per tick.
    MorphCollisionState::save(app.world_mut());
    let before = app.world().resource::<MorphCollisionState>().clone();
    for _ in 0..3 {
        for (x, expected) in [(4.5, (1, 0)), (0.0, (0, 1))] {
            move_to(&mut app, a, x);
            app.world_mut().resource_mut::<Ticks>().0.clear();
            app.update();
            assert_eq!(app.world().resource::<Ticks>().0, [expected]);
        }
        move_to(&mut app, a, 4.5);
        app.update();
        assert_eq!(app.world().get::<MorphCollidingEntities>(a).unwrap().len(), 1);

        // It goes back, and simulates the same ticks as a rollback library does.
        app.insert_resource(before.clone());
        MorphCollisionState::restore(app.world_mut());
        assert_eq!(app.world().get::<MorphCollidingEntities>(a).unwrap().len(), 0);
        app.world_mut().resource_mut::<Ticks>().0.clear();
        for x in [0.0, 4.5, 4.5, 0.0] {
            move_to(&mut app, a, x);
            app.world_mut().run_schedule(FixedMain);
        }
        let ticks = [(0, 0), (1, 0), (0, 0), (0, 1)];
        assert_eq!(app.world().resource::<Ticks>().0, ticks);
        // Nothing is left of it for the next time.
        MorphCollisionState::save(app.world_mut());
        app.world_mut().resource_mut::<Ticks>().0.clear();
        MorphCollisionState::restore(app.world_mut());
        app.world_mut().run_schedule(FixedMain);
        assert_eq!(app.world().resource::<Ticks>().0, [(0, 0)]);
    }
}
