//! What two bodies do in each row of the table.

use std::path::Path;

use bevy::mesh::morph::{MeshMorphWeights, MorphAttributes};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::rigid;
use morph_collision_workspace::app::headless;

/// Two bodies, and how they move.
pub(super) struct Scene {
    pub(super) name: String,
    mesh: Mesh,
    pub(super) frames: usize,
    start: [Transform; 2],
    /// The placements and the weight after some share of the motion.
    at: Box<dyn Fn(f32) -> ([Transform; 2], f32)>,
}

pub(super) struct Stage {
    pub(super) app: App,
    bodies: [Entity; 2],
}

fn beside(x: f32, scale: Vec3) -> [Transform; 2] {
    [-x, x].map(|x| Transform::from_xyz(x, 0.0, 0.0).with_scale(scale))
}

fn sphere(subdivisions: u32) -> Result<Mesh, String> {
    let sphere = Sphere::new(0.5).mesh().ico(subdivisions);
    sphere.map_err(|error| error.to_string())
}

/// All rows. A sphere with `n` subdivisions has `20 (n + 1)^2` triangles.
pub(super) fn scenes() -> Result<Vec<Scene>, String> {
    let mut scenes = Vec::new();
    let mut add = |name: String, mesh: Mesh, frames, at: Box<dyn Fn(f32) -> ([Transform; 2], f32)>| {
        let start = at(0.0).0;
        scenes.push(Scene {
            name,
            mesh,
            frames,
            start,
            at,
        });
    };
    for subdivisions in [1, 2, 3, 8] {
        let triangles = 20 * (subdivisions + 1) * (subdivisions + 1);
        add(
            format!("{triangles} triangles each, shrink to a point in 20 frames"),
            sphere(subdivisions)?,
            20,
            Box::new(|share| (beside(0.8 * (1.0 - share), Vec3::splat(1.0 - share)), 0.0)),
        );
    }
    let ends = [
        ("to a point", 0.0, Vec3::ZERO),
        ("to a line", 0.2, Vec3::X),
        ("to a plane", 0.2, Vec3::new(1.0, 1.0, 0.0)),
        ("1e-20 as large", 0.0, Vec3::splat(1e-20)),
        ("1e6 times as large", 0.8, Vec3::splat(1e6)),
        ("1e10 times as large", 0.8, Vec3::splat(1e10)),
        ("1e20 times as large", 0.8, Vec3::splat(1e20)),
        ("mirrored", 0.8, Vec3::NEG_ONE),
        ("mirrored, through each other", -0.8, Vec3::NEG_ONE),
        ("through each other", -0.8, Vec3::ONE),
    ];
    for (name, x, scale) in ends {
        add(
            format!("1620 triangles each, {name}"),
            sphere(8)?,
            1,
            Box::new(move |share| {
                let end = beside(x, scale);
                (if share < 1.0 { beside(0.8, Vec3::ONE) } else { end }, 0.0)
            }),
        );
    }
    add(
        "1620 triangles each, weights of 1e37".to_owned(),
        growing(sphere(8)?),
        1,
        Box::new(|share| (beside(0.8, Vec3::ONE), if share < 1.0 { 0.0 } else { 1e37 })),
    );
    add(
        "two sheets of 1568 triangles slide over each other in one plane, 20 frames".to_owned(),
        sheet(),
        20,
        Box::new(|share| (beside(0.55 - 0.5 * share, Vec3::ONE), 0.0)),
    );
    Ok(scenes)
}

/// A mesh with a target that doubles its size.
fn growing(mesh: Mesh) -> Mesh {
    let Some(positions) = mesh
        .attribute(Mesh::ATTRIBUTE_POSITION)
        .and_then(|values| values.as_float3())
    else {
        return mesh;
    };
    let grow = |position: &[f32; 3]| MorphAttributes {
        position: Vec3::from(*position),
        ..MorphAttributes::default()
    };
    let target = positions.iter().map(grow).collect();
    mesh.with_morph_targets(target)
}

fn sheet() -> Mesh {
    let mesh = rigid::grid(1.0, 28);
    Mesh::new(
        bevy::mesh::PrimitiveTopology::TriangleList,
        bevy::asset::RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, mesh.positions)
    .with_inserted_indices(bevy::mesh::Indices::U32(mesh.triangles.concat()))
}

impl Scene {
    /// An app in which both bodies are ready.
    pub(super) fn stage(&self, collider: MorphCollider) -> Result<Stage, String> {
        let mut app = headless(Path::new("assets"));
        app.finish();
        app.cleanup();
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(self.mesh.clone());
        let weights = MeshMorphWeights::Value { weights: vec![0.0] };
        let morphs = self.mesh.has_morph_targets();
        let bodies = self.start.map(|place| {
            let mut body = app.world_mut().spawn((Mesh3d(mesh.clone()), place, collider));
            if morphs {
                body.insert(weights.clone());
            }
            body.id()
        });
        for _ in 0..10_000 {
            app.update();
            if app.world().resource::<MorphCollisionDiagnostics>().colliders == 2 {
                return Ok(Stage { app, bodies });
            }
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        Err(format!("{}: the trees did not get ready", self.name))
    }

    pub(super) fn step(&self, stage: &mut Stage, frame: usize) {
        let (places, weight) = (self.at)(frame as f32 / self.frames as f32);
        for (body, place) in stage.bodies.into_iter().zip(places) {
            let mut body = stage.app.world_mut().entity_mut(body);
            body.insert(place);
            if body.contains::<MeshMorphWeights>() {
                body.insert(MeshMorphWeights::Value { weights: vec![weight] });
            }
        }
    }
}
