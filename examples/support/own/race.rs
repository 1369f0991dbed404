//! Times this library and a refit of the whole mesh on the same pair. Both answer the same question, in turns.

use std::time::Duration;

use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::mesh::{Indices, VertexAttributeValues};
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy_morph_collision::morph_collision::TrianglePair;
use bevy_morph_collision::prelude::*;
use morph_collision::batch::Wanted;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::rivals::{Method, MethodKind, MethodOptions};

use super::{Accepted, Verdict};
use crate::view::group::Member;
use crate::view::models::weights_of;
use crate::view::overlay::OverlaySystems;
use crate::view::stage::Notes;

/// Frames to average over, because a browser's clock is coarse.
const WINDOW: u32 = 30;

/// Compares the methods while the copies run into each other, and puts the times on the panel.
pub fn plugin(app: &mut App) {
    app.init_resource::<Race>().add_systems(
        PostUpdate,
        (reset.run_if(on_message::<Accepted>), run)
            .chain()
            .after(OverlaySystems),
    );
}

fn reset(mut race: ResMut<Race>) {
    *race = Race::default();
}

/// Two methods over the same bodies; empty until the model is on the stage.
#[derive(Resource, Default)]
struct Race {
    contenders: Vec<Contender>,
    /// The parts of both copies, each with the index of its copy, in the order of the methods' bodies.
    parts: Vec<(usize, Entity)>,
    trouble: Option<String>,
    frames: u32,
}

struct Contender {
    name: &'static str,
    method: Box<dyn Method>,
    spent: Duration,
    vertices: u64,
    /// Milliseconds and blended vertices per frame, over the last window.
    told: Option<(f64, f64)>,
    pairs: Vec<TrianglePair>,
}

impl Race {
    /// A line for each method.
    fn notes(&self) -> Vec<(&'static str, String)> {
        if let Some(trouble) = &self.trouble {
            return vec![("not compared", trouble.clone())];
        }
        let line = |contender: &Contender| {
            let told = contender.told?;
            Some((contender.name, format!("{:.3} ms, {:.0} vertices", told.0, told.1)))
        };
        let mut notes: Vec<_> = self.contenders.iter().filter_map(line).collect();
        if let [Some((ours, _)), Some((whole, _))] = [0, 1].map(|i| self.contenders.get(i).and_then(|one| one.told))
            && ours > 0.0
        {
            notes.push(("that is", format!("{:.1} times as long", whole / ours)));
        }
        notes
    }

    fn set_up(&mut self, parts: Vec<(usize, Entity)>, bodies: &[usize], meshes: &[MorphMesh]) {
        let options = MethodOptions::default();
        // Named one by one, so that a web page does not download the other methods.
        let ways = [
            ("morph trees", MethodKind::Morph.set_up(meshes, bodies, &options)),
            (
                "whole mesh refitted",
                MethodKind::BottomUp.set_up(meshes, bodies, &options),
            ),
        ];
        for (name, way) in ways {
            match way {
                Ok(method) => self.contenders.push(Contender {
                    name,
                    method,
                    spent: Duration::ZERO,
                    vertices: 0,
                    told: None,
                    pairs: Vec::new(),
                }),
                Err(error) => self.trouble = Some(error.to_string()),
            }
        }
        self.parts = parts;
    }
}

impl Contender {
    /// Sets weights and placements of all bodies, then finds the pairs between the parts of the two copies.
    fn frame(&mut self, copies: &[usize], poses: &[(&[f32], &GlobalTransform)]) -> Result<(), String> {
        let start = Instant::now();
        for (body, (weights, place)) in poses.iter().enumerate() {
            self.method
                .set_body(body, weights, &place.affine())
                .map_err(|error| error.to_string())?;
        }
        self.pairs.clear();
        for a in (0..copies.len()).filter(|&a| copies[a] == 0) {
            for b in (0..copies.len()).filter(|&b| copies[b] == 1) {
                let (bounds_a, bounds_b) = (self.method.world_bounds(a), self.method.world_bounds(b));
                if bounds_a.overlaps(&bounds_b) {
                    self.method.collide(a, b, Wanted::All, &mut self.pairs);
                }
            }
        }
        self.spent += start.elapsed();
        Ok(())
    }

    fn close_window(&mut self) {
        let vertices = self.method.work().vertices_blended;
        let frames = f64::from(WINDOW);
        self.told = Some((
            self.spent.as_secs_f64() * 1e3 / frames,
            (vertices - self.vertices) as f64 / frames,
        ));
        (self.spent, self.vertices) = (Duration::ZERO, vertices);
    }
}

