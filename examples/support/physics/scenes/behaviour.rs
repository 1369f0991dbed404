//! How bodies behave on a morphing surface, with any engine and in any unit of length.

use std::fmt::Write as _;

use bevy::prelude::*;
use morph_collision_models::mesh::MorphMesh;

use super::drops::Kind;
use super::engine::{Engine, PoseSurface};
use super::{DT, settle, sheet};

/// What a surface does to bodies that rest on it. Lengths and speeds are in length units.
#[derive(Clone, Copy, Debug)]
pub struct Behaviour {
    /// The velocity of a ball on a surface that rises at 0.5/s.
    pub rise: f32,
    /// The ball's distance from the surface, minus its radius.
    pub gap: f32,
    /// The velocity of a cuboid on a surface that slides at 1/s.
    pub slide: f32,
    /// The speed of a ball that is slapped up by 0.5 in 0.1 s.
    pub slap: f32,
    /// The highest place of a ball on a surface that jumps by 0.2.
    pub highest: f32,
    /// The velocity after 1 s of a cuboid that slides at 3/s without friction.
    pub glide: f32,
    /// The largest error of the upward velocity of a small cuboid on waves of up to 0.6/s.
    pub wave: f32,
}

impl Behaviour {
    /// The head of a table whose first column has this title.
    #[must_use]
    pub fn head(first: &str) -> String {
        format!(
            "| {first} | ball on a surface rising at 0.5/s: velocity | gap | cuboid on a surface sliding at 1/s: velocity | ball slapped up by 0.5 in 0.1 s: speed | ball on a surface that jumps by 0.2: highest | cuboid sliding at 3/s without friction: velocity after 1 s | cuboid on waves of 0.6/s: largest error of its velocity |\n|---|--:|--:|--:|--:|--:|--:|--:|\n"
        )
    }

    /// A row of the table.
    #[must_use]
    pub fn row(&self, first: &str) -> String {
        let Self {
            rise,
            gap,
            slide,
            slap,
            highest,
            glide,
            wave,
        } = self;
        let mut row = String::new();
        let _infallible = writeln!(
            row,
            "| {first} | {rise:.3} | {gap:+.4} | {slide:.3} | {slap:.2} | {highest:.3} | {glide:.3} | {wave:.3} |"
        );
        row
    }

    /// Runs all scenes in a world of this length unit.
    pub fn of(engine: &impl Engine, unit: f32) -> Self {
        let mut level = scaled(sheet(32), unit);
        level.targets.push(
            level
                .positions
                .iter()
                .map(|p| Vec3::Y * unit * wave_at(p.x / unit))
                .collect(),
        );
        let ball = || Scene::new(engine, &level, unit, Kind::Ball);
        let cuboid = || Scene::new(engine, &level, unit, Kind::Cuboid);

        let mut scene = ball();
        for i in 1..=90 {
            scene.step([0.5 * DT * i as f32, 0.0, 0.0]);
        }
        let (place, speed) = scene.state();
        let (rise, gap) = (speed.y, place.y - 0.5 - 0.75);

        let mut scene = cuboid();
        for i in 1..=120 {
            scene.step([0.0, DT * i as f32, 0.0]);
        }
        let slide = scene.state().1.x;

        let mut scene = ball();
        for i in 1..=6 {
            scene.step([i as f32 / 12.0, 0.0, 0.0]);
        }
        let slap = scene.state().1.y;

        let mut scene = ball();
        let mut highest: f32 = 0.0;
        for _ in 0..120 {
            scene.step([0.2, 0.0, 0.0]);
            highest = highest.max(scene.state().0.y);
        }

        let mut scene = Scene::spawn(engine, &level, unit, (Kind::Cuboid, 0.5, ABOVE));
        // At once, because contacts that exist keep their friction for a while.
        engine.make_slippery(&mut scene.app, scene.body);
        scene.rest();
        engine.push(&mut scene.app, scene.body, Vec3::X * 3.0 * unit, Vec3::ZERO);
        for _ in 0..60 {
            scene.step([0.0; 3]);
        }
        let glide = scene.state().1.x;

        let mut scene = Scene::spawn(engine, &level, unit, (Kind::Cuboid, 0.1, Vec3::new(-1.05, 0.12, 0.05)));
        scene.rest();
        let mut wave: f32 = 0.0;
        for i in 1..=240 {
            let phase = 6.0 * DT * i as f32;
            let before = scene.state().0;
            scene.step([0.0, 0.0, phase.sin()]);
            let (place, speed) = scene.state();
            if i > 60 {
                let height = |x: f32, phase: f32| phase.sin() * wave_at(x);
                let expected = (height(place.x, phase) - height(before.x, phase - 6.0 * DT)) / DT;
                wave = wave.max((speed.y - expected).abs());
            }
        }
        Self {
            rise,
            gap,
            slide,
            slap,
            highest,
            glide,
            wave,
        }
    }
}

/// Where bodies of half-extent 0.5 are spawned, in length units.
const ABOVE: Vec3 = Vec3::new(0.1, 0.52, 0.05);

/// A standing wave of height 0.1.
fn wave_at(x: f32) -> f32 {
    0.1 * (1.5 * x).sin()
}

/// A mesh in another unit of length.
#[must_use]
pub fn scaled(mut mesh: MorphMesh, unit: f32) -> MorphMesh {
    let vectors = mesh.targets.iter_mut().flatten().chain(&mut mesh.positions);
    vectors.for_each(|vector| *vector *= unit);
    mesh
}

/// A body that rests on a sheet.
struct Scene<'a, E> {
    engine: &'a E,
    unit: f32,
    app: App,
    pose: PoseSurface<'a>,
    body: Entity,
}

impl<'a, E: Engine> Scene<'a, E> {
    fn new(engine: &'a E, mesh: &'a MorphMesh, unit: f32, kind: Kind) -> Self {
        let mut scene = Self::spawn(engine, mesh, unit, (kind, 0.5, ABOVE));
        scene.rest();
        scene
    }

    fn spawn(engine: &'a E, mesh: &'a MorphMesh, unit: f32, (kind, half, at): (Kind, f32, Vec3)) -> Self {
        let mut app = engine.app(unit, DT);
        let pose = engine.surface(&mut app, mesh, Vec3::ZERO, &mut None);
        settle(&mut app);
        let body = engine.body(&mut app, kind, Vec3::splat(half * unit), at * unit);
        Self {
            engine,
            unit,
            app,
            pose,
            body,
        }
    }

    fn rest(&mut self) {
        for _ in 0..60 {
            self.app.update();
        }
    }

    fn step(&mut self, weights: [f32; 3]) {
        (self.pose)(&mut self.app, &weights);
        self.app.update();
    }

    /// In length units.
    fn state(&self) -> (Vec3, Vec3) {
        let (place, velocity) = self.engine.state(&self.app, self.body);
        (place / self.unit, velocity / self.unit)
    }
}
