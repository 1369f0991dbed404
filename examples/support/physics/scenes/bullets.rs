//! Small fast bodies that are shot at a surface that moves towards them.

use bevy::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::behaviour::scaled;
use super::drops::Kind;
use super::engine::Engine;
use super::{settle, sheet};

/// Shots at a level sheet.
#[derive(Clone, Copy, Debug)]
pub struct Shots {
    /// Their shape: balls or cuboids.
    pub kind: Kind,
    /// The speed of the bullets, downward, per second.
    pub speed: f32,
    /// Their radius or half-extent.
    pub radius: f32,
    /// The speed of the sheet, upward.
    pub rise: f32,
    /// Steps per second.
    pub rate: f32,
    /// The length unit of the world. All lengths and speeds are in this unit.
    pub unit: f32,
    /// Whether the game switches the engine's continuous collision detection on, or off.
    pub ccd: bool,
}

impl Shots {
    /// Bullets of radius 0.02 at 20 per second, 60 steps per second.
    pub const SMALL: Self = Self {
        kind: Kind::Ball,
        speed: 20.0,
        radius: 0.02,
        rise: 5.0,
        rate: 60.0,
        unit: 1.0,
        ccd: false,
    };

    /// Fires this many shots.
    pub fn fire(&self, engine: &impl Engine, count: usize) -> Hits {
        let Self { unit, rate, .. } = *self;
        let mesh = scaled(sheet(16), unit);
        let mut app = engine.app(unit, 1.0 / rate);
        let mut pose = engine.surface(&mut app, &mesh, Vec3::ZERO, &mut None);
        settle(&mut app);
        let mut rng = Pcg64Mcg::seed_from_u64(7);
        let mut within = |reach: f32| rng.random_range(-reach..=reach);
        let bullets: Vec<Entity> = (0..count)
            .map(|i| {
                // Apart from each other, and at all phases of a step.
                let cell = Vec3::new((i % 8) as f32 - 3.5, 0.0, (i / 8 % 8) as f32 - 3.5) * 0.8;
                let at = cell + Vec3::new(within(0.2), 3.0 + within(0.3), within(0.2));
                let bullet = engine.body(&mut app, self.kind, Vec3::splat(self.radius * unit), at * unit);
                let aside = 0.1 * self.speed * Vec3::new(within(1.0), 0.0, within(1.0)) / (1.0 + 0.05 * self.speed);
                engine.push(&mut app, bullet, (aside - self.speed * Vec3::Y) * unit, Vec3::ZERO);
                engine.set_ccd(&mut app, bullet, self.ccd);
                bullet
            })
            .collect();
        let mut height = 0.0;
        // Until long after the shots: sheet and bullets meet within 0.3 s.
        for step in 1..=(0.6 * rate).ceil() as usize {
            height = self.rise * step as f32 / rate;
            pose(&mut app, &[height, 0.0]);
            app.update();
        }
        let mut hits = Hits {
            through: 0,
            deepest: 0.0,
            fastest: 0.0,
        };
        for &bullet in &bullets {
            let (place, velocity) = engine.state(&app, bullet);
            if (place.x.abs().max(place.z.abs())) / unit > 4.0 {
                // It tumbled over the rim.
                continue;
            }
            let above = place.y / unit - height;
            hits.through += usize::from(above < 0.0);
            hits.deepest = hits.deepest.max(1.0 - above / self.radius);
            hits.fastest = hits.fastest.max((velocity.y / unit - self.rise).abs());
        }
        hits
    }
}

/// What became of bullets.
#[derive(Clone, Copy, Debug)]
pub struct Hits {
    /// The number of those that went through.
    pub through: usize,
    /// How deep they are in the sheet, at most, relative to their radius.
    pub deepest: f32,
    /// Their highest speed relative to the sheet, upward or downward.
    pub fastest: f32,
}
