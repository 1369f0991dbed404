//! Times frames with bodies near morphing surfaces: the scenes, and a timer that runs the methods in turns.

use std::time::Instant;

use bevy::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::bench::median;
use morph_collision_testkit::report::Table;
use morph_collision_workspace::outcome::progress_bar;
use morph_collision_workspace::physics::drops::Kind;
use morph_collision_workspace::physics::engine::{Engine, PoseSurface};
use morph_collision_workspace::physics::{DT, settle, sheet};

/// Sheets in a row, and bodies.
#[derive(Clone, Copy, Debug)]
struct Scene {
    /// Its description.
    what: &'static str,
    /// Number of sheets.
    shapes: usize,
    /// Number of sheets with bodies on them; these are the first ones.
    on: usize,
    /// Bodies on each of these sheets.
    bodies: usize,
    /// Bodies beside each sheet, on a level floor of their own.
    beside: usize,
    /// Whether the sheets change in every frame.
    morphs: bool,
}

/// The scenes in which all methods are timed.
fn scenes() -> Vec<Scene> {
    let few = |shapes, on| Scene {
        what: "few bodies",
        shapes,
        on,
        bodies: 2,
        beside: 0,
        morphs: true,
    };
    let tenth = |shapes| Scene {
        what: "one in ten touches",
        bodies: 1,
        beside: 9,
        ..few(shapes, shapes)
    };
    vec![
        few(1, 1),
        few(10, 10),
        few(100, 1),
        tenth(1),
        tenth(10),
        tenth(100),
        Scene {
            what: "none touches",
            beside: 10,
            ..few(100, 0)
        },
        Scene {
            what: "many bodies",
            bodies: 100,
            ..few(1, 1)
        },
        Scene {
            what: "many bodies",
            bodies: 30,
            ..few(10, 10)
        },
        Scene {
            what: "nothing near",
            ..few(10, 0)
        },
        Scene {
            what: "nothing morphs",
            morphs: false,
            ..few(1, 1)
        },
        Scene {
            what: "nothing morphs, many bodies",
            bodies: 100,
            morphs: false,
            ..few(1, 1)
        },
    ]
}

impl Scene {
    /// The position of each sheet.
    fn sheets(&self) -> impl Iterator<Item = Vec3> + use<> {
        (0..self.shapes).map(sheet_at)
    }

    /// The position of each floor, which is 6 by 8 with a height of 1 and centred there.
    fn floors(&self) -> impl Iterator<Item = Vec3> + use<> {
        let floors = if self.beside > 0 { self.shapes } else { 0 };
        (0..floors).map(|i| sheet_at(i) + Vec3::new(10.0, -0.5, 0.0))
    }

    /// The positions of bodies with radius or half-extent 0.3, alternating balls and cuboids. Those on sheets come first.
    fn places(&self) -> impl Iterator<Item = Vec3> + use<> {
        let Self {
            shapes,
            on,
            bodies,
            beside,
            ..
        } = *self;
        let cell = |i: usize| Vec3::new((i % 10) as f32 - 4.5, 0.4, (i / 10) as f32 - 4.5) * Vec3::new(0.75, 1.0, 0.75);
        let aside = |i: usize| Vec3::new(10.0 + 1.2 * ((i % 4) as f32 - 1.5), 0.4, 1.2 * ((i / 4) as f32 - 1.5));
        let on = (0..on).flat_map(move |sheet| (0..bodies).map(move |i| sheet_at(sheet) + cell(i)));
        let beside = (0..shapes).flat_map(move |sheet| (0..beside).map(move |i| sheet_at(sheet) + aside(i)));
        on.chain(beside)
    }

    /// Number of bodies.
    fn count(&self) -> usize {
        self.on * self.bodies + self.shapes * self.beside
    }
}

fn sheet_at(i: usize) -> Vec3 {
    Vec3::X * 20.0 * i as f32
}

/// A world in which one method is timed, and a function that gives its sheets weights.
type Timed<'a> = (App, PoseSurface<'a>);

/// Number of consecutive frames of one method.
const TURN: usize = 20;

/// Medians of whole frames in microseconds; the methods take turns.
fn time(scene: &Scene, frames: usize, mut worlds: Vec<Timed<'_>>) -> Vec<f64> {
    // Each turn has several frames, so that caches are as warm as in a game of its own.
    let mut times = vec![Vec::new(); worlds.len()];
    for turn in 0..=frames.div_ceil(TURN) {
        for ((app, pose), times) in worlds.iter_mut().zip(&mut times) {
            for frame in 0..TURN {
                let time = (turn * TURN + frame) as f32 * DT;
                let start = Instant::now();
                if scene.morphs {
                    pose(app, &[0.05 * (6.0 * time).sin(), 0.05 * (5.0 * time).cos()]);
                }
                app.update();
                // In the first turn bodies come to rest. In the first frames of each turn caches fill.
                if turn > 0 && frame >= TURN / 4 {
                    times.push(start.elapsed().as_secs_f64() * 1e6);
                }
            }
        }
    }
    times.into_iter().map(|times| median(times.into_iter())).collect()
}

/// A table of the times: ours in microseconds, those of the rivals relative to ours.
pub(super) fn table(methods: &[impl Engine], quick: bool) -> Table {
    let mesh = sheet(101);
    let rivals = methods[1..].iter().map(Engine::name);
    let mut table = Table::new(["surfaces", "bodies", "ours, µs"].into_iter().chain(rivals));
    let scenes = scenes();
    let progress = progress_bar(scenes.len() as u64);
    for scene in &scenes {
        let frames = match (quick, scene.shapes) {
            (true, _) => 20,
            (_, 100..) => 40,
            _ => 100,
        };
        let worlds = methods.iter().map(|method| world(scene, method, &mesh)).collect();
        let row = time(scene, frames, worlds);
        let ours = [
            scene.shapes.to_string(),
            format!("{} ({})", scene.count(), scene.what),
            format!("{:.0}", row[0]),
        ];
        let ratios = row[1..].iter().map(|rival| format!("{:.2}", rival / row[0]));
        table.row(ours.into_iter().chain(ratios));
        progress.inc(1);
    }
    progress.finish_and_clear();
    table
}

/// A scene with one method.
fn world<'a>(scene: &Scene, method: &impl Engine, mesh: &'a MorphMesh) -> Timed<'a> {
    let mut app = method.app(1.0, DT);
    let mut shared = None;
    let spawn = |at| method.surface(&mut app, mesh, at, &mut shared);
    let mut surfaces: Vec<_> = scene.sheets().map(spawn).collect();
    for at in scene.floors() {
        method.floor(&mut app, Vec3::new(3.0, 0.5, 4.0), at);
    }
    settle(&mut app);
    for (i, at) in scene.places().enumerate() {
        let kind = if i % 2 == 0 { Kind::Ball } else { Kind::Cuboid };
        let body = method.body(&mut app, kind, Vec3::splat(0.3), at);
        method.stay_awake(&mut app, body);
    }
    let pose = move |app: &mut App, weights: &[f32]| {
        surfaces.iter_mut().for_each(|surface| surface(app, weights));
    };
    (app, Box::new(pose))
}