type Part<'a> = (
    Entity,
    &'a Mesh3d,
    Option<&'a MeshMorphWeights>,
    &'a GlobalTransform,
    Has<SkinnedMesh>,
);

fn run(
    mut race: ResMut<Race>,
    parts: Query<Part, With<MorphCollider>>,
    shared: Query<&MorphWeights>,
    members: Query<&Member>,
    parents: Query<&ChildOf>,
    meshes: Res<Assets<Mesh>>,
    verdict: Res<Verdict>,
    mut told: ResMut<Notes>,
) {
    let race = &mut *race;
    if race.contenders.is_empty() && race.trouble.is_none() {
        prepare(race, &parts, &members, &parents, &meshes);
    }
    let posed: Option<Vec<_>> = race.parts.iter().map(|&(_, part)| parts.get(part).ok()).collect();
    let Some(posed) = posed.filter(|posed| !posed.is_empty()) else {
        if race.trouble.is_some() {
            *told = notes(race, &verdict);
        }
        return;
    };
    let poses: Vec<_> = posed
        .iter()
        .map(|(_, _, weights, place, _)| (weights.map_or(&[][..], |weights| weights_of(weights, &shared)), *place))
        .collect();
    let copies: Vec<usize> = race.parts.iter().map(|&(copy, _)| copy).collect();
    race.frames += 1;
    // They alternate, so that neither always finds the caches warm.
    let turns = if race.frames.is_multiple_of(2) { [0, 1] } else { [1, 0] };
    for turn in turns {
        if let Some(contender) = race.contenders.get_mut(turn)
            && let Err(error) = contender.frame(&copies, &poses)
        {
            race.trouble = Some(error);
        }
    }
    if race.frames.is_multiple_of(WINDOW) {
        race.contenders.iter_mut().for_each(Contender::close_window);
    }
    *told = notes(race, &verdict);
}

/// Runs once both copies are spawned.
fn prepare(
    race: &mut Race,
    parts: &Query<Part, With<MorphCollider>>,
    members: &Query<&Member>,
    parents: &Query<&ChildOf>,
    assets: &Assets<Mesh>,
) {
    let (mut found, mut bodies, mut meshes, mut known) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (entity, mesh, _, _, is_skinned) in parts {
        if is_skinned {
            race.trouble = Some("only models without joints are".into());
            return;
        }
        let Some(member) = parents.iter_ancestors(entity).find_map(|above| members.get(above).ok()) else {
            continue;
        };
        let index = known.iter().position(|&id| id == mesh.id()).or_else(|| {
            meshes.push(morph_mesh(assets.get(&mesh.0)?)?);
            known.push(mesh.id());
            Some(known.len() - 1)
        });
        if let Some(index) = index {
            found.push((member.0, entity));
            bodies.push(index);
        }
    }
    if [0, 1].iter().all(|copy| found.iter().any(|(of, _)| of == copy)) {
        race.set_up(found, &bodies, &meshes);
    }
}

/// The positions, triangles and displacements of a Bevy mesh; `None` if they are missing or cannot be read.
fn morph_mesh(mesh: &Mesh) -> Option<MorphMesh> {
    let VertexAttributeValues::Float32x3(positions) = mesh.attribute(Mesh::ATTRIBUTE_POSITION)? else {
        return None;
    };
    let corners: Vec<u32> = match mesh.indices() {
        Some(Indices::U16(indices)) => indices.iter().map(|&index| index.into()).collect(),
        Some(Indices::U32(indices)) => indices.clone(),
        None => (0..positions.len() as u32).collect(),
    };
    let positions: Vec<Vec3> = positions.iter().map(|&position| position.into()).collect();
    let targets = mesh.morph_targets().map_or(&[][..], Vec::as_slice);
    let targets = targets.chunks_exact(positions.len().max(1));
    let mut found = MorphMesh::rigid("", positions.clone(), corners.as_chunks().0.to_vec());
    found.targets = targets
        .map(|target| target.iter().map(|displacement| displacement.position).collect())
        .collect();
    Some(found)
}

/// Notes about the model and its costs.
fn notes(race: &Race, verdict: &Verdict) -> Notes {
    let mut notes = race.notes();
    if let Some(error) = verdict.now().error {
        notes.push(("refused", error));
    }
    Notes(notes)
}
