//! Rays from a camera into a crowd: what they cost, and which answers are right.

use bevy::ecs::system::SystemId;
use bevy::math::DVec3;
use bevy::picking::mesh_picking::ray_cast::{MeshRayCast, MeshRayCastSettings, RayCastVisibility};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::bench::{Stopwatch, median};
use morph_collision_testkit::report::Table;
use morph_collision_workspace::drawn::{extent, meets};
use morph_collision_workspace::outcome::progress_bar;

use super::stage::{Stage, grid};
use crate::model::Model;

const CHARACTERS: usize = 100;
const CLIP: &str = "walk_and_talk";

/// Rays per frame of the picture: columns and rows.
const PICTURE: (usize, usize) = (32, 18);

/// A hit farther than this from the true point is wrong, in decimetres: a centimetre.
const TOLERANCE: f64 = 0.1;

/// The first thing a ray hits: a character, and the distance.
type Hit = Option<(Entity, f32)>;

/// Casts rays and returns the hits and the time.
type Caster = SystemId<In<Vec<Ray3d>>, (Vec<Hit>, f64)>;

fn by_plugin(In(rays): In<Vec<Ray3d>>, spatial: MorphSpatialQuery) -> (Vec<Hit>, f64) {
    let filter = MorphQueryFilter {
        only_front: true,
        ..default()
    };
    let watch = Stopwatch::start();
    let cast = |ray: Ray3d| {
        let hit = spatial.cast_ray(ray.origin, ray.direction, f32::INFINITY, &filter);
        hit.map(|hit| (hit.entity, hit.distance))
    };
    let hits = rays.into_iter().map(cast).collect();
    (hits, watch.elapsed().as_secs_f64() * 1e6)
}

fn by_bevy(In(rays): In<Vec<Ray3d>>, mut mesh_rays: MeshRayCast) -> (Vec<Hit>, f64) {
    let settings = MeshRayCastSettings::default().with_visibility(RayCastVisibility::Any);
    let watch = Stopwatch::start();
    let mut cast = |ray: Ray3d| {
        let hits = mesh_rays.cast_ray(ray, &settings);
        hits.first().map(|(entity, hit)| (*entity, hit.distance))
    };
    let hits = rays.into_iter().map(&mut cast).collect();
    (hits, watch.elapsed().as_secs_f64() * 1e6)
}

/// A crowd that both can query, with Bevy's own boxes around joints.
fn crowd(model: &Model) -> Result<(Stage, [Caster; 2]), String> {
    let scene = MorphColliderScene {
        collider: MorphCollider::new(MorphCollisionMode::Passive),
        ..default()
    };
    let places = grid(CHARACTERS, Vec2::splat(9.0));
    let mut stage = Stage::new(model, &places, scene, |app| {
        _ = app.add_plugins(MorphCollisionPlugin);
    })?;
    stage.set_dynamic_bounds(true);
    stage.play(CLIP)?;
    let world = stage.app.world_mut();
    let casters = [world.register_system(by_plugin), world.register_system(by_bevy)];
    Ok((stage, casters))
}

fn cast(stage: &mut Stage, caster: Caster, rays: &[Ray3d]) -> Result<(Vec<Hit>, f64), String> {
    let answer = stage.app.world_mut().run_system_with(caster, rays.to_vec());
    answer.map_err(|error| error.to_string())
}

/// The rays of a picture taken from in front of the crowd, at twice a character's height. All shift within a pixel from frame to
/// frame.
fn picture((columns, rows): (usize, usize), frame: usize) -> Vec<Ray3d> {
    let camera = Transform::from_xyz(40.0, 22.0, -45.0).looking_at(Vec3::new(40.5, -2.0, 25.0), Vec3::Y);
    let shift = Vec2::new((0.618_034 * frame as f32).fract(), (0.754_878 * frame as f32).fract());
    let (aspect, tangent) = (columns as f32 / rows as f32, 0.45);
    let mut rays = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let at = (Vec2::new(column as f32, row as f32) + shift) / Vec2::new(columns as f32, rows as f32);
            let at = (at * 2.0 - 1.0) * tangent * Vec2::new(aspect, -1.0);
            let direction = camera.rotation * Vec3::new(at.x, at.y, -1.0);
            if let Ok(direction) = Dir3::new(direction) {
                rays.push(Ray3d::new(camera.translation, direction));
            }
        }
    }
    rays
}

