//! Bodies that fall into a waving bowl: how many fall through.

use bevy::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::report::Table;
use morph_collision_workspace::outcome::progress_bar;
use morph_collision_workspace::physics::drops::{Drop, batch_of_drops, bowl, fates, waves};
use morph_collision_workspace::physics::engine::Engine;
use morph_collision_workspace::physics::{DT, settle};

use super::Comparison;

const PER_BATCH: u64 = 100;

/// Drops bodies that do not collide with each other into the bowl, and counts how many fall through.
pub(super) fn table<E: Engine>(compared: &Comparison<E>, quick: bool) -> Table {
    let mesh = bowl();
    let batches = if quick { 4 } else { 100 };
    let cells = compared.ccd.len() * compared.dropped.len() * compared.speeds.len();
    let progress = progress_bar(batches * cells as u64);
    let mut table = Table::new(["method", "CCD", "speed", "drops", "fell through", "left over the rim"]);
    for &ccd in compared.ccd {
        for engine in compared.dropped {
            for &speed in compared.speeds {
                let (mut through, mut left) = (0, 0);
                for batch in 0..batches {
                    let fell = fall(engine, &mesh, ccd, &batch_of_drops(batch, PER_BATCH, speed));
                    through += fell.0;
                    left += fell.1;
                    progress.inc(1);
                }
                let ccd = ccd.map_or("default", |on| if on { "on" } else { "off" });
                let counts = [batches * PER_BATCH, through, left].map(|count| count.to_string());
                let cells = [engine.name().to_owned(), ccd.to_owned(), speed.to_string()];
                table.row(cells.into_iter().chain(counts));
            }
        }
    }
    progress.finish_and_clear();
    table
}

/// Drops bodies and counts those that fall through, and those that leave over the rim.
fn fall(engine: &impl Engine, mesh: &MorphMesh, ccd: Option<bool>, drops: &[Drop]) -> (u64, u64) {
    let mut app = engine.app(1.0, DT);
    let mut pose = engine.surface(&mut app, mesh, Vec3::ZERO, &mut None);
    settle(&mut app);
    let spawn = |drop: &Drop| {
        let body = engine.body(&mut app, drop.kind, drop.half(), drop.at);
        engine.collide_only_with_surface(&mut app, body);
        engine.push(&mut app, body, drop.linear, drop.angular);
        if let Some(on) = ccd {
            engine.set_ccd(&mut app, body, on);
        }
        body
    };
    let bodies: Vec<Entity> = drops.iter().map(spawn).collect();
    for step in 0..240 {
        pose(&mut app, &waves(step as f32 * DT));
        app.update();
    }
    fates(bodies.iter().map(|&body| engine.state(&app, body).0))
}
