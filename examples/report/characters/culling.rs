//! Boxes for culling: how large they are, what they miss, and what they cost.

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::VisibilitySystems;
use bevy::math::{DAffine3, DMat4, DVec3, Mat4};
use bevy::prelude::*;
use bevy_morph_collision::bounds::MorphBoundsPlugin;
use morph_collision_testkit::bench::{Stopwatch, median};
use morph_collision_testkit::report::Table;
use morph_collision_workspace::drawn::{Part, extent};
use morph_collision_workspace::outcome::progress_bar;

use super::stage::{Stage, grid};
use crate::model::Model;

/// The clips that are compared on their own; all other clips of a model are compared together.
const MODELS: [(&str, &[&str]); 4] = [
    (
        "mh_character.glb",
        &["walk", "wave_and_crouch", "talk", "walk_and_talk"],
    ),
    (
        "mh_character_low.glb",
        &["walk", "wave_and_crouch", "talk", "walk_and_talk"],
    ),
    ("RobotExpressive.glb", &[]),
    ("Fox.glb", &["Survey", "Walk", "Run"]),
];

/// Use every Nth frame of 60 frames per second.
const EVERY: usize = 2;

/// Measurements of one way to keep boxes, over the frames of clips.
#[derive(Default)]
struct Seen {
    /// Areas, divided by those of the smallest boxes with the same axes.
    ratios: Vec<f64>,
    /// Boxes that some vertex leaves by more than a millionth of the size.
    burst: usize,
}

impl Seen {
    fn look(&mut self, stage: &Stage, model: &Model, part: &Part) {
        let vertices = stage.vertices(model, part);
        let world = stage.app.world();
        let (Some(aabb), Some(place)) = (
            world.get::<Aabb>(part.entity),
            world.get::<GlobalTransform>(part.entity),
        ) else {
            return;
        };
        let place = DAffine3::from_mat4(DMat4::from_cols_array(
            &Mat4::from(place.affine()).to_cols_array().map(f64::from),
        ));
        let to_entity = place.inverse();
        let used = part.triangles(&model.meshes).as_flattened();
        let drawn: Vec<DVec3> = used
            .iter()
            .map(|&v| to_entity.transform_point3(vertices[v as usize]))
            .collect();
        let (min, max) = extent(&drawn);
        // Bevy moves the box with the entity, so its sides are scaled.
        let scale = DVec3::new(
            place.matrix3.x_axis.length(),
            place.matrix3.y_axis.length(),
            place.matrix3.z_axis.length(),
        );
        let area = |sides: DVec3| sides.x * sides.y + sides.y * sides.z + sides.z * sides.x;
        let (center, half) = (aabb.center.as_dvec3(), aabb.half_extents.as_dvec3());
        self.ratios.push(area(2.0 * half * scale) / area((max - min) * scale));
        let slack = (max - min).max_element() * 1e-6;
        let holds = (center - half - slack).cmple(min).all() && (center + half + slack).cmpge(max).all();
        self.burst += usize::from(!holds);
    }

    fn cells(&self) -> [String; 3] {
        let worst = self.ratios.iter().copied().fold(0.0, f64::max);
        let middle = median(self.ratios.iter().copied());
        [format!("{middle:.3}"), format!("{worst:.3}"), self.burst.to_string()]
    }
}

/// Two instances of a model, one with each way to keep boxes.
struct Compared {
    model: Model,
    stages: [Stage; 2],
}

impl Compared {
    fn new(name: &str, place: Transform) -> Result<Self, String> {
        let model = Model::find(name)?;
        let mut stages = [
            Stage::new(&model, &[place], (), |app| _ = app.add_plugins(MorphBoundsPlugin))?,
            Stage::new(&model, &[place], (), |_| ())?,
        ];
        stages[1].set_dynamic_bounds(true);
        Ok(Self { model, stages })
    }

    fn clips(&self) -> Vec<String> {
        self.stages[0].clip_names()
    }

    /// Adds a row about the boxes in all frames of some clips.
    fn row(&mut self, table: &mut Table, names: [&str; 2], clips: &[String], quick: bool) -> Result<(), String> {
        let mut seen = [Seen::default(), Seen::default()];
        for clip in clips {
            let mut length = 0.0;
            for stage in &mut self.stages {
                length = stage.play(clip)?;
            }
            let frames = (length * 60.0) as usize;
            let every = if quick { EVERY * 8 } else { EVERY };
            for frame in 0..frames {
                for (stage, seen) in self.stages.iter_mut().zip(&mut seen) {
                    stage.app.update();
                    if frame % every == 0 {
                        for part in &stage.parts {
                            seen.look(stage, &self.model, part);
                        }
                    }
                }
            }
        }
        let [ours, bevys] = &seen;
        let cells = names
            .map(str::to_owned)
            .into_iter()
            .chain([ours.ratios.len().to_string()]);
        table.row(cells.chain(ours.cells()).chain(bevys.cells()));
        Ok(())
    }
}

