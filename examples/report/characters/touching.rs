//! Which characters touch: what finding out costs per frame, and which answers are right.

use bevy::camera::primitives::Aabb;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::oracle::intersecting_pairs;
use morph_collision_testkit::report::Table;
use morph_collision_workspace::drawn::{extent, near};
use morph_collision_workspace::outcome::progress_bar;
use std::collections::BTreeSet;

use super::capsules::{self, Fit, fitted};
use super::stage::{Stage, frame_times, grid};
use crate::model::Model;

const CHARACTERS: usize = 100;
const CLIP: &str = "walk_and_talk";

/// Distances between characters, in decimetres: in the first crowd nobody touches, in the second nearly
/// everybody touches somebody.
const CROWDS: [(&str, Vec2); 2] = [("apart", Vec2::new(12.0, 9.0)), ("dense", Vec2::new(4.6, 3.2))];

/// A way to find out which characters touch.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    /// Characters without any contact queries: the baseline that is subtracted from the other ways.
    Nothing,
    Ours(MorphCollisionMode),
    /// Boxes around joints, as Bevy keeps them for culling.
    JointBoxes,
    Capsules(Fit),
}

impl Way {
    const ALL: [Self; 6] = [
        Self::Nothing,
        Self::Ours(MorphCollisionMode::All),
        Self::Ours(MorphCollisionMode::First),
        Self::JointBoxes,
        Self::Capsules(Fit::Around),
        Self::Capsules(Fit::Through),
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Ours(MorphCollisionMode::First) => "`MorphCollisionPlugin`, first pairs",
            Self::Ours(_) => "`MorphCollisionPlugin`, all pairs",
            Self::JointBoxes => "Bevy's joint boxes, overlaps not looked for",
            Self::Capsules(Fit::Around) => "Rapier, capsules around vertices",
            Self::Capsules(Fit::Through) => "Rapier, capsules through vertices",
        }
    }

    /// A crowd set up for this way.
    fn stage(self, model: &Model, apart: Vec2) -> Result<Stage, String> {
        let places = grid(CHARACTERS, apart);
        let mut stage = match self {
            Self::Nothing | Self::JointBoxes => Stage::new(model, &places, (), |_| ())?,
            Self::Ours(mode) => {
                let scene = MorphColliderScene {
                    collider: MorphCollider::new(mode),
                    ..default()
                };
                Stage::new(model, &places, scene, |app| {
                    _ = app.add_plugins(MorphCollisionPlugin);
                })?
            }
            Self::Capsules(_) => Stage::new(model, &places, (), capsules::add_physics)?,
        };
        stage.set_dynamic_bounds(self == Self::JointBoxes);
        if let Self::Capsules(fit) = self {
            let capsules: Vec<_> = model.meshes.iter().flat_map(|mesh| fitted(mesh, fit)).collect();
            capsules::dress(&mut stage, &capsules);
        }
        stage.play(CLIP)?;
        Ok(stage)
    }

    /// The pairs of characters that touch, according to this way.
    fn touching(self, stage: &mut Stage) -> Pairs {
        match self {
            Self::Nothing => Pairs::new(),
            Self::Ours(_) => {
                let contacts = stage.app.world().resource::<MorphCollisions>().iter();
                let pairs =
                    contacts.filter_map(|c| Some((stage.character(c.collider1)?, stage.character(c.collider2)?)));
                pairs.map(|(a, b)| (a.min(b), a.max(b))).collect()
            }
            Self::JointBoxes => {
                let boxes = stage.parts.iter().map(|part| culling_box(stage, part.entity));
                let boxes: Vec<_> = boxes.collect();
                overlapping(&boxes)
            }
            Self::Capsules(_) => capsules::touching(stage),
        }
    }
}

type Pairs = BTreeSet<(usize, usize)>;

/// The world-space box around the box that Bevy uses to cull an entity.
fn culling_box(stage: &Stage, entity: Entity) -> (DVec3, DVec3) {
    let world = stage.app.world();
    let aabb = world.get::<Aabb>(entity).copied().unwrap_or_default();
    let place = world
        .get::<GlobalTransform>(entity)
        .map(GlobalTransform::affine)
        .unwrap_or_default();
    let center = place.transform_point3a(aabb.center);
    let radius = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| aabb.relative_radius(&axis.into(), &place.matrix3));
    let (center, radius) = (Vec3::from(center).as_dvec3(), Vec3::from_array(radius).as_dvec3());
    (center - radius, center + radius)
}

fn overlapping(boxes: &[(DVec3, DVec3)]) -> Pairs {
    let mut pairs = Pairs::new();
    for (b, (min, max)) in boxes.iter().enumerate() {
        let overlaps = |(low, high): &(DVec3, DVec3)| low.cmple(*max).all() && high.cmpge(*min).all();
        let before = boxes[..b].iter().enumerate();
        pairs.extend(before.filter(|(_, other)| overlaps(other)).map(|(a, _)| (a, b)));
    }
    pairs
}