/// The cost of a ray with this plugin and with Bevy, timed in turns.
pub(crate) fn times(quick: bool) -> Result<String, String> {
    let model = Model::find("mh_character.glb")?;
    let (mut stage, casters) = crowd(&model)?;
    let frames = if quick { 4 } else { 40 };
    let mut table = Table::new([
        "rays in a frame",
        "`MorphSpatialQuery`, µs per ray",
        "`MeshRayCast`, µs per ray",
        "ratio",
    ]);
    let bar = progress_bar(frames as u64 * 3);
    let mut upkeep = Vec::new();
    for (count, size) in [(1, (32, 18)), (24, (6, 4)), (PICTURE.0 * PICTURE.1, PICTURE)] {
        let (mut times, mut ratios) = ([Vec::new(), Vec::new()], Vec::new());
        for frame in 0..frames {
            stage.app.update();
            upkeep.push(
                stage
                    .app
                    .world()
                    .resource::<MorphCollisionDiagnostics>()
                    .duration
                    .as_secs_f64()
                    * 1e6,
            );
            let mut rays = picture(size, frame);
            if count == 1 {
                // The ray of one pointer that wanders over the picture.
                rays = vec![rays[(frame * 131) % rays.len()]];
            }
            let mut of_frame = [0.0; 2];
            for turn in 0..2 {
                let who = (turn + frame) % 2;
                let (_, time) = cast(&mut stage, casters[who], &rays)?;
                of_frame[who] = time / rays.len() as f64;
                times[who].push(of_frame[who]);
            }
            ratios.push(of_frame[1] / of_frame[0]);
            bar.inc(1);
        }
        let [ours, bevys] = times.map(|times| median(times.into_iter()));
        let ratio = median(ratios.into_iter());
        let numbers = [ours, bevys, ratio].map(|number| format!("{number:.1}"));
        table.row([count.to_string()].into_iter().chain(numbers));
    }
    bar.finish_and_clear();
    let upkeep = median(upkeep.into_iter());
    Ok(format!(
        "{table}\nIn addition, `MorphCollisionPlugin` takes {upkeep:.0} µs in each frame to keep the {CHARACTERS} characters' joints, weights and boxes.\n"
    ))
}

/// How many rays each answers wrongly.
pub(crate) fn answers(quick: bool) -> Result<String, String> {
    let model = Model::find("mh_character.glb")?;
    let (mut stage, casters) = crowd(&model)?;
    let moments = if quick { 2 } else { 15 };
    // Counts rays and hits. Then, for each method: rays with the wrong character, no hit, or a hit where there is none; and rays
    // with a different point on the right character.
    let (mut rays, mut hits, mut wrong) = (0, 0, [[0; 2]; 2]);
    let bar = progress_bar(moments as u64);
    for moment in 0..moments {
        for _ in 0..12 {
            stage.app.update();
        }
        let picture = picture(PICTURE, moment);
        let truth = Truth::of(&model, &stage);
        let expected: Vec<Option<(Entity, f64)>> = picture.iter().map(|ray| truth.first(&model, &stage, ray)).collect();
        rays += expected.len();
        hits += expected.iter().flatten().count();
        for (caster, wrong) in casters.into_iter().zip(&mut wrong) {
            let (found, _) = cast(&mut stage, caster, &picture)?;
            for (found, expected) in found.into_iter().zip(&expected) {
                match (found, expected) {
                    (None, None) => {}
                    (Some((a, at)), Some((b, true_at))) if a == *b => {
                        wrong[1] += usize::from((f64::from(at) - true_at).abs() > TOLERANCE);
                    }
                    _ => wrong[0] += 1,
                }
            }
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let mut table = Table::new([
        "method",
        "rays",
        "that hit a character, by brute force",
        "wrong character, none, or one where there is none",
        "right character, over 1 cm off",
        "wrong",
    ]);
    for (name, [who, place]) in ["`MorphSpatialQuery`", "`MeshRayCast`"].iter().zip(wrong) {
        let share = 100.0 * (who + place) as f64 / rays as f64;
        let counts = [rays, hits, who, place].map(|count| count.to_string());
        table.row(
            [name.to_string()]
                .into_iter()
                .chain(counts)
                .chain([format!("{share:.1} %")]),
        );
    }
    Ok(table.to_string())
}

/// The vertices of all characters.
struct Truth {
    all: Vec<(Vec<DVec3>, DVec3, DVec3)>,
}

impl Truth {
    fn of(model: &Model, stage: &Stage) -> Self {
        let of_part = |part| {
            let vertices = stage.vertices(model, part);
            let (min, max) = extent(&vertices);
            (vertices, min, max)
        };
        Self {
            all: stage.parts.iter().map(of_part).collect(),
        }
    }

    /// The first triangle that a ray hits from its front.
    fn first(&self, model: &Model, stage: &Stage, ray: &Ray3d) -> Option<(Entity, f64)> {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let mut first: Option<(Entity, f64)> = None;
        for (part, (vertices, min, max)) in stage.parts.iter().zip(&self.all) {
            let (to_min, to_max) = ((*min - origin) / direction, (*max - origin) / direction);
            let (enters, leaves) = (to_min.min(to_max).max_element(), to_min.max(to_max).min_element());
            if enters > leaves + 1e-6 || leaves < 0.0 {
                continue;
            }
            for corners in part.triangles(&model.meshes) {
                let [a, b, c] = corners.map(|corner| vertices[corner as usize]);
                let is_front = (b - a).cross(c - a).dot(direction) < 0.0;
                let distance = meets(origin, direction, [a, b, c]).filter(|_| is_front);
                if let Some(distance) = distance.filter(|&at| first.is_none_or(|(_, before)| at < before)) {
                    first = Some((part.entity, distance));
                }
            }
        }
        first
    }
}