/// A table whose second column has this title.
fn table(second: &str) -> Table {
    Table::new([
        "model",
        second,
        "boxes",
        "ours: median",
        "worst",
        "boxes with a vertex outside",
        "Bevy's: median",
        "worst",
        "boxes with a vertex outside",
    ])
}

/// The size of boxes of upright characters.
pub(crate) fn sizes(quick: bool) -> Result<String, String> {
    let mut table = table("clip");
    for (name, own_rows) in MODELS {
        let mut compared = Compared::new(name, Transform::default())?;
        let clips = compared.clips();
        let rows: Vec<(String, Vec<String>)> = if own_rows.is_empty() {
            vec![(format!("all {}", clips.len()), clips)]
        } else {
            own_rows
                .iter()
                .map(|&clip| (format!("`{clip}`"), vec![clip.to_owned()]))
                .collect()
        };
        let bar = progress_bar(rows.len() as u64);
        for (title, clips) in rows {
            compared.row(&mut table, [name, &title], &clips, quick)?;
            bar.inc(1);
        }
        bar.finish_and_clear();
    }
    Ok(table.to_string())
}

/// The size of boxes of turned characters, over all clips.
pub(crate) fn turned(quick: bool) -> Result<String, String> {
    const DEGREES: [f32; 3] = [0.0, 45.0, 90.0];
    let mut table = table("turned by");
    let bar = progress_bar((MODELS.len() * DEGREES.len()) as u64);
    for (name, _) in MODELS {
        for degrees in DEGREES {
            let place = Transform::from_rotation(Quat::from_rotation_y(degrees.to_radians()));
            let mut compared = Compared::new(name, place)?;
            let clips = compared.clips();
            compared.row(&mut table, [name, &format!("{degrees}°")], &clips, quick)?;
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    Ok(table.to_string())
}

/// Characters in the timed crowd: about 22,000 joints.
const CHARACTERS: usize = 415;
const JOINTS: usize = 53;

/// When the computation of a frame's bounds started, and how long it took.
#[derive(Resource, Default)]
struct Clock {
    start: Option<Stopwatch>,
    taken: Option<f64>,
}

/// Times everything between the propagation of transforms and the visibility check.
fn add_clock(app: &mut App) {
    app.init_resource::<Clock>().add_systems(
        PostUpdate,
        (
            (|mut clock: ResMut<Clock>| clock.start = Some(Stopwatch::start()))
                .after(TransformSystems::Propagate)
                .before(VisibilitySystems::CalculateBounds),
            (|mut clock: ResMut<Clock>| {
                clock.taken = clock.start.take().map(|watch| watch.elapsed().as_secs_f64() * 1e6);
            })
            .after(VisibilitySystems::CalculateBounds)
            .before(VisibilitySystems::CheckVisibility),
        ),
    );
}

/// The cost of boxes per joint.
pub(crate) fn times(quick: bool) -> Result<String, String> {
    let model = Model::find("mh_character.glb")?;
    let frames = if quick { 10 } else { 120 };
    let places = grid(CHARACTERS, Vec2::splat(9.0));
    let mut stages = [
        Stage::new(&model, &places, (), add_clock)?,
        Stage::new(&model, &places, (), |app| {
            app.add_plugins(MorphBoundsPlugin);
            add_clock(app);
        })?,
        Stage::new(&model, &places, (), add_clock)?,
    ];
    for (stage, dynamic) in stages.iter_mut().zip([false, false, true]) {
        stage.set_dynamic_bounds(dynamic);
    }
    let mut table = Table::new([
        "what the characters do",
        "ours, ns per joint",
        "Bevy's, ns per joint",
        "ours in a frame, µs",
        "ratio",
    ]);
    let clips = [
        ("walk", "walk: joints move"),
        ("talk", "talk: some joints and the face move"),
        ("walk_and_talk", "walk and talk: both move"),
    ];
    let bar = progress_bar(clips.len() as u64 + 1);
    let mut rows: Vec<(&str, Option<&str>)> = clips.iter().map(|&(clip, what)| (what, Some(clip))).collect();
    rows.push(("nothing moves", None));
    for (what, clip) in rows {
        let mut times = [const { Vec::new() }; 3];
        for stage in &mut stages {
            match clip {
                Some(clip) => _ = stage.play(clip)?,
                None => morph_collision_workspace::crowd::edit_players(&mut stage.app, |player| _ = player.pause_all()),
            }
        }
        for frame in 0..frames + 4 {
            for (stage, times) in stages.iter_mut().zip(&mut times) {
                stage.app.update();
                let taken = stage.app.world().resource::<Clock>().taken;
                times.extend(taken.filter(|_| frame >= 4));
            }
        }
        let [nothing, ours, bevys] = times.map(|times| median(times.into_iter()));
        let (ours, bevys) = (ours - nothing, bevys - nothing);
        let per_joint = |time: f64| time * 1e3 / (CHARACTERS * JOINTS) as f64;
        table.row([
            what.to_owned(),
            format!("{:.1}", per_joint(ours)),
            format!("{:.1}", per_joint(bevys)),
            format!("{ours:.0}"),
            format!("{:.2}", bevys / ours),
        ]);
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(table.to_string())
}