/// The pairs of characters whose triangles intersect, exactly, by brute force.
fn truth(model: &Model, stage: &Stage) -> Pairs {
    let all: Vec<Vec<DVec3>> = stage.parts.iter().map(|part| stage.vertices(model, part)).collect();
    let extents: Vec<_> = all.iter().map(extent).collect();
    let touch = |&(a, b): &(usize, usize)| {
        let triangles_near = |i: usize, j: usize| {
            let triangles = stage.parts[i].triangles(&model.meshes);
            near(triangles, &all[i], extents[j]).1
        };
        !intersecting_pairs(&all[a], &triangles_near(a, b), &all[b], &triangles_near(b, a)).is_empty()
    };
    overlapping(&extents).into_iter().filter(touch).collect()
}

/// The cost of a frame beyond that of the same characters without queries.
pub(crate) fn times(quick: bool) -> Result<String, String> {
    let model = Model::find("mh_character.glb")?;
    let frames = if quick { 20 } else { 180 };
    let mut of_crowds = Vec::new();
    for (_, apart) in CROWDS {
        let stages: Result<Vec<Stage>, String> = Way::ALL.iter().map(|way| way.stage(&model, apart)).collect();
        of_crowds.push(frame_times(&mut stages?, frames));
    }
    let columns = CROWDS.map(|(crowd, _)| [format!("{crowd}, µs"), "ratio".to_owned()]);
    let mut table = Table::new([String::new()].into_iter().chain(columns.into_iter().flatten()));
    for (i, way) in Way::ALL.iter().enumerate() {
        let cells = |times: &Vec<f64>| {
            let (base, ours) = (times[0], times[1] - times[0]);
            match way {
                Way::Nothing => [format!("({base:.0})"), String::new()],
                _ => [
                    format!("{:.0}", times[i] - base),
                    format!("{:.2}", (times[i] - base) / ours),
                ],
            }
        };
        let name = [way.name().to_owned()];
        table.row(name.into_iter().chain(of_crowds.iter().flat_map(cells)));
    }
    Ok(table.to_string())
}

/// Each way's answers about pairs of characters, compared with the truth.
pub(crate) fn answers(quick: bool) -> Result<String, String> {
    let model = Model::find("mh_character.glb")?;
    let moments: u32 = if quick { 2 } else { 15 };
    let mut table = Table::new([
        "crowd",
        "method",
        "touching pairs of characters, by brute force",
        "reported",
        "missed",
        "false",
    ]);
    let bar = progress_bar(u64::from(moments) * CROWDS.len() as u64);
    for (crowd, apart) in CROWDS {
        let ways = &Way::ALL[1..];
        let mut stages: Vec<Stage> = ways
            .iter()
            .map(|way| way.stage(&model, apart))
            .collect::<Result<_, _>>()?;
        let (mut in_truth, mut rows) = (0, vec![[0; 3]; ways.len()]);
        for _ in 0..moments {
            for stage in &mut stages {
                for _ in 0..12 {
                    stage.app.update();
                }
            }
            let truth = truth(&model, &stages[0]);
            in_truth += truth.len();
            for ((way, stage), row) in ways.iter().zip(&mut stages).zip(&mut rows) {
                let found = way.touching(stage);
                row[0] += found.len();
                row[1] += truth.difference(&found).count();
                row[2] += found.difference(&truth).count();
                if let Way::Capsules(fit) = way {
                    asked_right(&model, stage, *fit, &found)?;
                }
            }
            bar.inc(1);
        }
        for (way, [reported, missed, wrong]) in ways.iter().zip(&rows) {
            let name = if *way == Way::JointBoxes {
                "Bevy's joint boxes overlap"
            } else {
                way.name()
            };
            let counts = [in_truth, *reported, *missed, *wrong].map(|count| count.to_string());
            table.row([crowd, name].map(str::to_owned).into_iter().chain(counts));
        }
    }
    bar.finish_and_clear();
    Ok(table.to_string())
}

/// Checks that Rapier's pairs are those of the capsules. Otherwise the comparison would be unfair.
fn asked_right(model: &Model, stage: &Stage, fit: Fit, found: &Pairs) -> Result<(), String> {
    let capsules: Vec<_> = model.meshes.iter().flat_map(|mesh| fitted(mesh, fit)).collect();
    let [surely, perhaps] = [-1e-3, 1e-3].map(|slack| capsules::touching_by_distance(stage, &capsules, slack));
    let (missed, invented) = (surely.difference(found).count(), found.difference(&perhaps).count());
    if missed + invented > 0 {
        return Err(format!(
            "Rapier misses {missed} pairs of capsules and invents {invented}"
        ));
    }
    Ok(())
}
