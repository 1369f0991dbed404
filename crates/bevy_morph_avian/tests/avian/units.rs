//! Characters in worlds of other units of length.

use std::path::Path;
use std::time::Duration;

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_avian::prelude::*;
use morph_collision_workspace::app::headless;
use morph_collision_workspace::physics::player::Player;

use crate::log::start;
use crate::support::{body, place, run};

#[test]
fn a_plate_on_the_head_of_a_character_stays_there_in_every_unit() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/models/mh_character.glb");
    let Ok(file) = file.canonicalize() else {
        println!("skipped: {} is not there", file.display());
        return;
    };
    // The file is in decimetres.
    for unit in [0.01, 1.0, 10.0] {
        let mut app = headless(file.parent().unwrap());
        let physics = PhysicsPlugins::default().with_length_unit(unit);
        let step = Duration::from_secs_f64(1.0 / 30.0);
        app.add_plugins((physics, MorphAvianPlugin))
            .insert_resource(Gravity(Vec3::NEG_Y * 9.81 * unit))
            .insert_resource(Time::<Fixed>::from_duration(step))
            .insert_resource(TimeUpdateStrategy::ManualDuration(step));
        start(&mut app);
        let collider = MorphPhysicsCollider::default();
        let player = Player::spawn(&mut app, &file, "walk_and_talk", 0.1 * unit, collider).expect("it can be loaded");
        run(&mut app, 5);
        let half = 0.01 * unit;
        let at = player.top(&app) + Vec3::Y * 0.012 * unit;
        let plate = body(&mut app, Collider::cuboid(1.2 * unit, 2.0 * half, 1.2 * unit), at);
        let upright = LockedAxes::ROTATION_LOCKED.lock_translation_x().lock_translation_z();
        app.world_mut().entity_mut(plate).insert(upright);
        let (mut lowest, mut highest, mut tops) = (f32::MAX, f32::MIN, Vec::new());
        for _ in 0..90 {
            run(&mut app, 1);
            tops.push(player.top(&app).y);
            // Physics is up to two frames behind what is drawn, and a step.
            let recent = &tops[tops.len().saturating_sub(4)..];
            let gaps = recent.iter().map(|top| (place(&app, plate).y - half - top) / unit);
            lowest = lowest.min(gaps.clone().fold(f32::MIN, f32::max));
            highest = highest.max(gaps.fold(f32::MAX, f32::min));
        }
        println!("unit {unit}: gap from {lowest} to {highest}");
        assert!(
            lowest > -0.01 && highest < 0.02,
            "unit {unit}: gap from {lowest} to {highest}"
        );
    }
}
